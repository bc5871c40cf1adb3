# Runs one definition into an empty folder: cmake -DPROGRAM=... -DDEFINITION=... -DOUT=... -DARGS=... -P run_pipeline.cmake
file(REMOVE_RECURSE ${OUT})
execute_process(COMMAND ${PROGRAM} run ${DEFINITION} --out ${OUT} ${ARGS} RESULT_VARIABLE code)
if(NOT code EQUAL 0)
  message(FATAL_ERROR "${DEFINITION} ended with exit code ${code}")
endif()
