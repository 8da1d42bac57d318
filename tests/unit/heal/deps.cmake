# The scenes that things are removed from are drawn by the synthetic world.
target_link_libraries(${test_target} PRIVATE gse_synth gse_raster gse_evaluate)
