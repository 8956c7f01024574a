# The page of `luxel bake --html` as a C++ file, bundled from npm's three with esbuild.
#
# It is made when the build is configured: cmake runs again when a source of the page changes, and,
# where node, npm or the network was missing, tries again each time it runs. luxel builds without
# the page too; --html then says what is missing.

# luxel_bundle_view(VARIABLE): sets VARIABLE to the path of the C++ file.
function(luxel_bundle_view variable)
  set(sources package.json package-lock.json build.mjs page.html view.js data.js camera.js layers.js material.js)
  set(folder ${CMAKE_BINARY_DIR}/web)
  set(result ${folder}/view_template.cpp)
  set(${variable} ${result} PARENT_SCOPE)

  set(hashes "")
  foreach(source ${sources})
    set(path ${CMAKE_CURRENT_SOURCE_DIR}/web/${source})
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${path})
    file(SHA256 ${path} hash)
    list(APPEND hashes ${hash})
    configure_file(${path} ${folder}/${source} COPYONLY)
  endforeach()
  if(EXISTS ${folder}/made_from AND EXISTS ${result})
    file(READ ${folder}/made_from made_from)
    if(made_from STREQUAL "${hashes}")
      return()
    endif()
  endif()

  file(REMOVE ${folder}/made_from)
  luxel_run_bundler(${folder} missing)
  if(missing)
    message(STATUS "luxel bake --html is left out: ${missing}")
    configure_file(${CMAKE_CURRENT_SOURCE_DIR}/web/no_view_template.cpp.in ${result} @ONLY)
  else()
    configure_file(${folder}/bundled.cpp ${result} COPYONLY)
    file(WRITE ${folder}/made_from "${hashes}")
  endif()
endfunction()

# Makes FOLDER/bundled.cpp; what is missing for it goes into VARIABLE, nothing when it worked.
function(luxel_run_bundler folder variable)
  find_program(LUXEL_NODE node)
  find_program(LUXEL_NPM npm)
  if(NOT LUXEL_NODE OR NOT LUXEL_NPM)
    set(${variable} "node and npm are not installed (Debian packages nodejs and npm)" PARENT_SCOPE)
    return()
  endif()
  message(STATUS "Bundling the page of luxel bake --html")
  file(SHA256 ${folder}/package-lock.json lock)
  if(NOT EXISTS ${folder}/node_modules/luxel-${lock})
    # Without install scripts: esbuild's program is a package of its own.
    execute_process(COMMAND ${LUXEL_NPM} ci --ignore-scripts --no-audit --no-fund --prefer-offline
                            --fetch-retries=1 --fetch-timeout=30000
                    WORKING_DIRECTORY ${folder} RESULT_VARIABLE status
                    OUTPUT_FILE ${folder}/npm.log ERROR_FILE ${folder}/npm.log TIMEOUT 180)
    if(NOT status EQUAL 0)
      set(${variable}
          "npm could not fetch three and esbuild, is there a network? (${folder}/npm.log)"
          PARENT_SCOPE)
      return()
    endif()
    file(TOUCH ${folder}/node_modules/luxel-${lock})
  endif()
  execute_process(COMMAND ${LUXEL_NODE} build.mjs bundled.cpp WORKING_DIRECTORY ${folder}
                  RESULT_VARIABLE status ERROR_VARIABLE problem)
  if(NOT status EQUAL 0)
    message(STATUS "${problem}")
    set(${variable} "esbuild failed" PARENT_SCOPE)
    return()
  endif()
  set(${variable} "" PARENT_SCOPE)
endfunction()
