// The layers all networks are built of: parameters named as in diffusers and transformers, norms computed in
// fp32.
#pragma once

#include <torch/torch.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gse::neural {

/// Options of new parameters. `initialize` false leaves them undefined until they are loaded; on torch::kMeta
/// only names and shapes exist.
struct WeightOptions {
    torch::Device device = torch::kCPU;
    torch::Dtype dtype = torch::kFloat32;
    bool initialize = true;
};

/// A layer that can draw its own weights (uniform in +-1/sqrt(fan in), as torch does).
class Resettable {
public:
    virtual ~Resettable() = default;
    virtual void reset() = 0;
};

/// y = x W^T + b. A weight stored as a 1x1 convolution [out,in,1,1] is used the same way.
class LinearImpl : public torch::nn::Module, public Resettable {
public:
    struct Shape {
        std::int64_t in = 0, out = 0;
        bool bias = true;
        bool as_convolution = false;
    };
    LinearImpl(const Shape& shape, const WeightOptions& options);
    void reset() override;
    torch::Tensor forward(const torch::Tensor& x) const;
    torch::Tensor weight, bias;
};
TORCH_MODULE(Linear);

/// 2D convolution with a square kernel.
class Conv2dImpl : public torch::nn::Module, public Resettable {
public:
    struct Shape {
        std::int64_t in = 0, out = 0, kernel = 3, stride = 1, padding = 1;
        bool bias = true;
    };
    Conv2dImpl(const Shape& shape, const WeightOptions& options);
    void reset() override;
    torch::Tensor forward(const torch::Tensor& x) const;
    torch::Tensor weight, bias;

private:
    Shape shape_;
};
TORCH_MODULE(Conv2d);

/// Group normalisation of [B,C,H,W]; half and bfloat16 inputs are normalised in fp32. Optionally followed by
/// SiLU.
class GroupNormImpl : public torch::nn::Module, public Resettable {
public:
    GroupNormImpl(std::int64_t channels, std::int64_t groups, double eps, const WeightOptions& options);
    void reset() override;
    torch::Tensor forward(const torch::Tensor& x) const;
    torch::Tensor forward_silu(const torch::Tensor& x) const;
    torch::Tensor weight, bias;

private:
    std::int64_t groups_;
    double eps_;
};
TORCH_MODULE(GroupNorm);

/// Layer normalisation of the last dimension; half and bfloat16 inputs are normalised in fp32.
class LayerNormImpl : public torch::nn::Module, public Resettable {
public:
    LayerNormImpl(std::int64_t width, double eps, const WeightOptions& options);
    void reset() override;
    torch::Tensor forward(const torch::Tensor& x) const;
    torch::Tensor weight, bias;

private:
    double eps_;
};
TORCH_MODULE(LayerNorm);

/// Rows of a table [count,width] picked by integer ids.
class EmbeddingImpl : public torch::nn::Module, public Resettable {
public:
    EmbeddingImpl(std::int64_t count, std::int64_t width, double initial_std, const WeightOptions& options);
    void reset() override;
    torch::Tensor forward(const torch::Tensor& ids) const;
    torch::Tensor weight;

private:
    double initial_std_;
};
TORCH_MODULE(Embedding);

/// Draws all weights of `module` anew from `seed`.
void init_weights(torch::nn::Module& module, std::uint64_t seed);

/// x * sigmoid(x), in place when no graph is recorded.
torch::Tensor apply_silu(torch::Tensor x);

/// Result of one attention.
struct AttentionRequest {
    std::int64_t heads = 1;
    bool upcast = false;  // scores in fp32 even for half inputs (SD 2.1)
    torch::Tensor mask;   // added to the scores, broadcast to [B,heads,N,M]; undefined = none
    bool want_probabilities = false;
};

struct AttentionResult {
    torch::Tensor output;         // [B,N,C], heads merged
    torch::Tensor probabilities;  // [B,heads,N,M] fp32, only when wanted
};

/// softmax(q k^T / sqrt(d)) v for q [B,N,C], k and v [B,M,C]. Never goes through baddbmm with beta 0 (NaN at
/// random in libtorch 1.13); long sequences are done in pieces when no graph is recorded.
AttentionResult attend(const torch::Tensor& q, const torch::Tensor& k, const torch::Tensor& v,
                       const AttentionRequest& request);

/// [B,C,H,W] -> [B,H*W,C] (a view for channels-last memory) and back.
torch::Tensor image_to_tokens(const torch::Tensor& x);
torch::Tensor tokens_to_image(const torch::Tensor& tokens, std::int64_t height, std::int64_t width);

/// A list of modules whose names are "0", "1", ...; typed access beside torch's registration.
template <class Holder>
std::vector<Holder> register_list(torch::nn::Module& parent, const std::string& name,
                                  std::vector<Holder> modules) {
    torch::nn::ModuleList list;
    for (const auto& module : modules) list->push_back(module.ptr());
    parent.register_module(name, list);
    return modules;
}

}  // namespace gse::neural
