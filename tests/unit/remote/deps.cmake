# The protocols are linked; pictures are read by the library of images and films.
target_link_libraries(${test_target} PRIVATE gse_protocols)
set_target_properties(${test_target} PROPERTIES ENABLE_EXPORTS ON)
if(GSE_OPENCV)
  target_link_libraries(${test_target} PRIVATE gse_opencv_files)
endif()
target_link_libraries(${test_target} PRIVATE gse_synth)   # scenes whose parts are known
