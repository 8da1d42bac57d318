target_link_libraries(${test_target} PRIVATE gse_raster_emulated)
