# The editor without its window: what the panels ask for, done by the real application with the real starter
# model.
if(TARGET gse_window)
  target_link_libraries(${test_target} PRIVATE gse_app)
  set_target_properties(${test_target} PROPERTIES ENABLE_EXPORTS ON)
  if(TARGET gse_neural_plugin)
    add_dependencies(${test_target} gse_neural_plugin)
  endif()
endif()
# Image servers are stood in for by a script; its answers are read with the library of protocols.
if(TARGET gse_window AND TARGET gse_protocols)
  target_sources(${test_target} PRIVATE stress/remote/stand_in.cpp)
  target_compile_definitions(${test_target} PRIVATE "GSE_PYTHON=\"${Python3_EXECUTABLE}\"")
  target_link_libraries(${test_target} PRIVATE gse_protocols)
  add_dependencies(${test_target} gse_remote_plugin)
endif()
