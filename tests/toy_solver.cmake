# Applies the diffs in ARCHITECTURE.md to copies of the files that it changes.
#
#   cmake -D SOURCE=... -D FOLDER=... -D "FILES=a b" -P toy_solver.cmake    FILES relative to SOURCE
separate_arguments(FILES)
foreach(file ${FILES})
  get_filename_component(folder ${FOLDER}/${file} DIRECTORY)
  file(COPY ${SOURCE}/${file} DESTINATION ${folder})
endforeach()
file(REMOVE ${FOLDER}/luxel/pipeline/solver/paths.cpp)
# Text around a diff is skipped.
execute_process(COMMAND patch --batch --forward --strip 1 --directory ${FOLDER}
                        --input ${SOURCE}/ARCHITECTURE.md
                RESULT_VARIABLE failed OUTPUT_VARIABLE said ERROR_VARIABLE said)
if(failed)
  message(FATAL_ERROR "ARCHITECTURE.md's diff of a toy solver or of a new member does not apply any more:\n${said}")
endif()
