# The graph cut is OpenCV's.
if(GSE_OPENCV)
  target_compile_definitions(${test_target} PRIVATE GSE_HAVE_OPENCV=1)
endif()
