# Every template is a definition without mistakes once it is given a session and a scene:
#   cmake -DPROGRAM=... -DSESSION=... -DSCENE=... -DFOLDER=... -P check_templates.cmake
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER})
foreach(template emg calibration)
  execute_process(COMMAND ${PROGRAM} new ${template} mine-${template} WORKING_DIRECTORY ${FOLDER} RESULT_VARIABLE code)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "new ${template} ended with exit code ${code}")
  endif()
  set(scene "")
  if(template STREQUAL "calibration")
    set(scene --set pipeline.scene=${SCENE})
  endif()
  execute_process(COMMAND ${PROGRAM} check mine-${template}.toml --set pipeline.session=${SESSION} ${scene}
    WORKING_DIRECTORY ${FOLDER} RESULT_VARIABLE code)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "check of the template ${template} ended with exit code ${code}")
  endif()
endforeach()
