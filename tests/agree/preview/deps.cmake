target_link_libraries(${test_target} PRIVATE gse_preview gse_raster)
