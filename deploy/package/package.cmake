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
                  ${PROJECT_SOURCE_DIR}/deploy/models ${PROJECT_SOURCE_DIR}/deploy/slurm DESTINATION ${CMAKE_INSTALL_DATADIR}/boxgrasp)
install(FILES ${PROJECT_SOURCE_DIR}/README.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright)
install(FILES ${PROJECT_SOURCE_DIR}/deploy/boxgrasp.toml DESTINATION /etc/boxgrasp)

install(DIRECTORY ${PROJECT_SOURCE_DIR}/examples DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES ${CMAKE_CURRENT_LIST_DIR}/completion/boxgrasp
        DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
install(CODE "file(CREATE_LINK boxgrasp
  \$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DATADIR}/bash-completion/completions/boxgrasp-server SYMBOLIC)
file(CREATE_LINK boxgrasp
  \$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DATADIR}/bash-completion/completions/boxgrasp-trainer SYMBOLIC)")

# Manual pages: what the programs say of themselves, so that neither can say anything else.
find_package(Python3 REQUIRED COMPONENTS Interpreter)
foreach(program boxgrasp boxgrasp-server boxgrasp-trainer)
  set(page ${PROJECT_BINARY_DIR}/man/${program}.1.gz)
  add_custom_command(OUTPUT ${page} DEPENDS ${program} ${CMAKE_CURRENT_LIST_DIR}/man_page VERBATIM
    COMMAND sh -c "'${CMAKE_CURRENT_LIST_DIR}/man_page' \"$1\" ${PROJECT_VERSION} | gzip -9n >'${page}'"
            sh $<TARGET_FILE:${program}>)
  list(APPEND pages ${page})
endforeach()
file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/man)
add_custom_target(manual_pages ALL DEPENDS ${pages})
install(FILES ${pages} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)

# Debian's changelog, of the changelog that people read.
configure_file(${CMAKE_CURRENT_LIST_DIR}/changelog.in ${PROJECT_BINARY_DIR}/changelog @ONLY)
add_custom_command(OUTPUT ${PROJECT_BINARY_DIR}/changelog.gz DEPENDS ${PROJECT_BINARY_DIR}/changelog VERBATIM
  COMMAND sh -c "gzip -9n <'${PROJECT_BINARY_DIR}/changelog' >'${PROJECT_BINARY_DIR}/changelog.gz'")
add_custom_target(package_changelog ALL DEPENDS ${PROJECT_BINARY_DIR}/changelog.gz)
install(FILES ${PROJECT_BINARY_DIR}/changelog.gz DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES ${CMAKE_CURRENT_LIST_DIR}/lintian-overrides DESTINATION ${CMAKE_INSTALL_DATADIR}/lintian/overrides
        RENAME boxgrasp)

# The service.
install(FILES ${PROJECT_SOURCE_DIR}/deploy/systemd/boxgrasp-server.service
              ${PROJECT_SOURCE_DIR}/deploy/systemd/boxgrasp-worker.service DESTINATION lib/systemd/system)
install(FILES ${PROJECT_SOURCE_DIR}/deploy/systemd/boxgrasp.sysusers DESTINATION lib/sysusers.d
        RENAME boxgrasp.conf)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME boxgrasp)
set(CPACK_PACKAGE_CONTACT "The Boxgrasp developers <boxgrasp@example.org>")
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
    "liblcm-dev, libeigen3-dev, libfmt-dev, libopencv-dev, libtbb-dev, libqhull-dev, libode-dev, libembree-dev")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA
    "${CMAKE_CURRENT_LIST_DIR}/postinst;${CMAKE_CURRENT_LIST_DIR}/prerm;${CMAKE_CURRENT_LIST_DIR}/postrm;${CMAKE_CURRENT_LIST_DIR}/conffiles")
include(CPack)
