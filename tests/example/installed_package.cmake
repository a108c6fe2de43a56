# Installs what was built, then builds a project that finds it: by its component read, and not by one that does not exist.
# Run by CTest with BUILT, SCRATCH, CXX and GENERATOR.

file(REMOVE_RECURSE ${SCRATCH})

function(run expected)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE said ERROR_VARIABLE said)
  string(FIND "${said}" "${expected}" at)
  if((expected STREQUAL "" AND NOT result EQUAL 0) OR at EQUAL -1)
    message(FATAL_ERROR "${ARGN}\nexit ${result}, expected \"${expected}\" in\n${said}")
  endif()
endfunction()

run("" ${CMAKE_COMMAND} --install ${BUILT} --prefix ${SCRATCH}/installed)
set(configure ${CMAKE_COMMAND} -G ${GENERATOR} -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_PREFIX_PATH=${SCRATCH}/installed
              -S ${CMAKE_CURRENT_LIST_DIR}/installed)
run("" ${configure} -B ${SCRATCH}/read -DCOMPONENTS=read)
run("" ${CMAKE_COMMAND} --build ${SCRATCH}/read)
run("usage" ${SCRATCH}/read/reader)
run("" ${configure} -B ${SCRATCH}/both "-DCOMPONENTS=read\;ingest")
run("no component \"write\"" ${configure} -B ${SCRATCH}/unknown -DCOMPONENTS=write)
