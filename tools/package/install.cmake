# What `cmake --install` copies: the programs with their man pages and completions, the headers and
# static libraries of the rooms, and a CMake package whose targets are luxel::pipeline and luxel::relight
# (docs/guide/library.md). The components are the .deb files that debian.cmake makes of them.

# The rooms that playing an .lxr file needs: free of Assimp and tinygltf. The others need these.
set(luxel_relight_rooms base image scene trace atlas viewfactor transport light solve_matrix)
set(luxel_pipeline_rooms import solve_gather solve_hemicube solve_hierarchical reference post export
    display pipeline)

add_library(luxel_relight INTERFACE)
target_link_libraries(luxel_relight INTERFACE luxel_solve_matrix)
add_library(luxel::relight ALIAS luxel_relight)
add_library(luxel::pipeline ALIAS luxel_pipeline)

# Archives lie in a folder of their own: they have short names and only the package looks for them.
set(luxel_archives ${CMAKE_INSTALL_LIBDIR}/luxel)
set(luxel_package ${CMAKE_INSTALL_LIBDIR}/cmake/luxel)
function(luxel_install_rooms export)
  foreach(room ${ARGN})
    set_target_properties(luxel_${room} PROPERTIES EXPORT_NAME ${room})
    install(TARGETS luxel_${room} EXPORT ${export} ARCHIVE DESTINATION ${luxel_archives} COMPONENT dev)
  endforeach()
  install(EXPORT ${export} NAMESPACE luxel:: DESTINATION ${luxel_package} COMPONENT dev)
