# The test only needs to know whether images can be read.
if(GSE_OPENCV)
  target_compile_definitions(${test_target} PRIVATE GSE_HAVE_OPENCV=1)
endif()
