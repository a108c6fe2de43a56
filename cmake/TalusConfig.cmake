include(${CMAKE_CURRENT_LIST_DIR}/TalusDependencies.cmake)
talus_report_missing()
include(${CMAKE_CURRENT_LIST_DIR}/TalusTargets.cmake)
