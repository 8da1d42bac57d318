# Draws the window in every state into pictures (build folder, ui_gallery/) and holds them against baselines.
if(TARGET gse_ui)
  target_sources(${test_target}
    PRIVATE image_baseline.cpp ui/support/soft_renderer.cpp ui/support/fake_application.cpp
      ui/support/fake_commands.cpp ui/support/harness.cpp)
  target_link_libraries(${test_target} PRIVATE gse_ui gse_raster gse_synth gse_io)
endif()
