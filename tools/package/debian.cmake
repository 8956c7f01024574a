# The target `packages`: the .deb files of Debian, in the folder packages of the build (docs/guide/install.md).

set(luxel_maintainer "luxel maintainers <maintainers@luxel.example>" CACHE STRING
    "Name and address in the .deb files; whoever passes them on puts their own here")
set(debian ${CMAKE_CURRENT_LIST_DIR}/debian)
set(package_files ${CMAKE_BINARY_DIR}/package_files)  # what only packages have
set(components luxel view dev)
set(package_of_luxel luxel)
set(package_of_view luxel-view)
set(package_of_dev libluxel-dev)
set(package_of_python python3-luxel)
if(TARGET luxel_python)
  list(APPEND components python)
endif()

# Each package has a notice of all licences in it, and a changelog.
configure_file(${debian}/changelog.in ${package_files}/changelog @ONLY)
set(three ${CMAKE_BINARY_DIR}/web/node_modules/three/LICENSE)
if(NOT EXISTS ${CMAKE_BINARY_DIR}/web/made_from)  # view.html's page was not bundled: there is no three.js in it
  set(three "")
endif()
set(notices "")
set(make_notices ${CMAKE_CURRENT_LIST_DIR}/make_notices.py)
foreach(component ${components})
  set(package ${package_of_${component}})
  set(notice ${package_files}/${package}/copyright)
  add_custom_command(OUTPUT ${notice} COMMENT "Licences of ${package}" VERBATIM DEPENDS ${make_notices} ${three}
                     COMMAND Python3::Interpreter ${make_notices} ${package} ${notice} ${three})
  list(APPEND notices ${notice})
  install(FILES ${notice} ${package_files}/changelog.gz DESTINATION ${share}/doc/${package}
          COMPONENT ${component} EXCLUDE_FROM_ALL)
endforeach()
add_custom_command(OUTPUT ${package_files}/changelog.gz DEPENDS ${package_files}/changelog VERBATIM
                   COMMAND sh -c "gzip -9nc '${package_files}/changelog' > '${package_files}/changelog.gz'")

set(CPACK_GENERATOR DEB)
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_PACKAGE_NAME luxel)
set(CPACK_PACKAGE_VENDOR luxel)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE
    WORLD_READ WORLD_EXECUTE)
set(CPACK_COMPONENTS_ALL ${components})
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_COMPRESSION_TYPE gzip)  # a third longer than by xz, and made in a quarter of the time
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "${luxel_maintainer}")
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_RUNTIME_OUTPUT_DIRECTORY})
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

# luxel opens Vulkan and is started by mpirun where they are there.
set(CPACK_DEBIAN_LUXEL_PACKAGE_NAME luxel)
set(CPACK_DEBIAN_LUXEL_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_LUXEL_PACKAGE_SUGGESTS "luxel-view, libvulkan1, mesa-vulkan-drivers | vulkan-icd, openmpi-bin")
set(CPACK_DEBIAN_LUXEL_DESCRIPTION "diffuse global illumination: bakes lightmaps
luxel reads a glTF, OBJ, FBX or .x scene and bakes lightmaps. They hold all
bounces of light, with colour bleeding and soft shadows. It also prepares
scenes whose lamps move in real time, and computes view factors and
illuminance.
.
It runs on the processor. A graphics card can trace most rays of a bake.")

set(CPACK_DEBIAN_VIEW_PACKAGE_NAME luxel-view)
set(CPACK_DEBIAN_VIEW_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_VIEW_PACKAGE_RECOMMENDS "mesa-vulkan-drivers | vulkan-icd")
set(CPACK_DEBIAN_VIEW_PACKAGE_SUGGESTS luxel)
set(CPACK_DEBIAN_VIEW_DESCRIPTION "window to look at baked light
luxel-view draws what luxel has baked, and lets you walk about in it. It bakes
a scene while you look, moves lamps with all bounces of light, and opens .lxr
files.
.
It needs a driver for Vulkan: that of a graphics card, or Mesa's on the
processor.")

# What luxelConfig.cmake looks for, and what the archives link besides.
set(CPACK_DEBIAN_DEV_PACKAGE_NAME libluxel-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_SHLIBDEPS OFF)
set(dev_depends libembree-dev libtbb-dev libopenexr-dev libstb-dev libtinygltf-dev nlohmann-json3-dev
    libmeshoptimizer-dev libjpeg-dev libwebp-dev libtinyobjloader-dev libpugixml-dev libassimp-dev libeigen3-dev zlib1g-dev
    libfmt-dev)
list(JOIN dev_depends ", " CPACK_DEBIAN_DEV_PACKAGE_DEPENDS)
set(CPACK_DEBIAN_DEV_DESCRIPTION "library of luxel for C++ programs
Headers, static libraries and a CMake package. luxel::pipeline reads scenes,
bakes and renders them within a program. luxel::relight plays .lxr files:
scenes whose lamps move with all bounces of light.")

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-luxel)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
math(EXPR next_python "${Python3_VERSION_MINOR} + 1")
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
    "python3 (>= 3.${Python3_VERSION_MINOR}), python3 (<< 3.${next_python}), python3-numpy")
set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS python3-scipy)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS luxel)  # luxel.load(any_format=True)
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA "${debian}/postinst;${debian}/prerm")
set(CPACK_DEBIAN_PYTHON_DESCRIPTION "module of luxel for Python
Bakes, rays, view factors and moving light as numpy arrays, for scripts and
notebooks. Scenes are files, or made of arrays.")
include(CPack)

# Not the target `package`, which builds all tests first. The files appear when all of them are whole.
set(package_targets luxel luxel-bench luxel-view luxel_pages luxel_pipeline luxel_relight)
if(TARGET luxel_python)
  list(APPEND package_targets luxel_python)
endif()
set(work ${CMAKE_BINARY_DIR}/package_work)
set(result ${CMAKE_BINARY_DIR}/packages)
add_custom_target(packages
  COMMAND ${CMAKE_COMMAND} -E rm -rf ${work}
  COMMAND ${CMAKE_CPACK_COMMAND} --config ${CMAKE_BINARY_DIR}/CPackConfig.cmake -B ${work}
  COMMAND ${CMAKE_COMMAND} -E rm -rf ${result}
  COMMAND ${CMAKE_COMMAND} -E make_directory ${result}
  COMMAND sh -c "mv '${work}'/*.deb '${result}'"
  COMMAND ${CMAKE_COMMAND} -E rm -rf ${work}
  DEPENDS ${package_targets} ${notices} ${package_files}/changelog.gz
  COMMENT "Packages for Debian, in ${result}" VERBATIM USES_TERMINAL)
