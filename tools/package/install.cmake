# What `cmake --install` copies: the programs, the headers and static libraries of the rooms, and a
# CMake package whose targets are luxel::pipeline and luxel::relight. docs/guide/library.md.

# The rooms that playing an .lxr file needs: free of Assimp and CGAL. The others need these.
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
    install(TARGETS luxel_${room} EXPORT ${export} ARCHIVE DESTINATION ${luxel_archives})
  endforeach()
  install(EXPORT ${export} NAMESPACE luxel:: DESTINATION ${luxel_package})
endfunction()
luxel_install_rooms(luxelRelightTargets ${luxel_relight_rooms} relight)
luxel_install_rooms(luxelPipelineTargets ${luxel_pipeline_rooms})
install(TARGETS luxel luxel-view RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(TARGETS luxel_view_ui LIBRARY DESTINATION ${luxel_archives})
file(RELATIVE_PATH view_ui_folder /${CMAKE_INSTALL_BINDIR} /${luxel_archives})
set_target_properties(luxel-view PROPERTIES INSTALL_RPATH "$ORIGIN/${view_ui_folder}")
install(FILES ${draco_archive} DESTINATION ${luxel_archives})

# One by one, because install(DIRECTORY) would leave folders without headers, too. Without those of rooms
# that are not installed (the devices', the window's and the tests'), and of Embree, which only trace
# includes.
file(GLOB_RECURSE headers CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/luxel/*.h)
list(FILTER headers EXCLUDE REGEX "(^luxel/(validate|cluster|gpu|view|trace/embree|trace/vulkan|light/device|solve/device|reference/device)/|/test_|_test[_.]|/thread_team|/node_modules/)")
foreach(header ${headers})
  get_filename_component(folder ${header} DIRECTORY)
  install(FILES ${PROJECT_SOURCE_DIR}/${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/${folder})
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
        DESTINATION ${luxel_package})
