# Writes OUTPUT, a header with the state of the checkout at SOURCE; touched only when it changes.
#   cmake -DSOURCE=... -DOUTPUT=... -DVERSION=... -P version.cmake
set(state "")
find_package(Git QUIET)
if(GIT_FOUND)
  # Only what is built counts: a commit to a text does not make results of yesterday stale.
  set(sources CMakeLists.txt data emg hill optimise pipelines ":(exclude)*.md" ":(exclude)*.toml")
  execute_process(COMMAND ${GIT_EXECUTABLE} log -1 --format=%h --abbrev=10 -- ${sources}
    WORKING_DIRECTORY ${SOURCE} OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  if(NOT failed AND commit)
    set(state "+g${commit}")
    execute_process(COMMAND ${GIT_EXECUTABLE} diff HEAD -- ${sources}
      WORKING_DIRECTORY ${SOURCE} OUTPUT_VARIABLE changes ERROR_QUIET)
    if(changes)
      string(SHA1 digest "${changes}")
      string(SUBSTRING ${digest} 0 8 digest)
      string(APPEND state ".d${digest}")
    endif()
  endif()
endif()
set(text "#define BRACHIUM_VERSION \"${VERSION}${state}\"\n")
if(EXISTS ${OUTPUT})
  file(READ ${OUTPUT} before)
endif()
if(NOT "${before}" STREQUAL "${text}")
  file(WRITE ${OUTPUT} "${text}")
endif()
