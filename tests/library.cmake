# Installs luxel into a folder of its own, moves it, and builds and runs the programs of
# examples/library against it, as someone would who has nothing else of luxel:
# cmake -D BUILD=... -D SOURCE=... -D FOLDER=... -D CXX=... -D PYTHON=... -P library.cmake
function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

file(REMOVE_RECURSE ${FOLDER})
# Without its 300 lines of what went where: CI shows the first 60 lines of a test that failed.
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${FOLDER}/installed OUTPUT_QUIET)
file(RENAME ${FOLDER}/installed ${FOLDER}/moved)
set(luxel ${FOLDER}/moved/bin/luxel)
run(${FOLDER}/moved/bin/luxel-view --version)  # with the library beside it that has its panel
run(${PYTHON} ${SOURCE}/tools/check_api.py --installed ${FOLDER}/moved)

# A program that includes the whole API, in the order of its table.
execute_process(COMMAND ${PYTHON} ${SOURCE}/tools/check_api.py --headers OUTPUT_VARIABLE headers
                COMMAND_ERROR_IS_FATAL ANY)
string(REGEX REPLACE "([^\n]+)" "#include \"\\1\"" includes "${headers}")
file(WRITE ${FOLDER}/api/api.cpp "${includes}int main() {}\n")
file(WRITE ${FOLDER}/api/CMakeLists.txt "cmake_minimum_required(VERSION 3.25)
project(api LANGUAGES CXX)
find_package(luxel REQUIRED)
add_executable(api api.cpp)
target_link_libraries(api PRIVATE luxel::pipeline luxel::relight)
")

# build(SOURCE NAME [arguments of cmake...])
function(build source name)
  run(${CMAKE_COMMAND} -G Ninja -S ${source} -B ${FOLDER}/build/${name} -Wno-dev
      -DCMAKE_PREFIX_PATH=${FOLDER}/moved -DCMAKE_CXX_COMPILER=${CXX} ${ARGN})
  run(${CMAKE_COMMAND} --build ${FOLDER}/build/${name})
endfunction()
set(examples ${SOURCE}/examples/library)
# Where there is nothing of what only the pipeline needs.
build(${examples}/relight relight -DCMAKE_DISABLE_FIND_PACKAGE_assimp=ON -DCMAKE_DISABLE_FIND_PACKAGE_TinyGLTF=ON
      -DCMAKE_DISABLE_FIND_PACKAGE_meshoptimizer=ON -DCMAKE_DISABLE_FIND_PACKAGE_tinyobjloader=ON
      -DCMAKE_DISABLE_FIND_PACKAGE_pugixml=ON
      -DCMAKE_DISABLE_FIND_PACKAGE_nlohmann_json=ON)
run(${luxel} relight ${SOURCE}/scenes/cornell-box.glb --patches 300 --rays 256 --target none
    -o ${FOLDER}/box.lxr)
run(${FOLDER}/build/relight/relight ${FOLDER}/box.lxr 3)

build(${examples}/bake_in_memory bake_in_memory)
run(${FOLDER}/build/bake_in_memory/bake_in_memory ${FOLDER}/baked)
foreach(file lightmap.exr preview.png)
  if(NOT EXISTS ${FOLDER}/baked/${file})
    message(FATAL_ERROR "bake_in_memory wrote no ${file}")
  endif()
endforeach()
build(${FOLDER}/api api)
