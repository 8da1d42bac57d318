# torch/torch.h once per program instead of once per file.
target_precompile_headers(${test_target} REUSE_FROM gse_neural)
set_target_properties(${test_target} PROPERTIES UNITY_BUILD ${GSE_UNITY})
