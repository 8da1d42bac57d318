# The protocols are linked; pictures are read by the library of images and films.
target_compile_definitions(${test_target} PRIVATE "GSE_PYTHON=\"${Python3_EXECUTABLE}\"")
if(TARGET gse_protocols)
  target_link_libraries(${test_target} PRIVATE gse_protocols)
  set_target_properties(${test_target} PROPERTIES ENABLE_EXPORTS ON)
endif()
