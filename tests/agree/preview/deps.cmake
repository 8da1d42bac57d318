target_sources(${test_target} PRIVATE image_baseline.cpp)
target_link_libraries(${test_target} PRIVATE gse_preview gse_raster gse_io)
