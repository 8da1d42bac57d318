# Scenes whose words are known.
target_link_libraries(${test_target} PRIVATE gse_synth)

# The networks' plug-in shares the program's log and error types.
set_target_properties(${test_target} PROPERTIES ENABLE_EXPORTS ON)
if(TARGET gse_neural_plugin)
  add_dependencies(${test_target} gse_neural_plugin)
endif()
