# torch/torch.h once per program instead of once per file.
target_precompile_headers(${test_target} PRIVATE <torch/torch.h>)
