target_link_libraries(${test_target} PRIVATE gse_io)
if(GSE_OPENCV)
  target_compile_definitions(${test_target} PRIVATE GSE_HAVE_OPENCV=1)
endif()
