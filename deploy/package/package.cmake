# What is installed, and the Debian package made of it:  cmake --build build && (cd build && cpack)
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

# The library: one static library a room, headers, and the generated types of the wire.
get_property(rooms GLOBAL PROPERTY BOXGRASP_ROOMS)
install(TARGETS ${rooms} boxgrasp_flags EXPORT boxgrasp ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/lib/boxgrasp DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
        FILES_MATCHING PATTERN "*.h")
install(DIRECTORY ${PROJECT_BINARY_DIR}/lcmtypes/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/boxgrasp-types
        FILES_MATCHING PATTERN "*.hpp")
get_property(BOXGRASP_PKG_CONFIG_DEPENDENCIES GLOBAL PROPERTY BOXGRASP_PKG_CONFIG)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/boxgrasp)
install(EXPORT boxgrasp NAMESPACE boxgrasp:: DESTINATION ${package_dir} FILE boxgrasp-targets.cmake)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/boxgrasp-config.cmake.in
                              ${PROJECT_BINARY_DIR}/boxgrasp-config.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/boxgrasp-config-version.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/boxgrasp-config.cmake ${PROJECT_BINARY_DIR}/boxgrasp-config-version.cmake
        DESTINATION ${package_dir})

# What programs and people read.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/lcmtypes ${PROJECT_SOURCE_DIR}/deploy/hands
                  ${PROJECT_SOURCE_DIR}/deploy/models DESTINATION ${CMAKE_INSTALL_DATADIR}/boxgrasp)
install(FILES ${PROJECT_SOURCE_DIR}/README.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright)
install(FILES ${PROJECT_SOURCE_DIR}/deploy/boxgrasp.toml DESTINATION ${CMAKE_INSTALL_FULL_SYSCONFDIR}/boxgrasp)

# The service.
install(FILES ${PROJECT_SOURCE_DIR}/deploy/systemd/boxgrasp-server.service DESTINATION lib/systemd/system)
install(FILES ${PROJECT_SOURCE_DIR}/deploy/systemd/boxgrasp.sysusers DESTINATION lib/sysusers.d
        RENAME boxgrasp.conf)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME boxgrasp)
set(CPACK_PACKAGE_CONTACT "The Boxgrasp developers <boxgrasp@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "grasp planning for three-finger hands from point clouds")
set(CPACK_PACKAGE_DESCRIPTION
    "Boxgrasp answers point clouds that arrive over LCM with ranked grasps of a\n\
 Barrett hand. The package holds the daemon, its command line client, the\n\
 trainer, the library with its headers, and the message types.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "liblcm-bin")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS
    "liblcm-dev, libeigen3-dev, libfmt-dev, libopencv-dev, libtbb-dev, libqhull-dev, libode-dev")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA
    "${CMAKE_CURRENT_LIST_DIR}/postinst;${CMAKE_CURRENT_LIST_DIR}/prerm;${CMAKE_CURRENT_LIST_DIR}/postrm;${CMAKE_CURRENT_LIST_DIR}/conffiles")
include(CPack)
