# The protocols are linked; pictures are read by the library of images and films.
if(TARGET gse_protocols)
  target_link_libraries(${test_target} PRIVATE gse_protocols)
  set_target_properties(${test_target} PROPERTIES ENABLE_EXPORTS ON)
endif()
if(GSE_OPENCV)
  target_link_libraries(${test_target} PRIVATE gse_opencv_files)
endif()
