# The editor without its window: what the panels ask for, done by the real application with the real starter
# model.
if(TARGET gse_window)
  target_link_libraries(${test_target} PRIVATE gse_app)
  set_target_properties(${test_target} PROPERTIES ENABLE_EXPORTS ON)
  if(TARGET gse_neural_plugin)
    add_dependencies(${test_target} gse_neural_plugin)
  endif()
endif()
