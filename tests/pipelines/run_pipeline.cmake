# Runs one definition into an empty folder, and reads its report:
# cmake -DPROGRAM=... -DDEFINITION=... -DOUT=... -DARGS=... -DPYTHON=... -DREADER=report_wellformed.py -DSAYS=... -P run_pipeline.cmake
file(REMOVE_RECURSE ${OUT})
execute_process(COMMAND ${PROGRAM} run ${DEFINITION} --out ${OUT} ${ARGS} RESULT_VARIABLE code)
if(NOT code EQUAL 0)
  message(FATAL_ERROR "${DEFINITION} ended with exit code ${code}")
endif()
execute_process(COMMAND ${PYTHON} ${READER} ${OUT}/report.html ${SAYS} RESULT_VARIABLE code)
if(NOT code EQUAL 0)
  message(FATAL_ERROR "the report of ${DEFINITION} is not what it should be")
endif()
