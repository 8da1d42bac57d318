# The fake application shows a synthetic scene that the engine's rasterizer draws.
target_sources(${test_target}
  PRIVATE ui/support/soft_renderer.cpp ui/support/fake_application.cpp ui/support/fake_commands.cpp
    ui/support/harness.cpp)
target_link_libraries(${test_target} PRIVATE gse_ui gse_raster gse_synth)
