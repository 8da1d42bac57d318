# The protocols are linked, and loaded as the program does it; pictures are read by the library of images and
# films.
target_compile_definitions(${test_target} PRIVATE "GSE_PYTHON=\"${Python3_EXECUTABLE}\"")
target_link_libraries(${test_target} PRIVATE gse_pipeline gse_protocols)
set_target_properties(${test_target} PROPERTIES ENABLE_EXPORTS ON)
add_dependencies(${test_target} gse_remote_plugin)
