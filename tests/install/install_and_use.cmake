# Installs this build and builds and runs a project that finds it:
# cmake -DBUILD=<build folder> -DSOURCE=<tests/install> -DWHERE=<empty folder> -DCXX=<compiler> -DTYPE=<build type> -P install_and_use.cmake
function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE code OUTPUT_VARIABLE said ERROR_VARIABLE said)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "${said}\n`${ARGV}` ended with ${code}")
  endif()
endfunction()
file(REMOVE_RECURSE ${WHERE})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WHERE}/prefix)
run(${CMAKE_COMMAND} -S ${SOURCE} -B ${WHERE}/build -DCMAKE_PREFIX_PATH=${WHERE}/prefix -DCMAKE_CXX_COMPILER=${CXX}
    -DCMAKE_BUILD_TYPE=${TYPE})
run(${CMAKE_COMMAND} --build ${WHERE}/build)
run(${WHERE}/build/consumer)
run(${WHERE}/prefix/bin/brachium check ${WHERE}/prefix/share/brachium/pipelines/demo.toml)
