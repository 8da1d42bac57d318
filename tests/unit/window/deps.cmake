if(TARGET gse_window)
  target_link_libraries(${test_target} PRIVATE gse_app glfw)
  target_compile_definitions(${test_target} PRIVATE GSE_WINDOW=1)
endif()
