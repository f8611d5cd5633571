find_package(embree 3 REQUIRED)
find_package(OpenCV REQUIRED COMPONENTS core imgproc imgcodecs)
boxgrasp_pkg_config(LCM lcm)
boxgrasp_pkg_config(TOMLPLUSPLUS tomlplusplus)
boxgrasp_pkg_config(SODIUM libsodium)
boxgrasp_pkg_config(QHULL qhull_r)
boxgrasp_pkg_config(ODE ode>=0.16)
boxgrasp_pkg_config(SQLITE sqlite3>=3.37)
find_library(LZF lzf REQUIRED)

boxgrasp_room(base          LIBRARIES TBB::tbb Threads::Threads)
# TBB's templates are as little sanitized as its library; the file says itself what is handed over between threads.
if(BOXGRASP_SANITIZE MATCHES thread)
  set_source_files_properties(boxgrasp/base/parallel.cc PROPERTIES COMPILE_OPTIONS -fno-sanitize=thread
                              COMPILE_DEFINITIONS BOXGRASP_THREAD_SANITIZER)
endif()
boxgrasp_room(geometry      ROOMS base)
boxgrasp_room(cloud         ROOMS base geometry LIBRARIES ${LZF})
boxgrasp_room(decomposition ROOMS base geometry)
boxgrasp_room(projection    ROOMS base geometry decomposition)
boxgrasp_room(synthesis     ROOMS base geometry projection LIBRARIES opencv_core opencv_imgproc)
boxgrasp_room(hand          ROOMS base geometry projection synthesis LIBRARIES PkgConfig::TOMLPLUSPLUS)
# The built-in hand is the text of the file that users copy.
set(barrett_toml ${PROJECT_SOURCE_DIR}/deploy/hands/barrett.toml)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${barrett_toml})
file(READ ${barrett_toml} BARRETT_TOML)
configure_file(boxgrasp/hand/barrett_toml.cc.in barrett_toml.cc @ONLY)
target_sources(boxgrasp_hand PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/barrett_toml.cc)
boxgrasp_room(quality       ROOMS base geometry synthesis hand)
boxgrasp_room(wrench        ROOMS base geometry LIBRARIES PkgConfig::QHULL)
boxgrasp_room(ranking       ROOMS base LIBRARIES nlohmann_json::nlohmann_json PkgConfig::SODIUM)
boxgrasp_room(planning      ROOMS base geometry cloud decomposition projection synthesis hand quality wrench ranking
                            LIBRARIES PkgConfig::TOMLPLUSPLUS)
# The built-in models are the texts of the files that are shipped; without them the programs ask for --model.
foreach(model default parallel_gripper)
  set(model_file ${PROJECT_SOURCE_DIR}/deploy/models/${model}.json)
  string(TOUPPER ${model}_MODEL_JSON model_text)
  set(${model_text} "")
  if(EXISTS ${model_file})
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${model_file})
    file(READ ${model_file} ${model_text})
  endif()
endforeach()
configure_file(boxgrasp/planning/default_model_json.cc.in default_model_json.cc @ONLY)
target_sources(boxgrasp_planning PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/default_model_json.cc)
boxgrasp_room(rendering     ROOMS base geometry decomposition projection synthesis hand planning
                            LIBRARIES opencv_core opencv_imgproc opencv_imgcodecs)
boxgrasp_room(viewer        ROOMS base geometry decomposition projection hand planning rendering
                            LIBRARIES nlohmann_json::nlohmann_json opencv_core opencv_imgcodecs)
# The page's parts are built into the library, so that a page fetches nothing when it is viewed.
set(three ${CMAKE_SYSROOT}/usr/share/javascript/three)
foreach(part VIEWER_HTML:boxgrasp/viewer/web/viewer.html VIEWER_CSS:boxgrasp/viewer/web/viewer.css
             VIEWER_JS:boxgrasp/viewer/web/viewer.js THREE_JS:${three}/three.min.js
             ORBIT_JS:${three}/examples/js/controls/OrbitControls.js)
  string(REGEX MATCH "^([A-Z_]+):(.*)$" part ${part})
  set(part_name ${CMAKE_MATCH_1})
  file(REAL_PATH ${CMAKE_MATCH_2} part_file)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${part_file})
  file(READ ${part_file} ${part_name})
endforeach()
configure_file(boxgrasp/viewer/web_files.cc.in web_files.cc @ONLY)
target_sources(boxgrasp_viewer PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/web_files.cc)
boxgrasp_room(objects       ROOMS base geometry cloud LIBRARIES embree)
boxgrasp_room(simulation    ROOMS base geometry hand wrench objects LIBRARIES PkgConfig::ODE)
boxgrasp_room(training     ROOMS base geometry cloud decomposition projection hand quality wrench ranking planning objects simulation)
boxgrasp_room(store         ROOMS base geometry hand quality wrench ranking planning simulation training
                            LIBRARIES PkgConfig::SQLITE)
boxgrasp_room(registry      ROOMS base geometry quality ranking planning LIBRARIES PkgConfig::SODIUM nlohmann_json::nlohmann_json)

# The wire: lcm-gen makes one header of each .lcm file.
find_program(LCM_GEN lcm-gen REQUIRED)
set(lcm_headers ${PROJECT_BINARY_DIR}/lcmtypes)
file(GLOB lcm_files CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/lcmtypes/*.lcm)
add_custom_command(OUTPUT ${lcm_headers}/stamp
                   COMMAND ${LCM_GEN} -x --cpp-hpath ${lcm_headers} ${lcm_files}
                   COMMAND ${CMAKE_COMMAND} -E touch ${lcm_headers}/stamp
                   DEPENDS ${lcm_files} COMMENT "Generating LCM types")
add_custom_target(boxgrasp_lcmtypes DEPENDS ${lcm_headers}/stamp)
boxgrasp_room(messaging     ROOMS base geometry ranking planning registry LIBRARIES PkgConfig::LCM)
add_dependencies(boxgrasp_messaging boxgrasp_lcmtypes)
target_include_directories(boxgrasp_messaging SYSTEM PUBLIC $<BUILD_INTERFACE:${lcm_headers}>
                           $<INSTALL_INTERFACE:include/boxgrasp-types>)
boxgrasp_room(live          ROOMS base geometry hand planning viewer messaging LIBRARIES nlohmann_json::nlohmann_json PkgConfig::SODIUM)
