# GSE_STRESS_SCENES = hostile scenes per cause (50 in the ordinary run, 500 in the full one).
target_link_libraries(${test_target} PRIVATE gse_bench gse_raster_emulated)
set_target_properties(${test_target}
  PROPERTIES ENABLE_EXPORTS ON)   # the networks' plug-in shares the program's log
add_test(NAME ${label}.${module}_full CONFIGURATIONS Full COMMAND ${test_target}
  WORKING_DIRECTORY ${CMAKE_SOURCE_DIR})
set_tests_properties(${label}.${module}_full PROPERTIES LABELS ${label}
  SKIP_RETURN_CODE ${GSE_SKIP_CODE} TIMEOUT 10800
  ENVIRONMENT "GSE_STRESS_SCENES=500")
