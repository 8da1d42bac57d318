# The driver of tests is found by its path; the CUDA version is made with it.
add_library(fake_cuda_driver MODULE ${CMAKE_CURRENT_SOURCE_DIR}/unit/raster/driver/fake_driver.cpp)
target_link_libraries(fake_cuda_driver PRIVATE gse_raster_emulated)
add_dependencies(${test_target} fake_cuda_driver)
target_compile_definitions(${test_target} PRIVATE "GSE_FAKE_CUDA_DRIVER=\"$<TARGET_FILE:fake_cuda_driver>\"")
target_link_libraries(${test_target} PRIVATE gse_raster_emulated ${CMAKE_DL_LIBS})
# It replaces what allocates memory in the whole program.
set_source_files_properties(unit/raster/allocation_test.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