endfunction()
luxel_install_rooms(luxelRelightTargets ${luxel_relight_rooms} relight)
luxel_install_rooms(luxelPipelineTargets ${luxel_pipeline_rooms})
install(FILES ${draco_archive} DESTINATION ${luxel_archives} COMPONENT dev)
# `cmake --install --strip` and packages strip programs only.
install(CODE "
if(CMAKE_INSTALL_DO_STRIP)
  file(GLOB archives \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${luxel_archives}/*.a\")
  execute_process(COMMAND \"${CMAKE_STRIP}\" --strip-debug --remove-section=.comment
                          --enable-deterministic-archives \${archives} COMMAND_ERROR_IS_FATAL ANY)
endif()" COMPONENT dev)

install(TARGETS luxel RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT luxel)
# OPTIONAL, as the pages below: `make build` builds luxel and luxel-view alone.
install(TARGETS luxel-bench RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT luxel OPTIONAL)
set(luxel_view_folder ${CMAKE_INSTALL_LIBDIR}/luxel/view)
install(TARGETS luxel-view RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT view OPTIONAL)
install(TARGETS luxel_view_ui LIBRARY DESTINATION ${luxel_view_folder} COMPONENT view OPTIONAL)
file(RELATIVE_PATH view_ui_folder /${CMAKE_INSTALL_BINDIR} /${luxel_view_folder})
set_target_properties(luxel-view PROPERTIES INSTALL_RPATH "$ORIGIN/${view_ui_folder}")

# Man pages and completions, made of what the programs say of their options.
if(NOT LUXEL_SANITIZE AND NOT LUXEL_SANITIZE_THREADS)
  set(luxel_pages ${CMAKE_BINARY_DIR}/pages)
  add_custom_command(
    OUTPUT ${luxel_pages}/made
    COMMAND ${CMAKE_COMMAND} -E rm -rf ${luxel_pages}
    COMMAND Python3::Interpreter ${PROJECT_SOURCE_DIR}/tools/make_man_pages.py $<TARGET_FILE:luxel> ${luxel_pages}/man
    COMMAND sh -c "gzip -9n '${luxel_pages}'/man/*.1"
    COMMAND Python3::Interpreter ${PROJECT_SOURCE_DIR}/tools/make_completions.py $<TARGET_FILE:luxel> ${luxel_pages}
    COMMAND ${CMAKE_COMMAND} -E touch ${luxel_pages}/made
    DEPENDS luxel luxel-bench luxel-view ${PROJECT_SOURCE_DIR}/tools/make_man_pages.py
            ${PROJECT_SOURCE_DIR}/tools/make_completions.py ${PROJECT_SOURCE_DIR}/tools/command_help.py
            ${PROJECT_SOURCE_DIR}/tools/make_options_page.py
    COMMENT "Man pages and completions" VERBATIM)
  add_custom_target(luxel_pages ALL DEPENDS ${luxel_pages}/made)
  set(man ${CMAKE_INSTALL_MANDIR}/man1)
  install(DIRECTORY ${luxel_pages}/man/ DESTINATION ${man} COMPONENT luxel OPTIONAL
          FILES_MATCHING PATTERN "*.1.gz" PATTERN "luxel-view.1.gz" EXCLUDE)
  install(FILES ${luxel_pages}/man/luxel-view.1.gz DESTINATION ${man} COMPONENT view OPTIONAL)
  foreach(component luxel view)
    string(REPLACE view luxel-view program ${component})
    set(share ${CMAKE_INSTALL_DATAROOTDIR})
    install(FILES ${luxel_pages}/bash/${program} DESTINATION ${share}/bash-completion/completions
            COMPONENT ${component} OPTIONAL)
    install(FILES ${luxel_pages}/zsh/_${program} DESTINATION ${share}/zsh/vendor-completions
            COMPONENT ${component} OPTIONAL)
    install(FILES ${luxel_pages}/fish/${program}.fish DESTINATION ${share}/fish/vendor_completions.d
            COMPONENT ${component} OPTIONAL)
  endforeach()
endif()

# What a desktop knows of luxel-view and of .lxr files.
set(share ${CMAKE_INSTALL_DATAROOTDIR})
install(FILES ${CMAKE_CURRENT_LIST_DIR}/luxel-view.desktop DESTINATION ${share}/applications COMPONENT view)
install(FILES ${CMAKE_CURRENT_LIST_DIR}/luxel-view.svg DESTINATION ${share}/icons/hicolor/scalable/apps
        COMPONENT view)
install(FILES ${CMAKE_CURRENT_LIST_DIR}/luxel.xml DESTINATION ${share}/mime/packages COMPONENT view)

# The Python module, where Debian's python3 looks. Only packages have it: `make python` makes a wheel.
if(TARGET luxel_python)
  set(luxel_python_folder lib/python3/dist-packages/luxel)
  install(TARGETS luxel_python LIBRARY DESTINATION ${luxel_python_folder} COMPONENT python EXCLUDE_FROM_ALL)
  foreach(file __init__.py _factors.py __init__.pyi py.typed)
    install(FILES ${PROJECT_SOURCE_DIR}/bindings/python/luxel/${file} DESTINATION ${luxel_python_folder}
            COMPONENT python EXCLUDE_FROM_ALL)
  endforeach()
endif()

# One by one, because install(DIRECTORY) would leave folders without headers, too. Without those of rooms
# that are not installed (the devices', the window's and the tests'), and of Embree, which only trace
# includes.
file(GLOB_RECURSE headers CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/luxel/*.h)
list(FILTER headers EXCLUDE REGEX "(^luxel/(validate|cluster|gpu|view|trace/embree|trace/vulkan|light/device|solve/device|reference/device)/|/test_|_test[_.]|/thread_team|/node_modules/)")
foreach(header ${headers})
  get_filename_component(folder ${header} DIRECTORY)
  install(FILES ${PROJECT_SOURCE_DIR}/${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/${folder}
          COMPONENT dev)
endforeach()

include(CMakePackageConfigHelpers)
get_filename_component(draco_archive_name ${draco_archive} NAME)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/luxelConfig.cmake.in
                              ${CMAKE_BINARY_DIR}/luxelConfig.cmake
                              INSTALL_DESTINATION ${luxel_package} PATH_VARS luxel_archives)
# Before 1.0 a minor version may change the API.
write_basic_package_version_file(${CMAKE_BINARY_DIR}/luxelConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/luxelConfig.cmake ${CMAKE_BINARY_DIR}/luxelConfigVersion.cmake
        DESTINATION ${luxel_package} COMPONENT dev)

if(NOT LUXEL_SANITIZE AND NOT LUXEL_SANITIZE_THREADS)
  include(${CMAKE_CURRENT_LIST_DIR}/debian.cmake)
endif()
