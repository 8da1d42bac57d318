# Small encoders and tokenizers are written as the training of the starter model writes them.
target_link_libraries(${test_target} PRIVATE gse_starter)
# torch/torch.h once per program instead of once per file.
target_precompile_headers(${test_target} REUSE_FROM gse_neural)
set_target_properties(${test_target} PROPERTIES UNITY_BUILD ${GSE_UNITY})
