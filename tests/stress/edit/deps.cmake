# GSE_STRESS_ITERATIONS = iterations of the long run (10,000 in the ordinary run, 200,000 in the full one).
add_test(NAME ${label}.${module}_full CONFIGURATIONS Full COMMAND ${test_target} "-tc=*long run*"
  WORKING_DIRECTORY ${CMAKE_SOURCE_DIR})
set_tests_properties(${label}.${module}_full PROPERTIES LABELS ${label}
  SKIP_RETURN_CODE ${GSE_SKIP_CODE} TIMEOUT 10800
  ENVIRONMENT "GSE_STRESS_ITERATIONS=200000")
