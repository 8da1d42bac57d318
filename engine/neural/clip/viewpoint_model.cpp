// Loading, and one picture at a time.
#include "engine/neural/clip/viewpoint_model.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/base/json.h"
#include "engine/neural/layers/images.h"
#include "engine/neural/layers/torch_errors.h"
#include "engine/neural/weights/safetensors.h"
#include "engine/neural/weights/weights.h"

namespace gse::neural {
namespace {

constexpr std::int64_t MostSide = 1024, MostSectors = 3600, MostWidth = 4096;

void require(bool holds, const std::string& key, const std::filesystem::path& path) {
    if (!holds)
        throw Error(ErrorCode::Model, "\"" + key + "\" of the viewpoint classifier is out of range", {},
                    path);
}

std::filesystem::path existing_file(const std::filesystem::path& path) {
    if (!std::filesystem::exists(path))
        throw Error(ErrorCode::NotFound, "the viewpoint classifier is incomplete",
                    "it has config.json and model.safetensors", path);
    return path;
}

}  // namespace

ViewpointConfig ViewpointConfig::from_json(const Json& json, const std::filesystem::path& path) {
    ViewpointConfig config;
    try {
        config.image_size = json.value("image_size", config.image_size);
        config.sectors = json.value("sectors", config.sectors);
        config.widths = json.value("widths", config.widths);
        config.hidden = json.value("hidden", config.hidden);
        config.groups = json.value("groups", config.groups);
    } catch (const Json::exception& error) {
        throw Error(
            ErrorCode::Malformed,
            fmt::format("the configuration of the viewpoint classifier cannot be read: {}", error.what()), {},
            path);
    }
    const auto levels = static_cast<std::int64_t>(config.widths.size());
    require(levels >= 1 && levels <= 8, "widths", path);
    require(config.groups >= 1, "groups", path);
    for (const auto width : config.widths)
        require(width >= 1 && width <= MostWidth && width % config.groups == 0, "widths", path);
    require(config.image_size >= 1 && config.image_size <= MostSide &&
                config.image_size % (std::int64_t{1} << levels) == 0,
            "image_size", path);
    require(config.sectors >= 4 && config.sectors <= MostSectors, "sectors", path);
    require(config.hidden >= 1 && config.hidden <= MostWidth, "hidden", path);
    return config;
}

ViewpointModelImpl::ViewpointModelImpl(const ViewpointConfig& config, const WeightOptions& options) {
    std::int64_t before = 3;
    for (std::size_t level = 0; level < config.widths.size(); ++level) {
        const auto width = config.widths[level];
        down_.push_back(register_module(fmt::format("down{}", level),
                                        Conv2d(Conv2dImpl::Shape{before, width, 3, 2, 1}, options)));
        blocks_.push_back(register_module(fmt::format("block{}", level),
                                          ResnetBlock(ResnetShape{width, width, config.groups}, options)));
        before = width;
    }
    const auto side = config.image_size >> config.widths.size();
    norm_ = register_module("norm", GroupNorm(before, config.groups, 1e-5, options));
    hidden_ =
        register_module("hidden", Linear(LinearImpl::Shape{before * side * side, config.hidden}, options));
    out_ = register_module("out", Linear(LinearImpl::Shape{config.hidden, config.sectors}, options));
}

torch::Tensor ViewpointModelImpl::forward(const torch::Tensor& pictures) const {
    auto x = pictures;
    for (std::size_t level = 0; level < down_.size(); ++level)
        x = blocks_[level]->forward(down_[level]->forward(x), {});
    x = torch::silu(hidden_->forward(norm_->forward_silu(x).flatten(1)));
    return out_->forward(x).log_softmax(1);
}

ViewpointReader::ViewpointReader(const std::filesystem::path& folder, torch::Device device)
    : config_(ViewpointConfig::from_json(read_json_file(existing_file(folder / "config.json")),
                                         folder / "config.json")),
      device_(device), model_(loaded_network<ViewpointModel>(
                           config_, SafetensorsFile(existing_file(folder / "model.safetensors")),
                           LoadPlan{{}, {}, "viewpoint classifier"})) {
    for (auto& parameter : model_->parameters()) parameter.set_requires_grad(false);
    model_->to(device_);
    model_->eval();
}

std::vector<float> ViewpointReader::shares(const Image& picture) const {
    return guard_torch("looking from where a picture was taken", [&] {
        const torch::NoGradGuard no_grad;
        auto x = to_tensor(picture, device_).slice(1, 0, 3).clamp(0.0, 1.0);
        const auto side = std::min(x.size(2), x.size(3));
        x = x.narrow(2, (x.size(2) - side) / 2, side).narrow(3, (x.size(3) - side) / 2, side);
        const auto values = model_->forward(resize_square(x, config_.image_size) * 2 - 1)
                                .exp()
                                .to(torch::kCPU, torch::kFloat32)
                                .contiguous();
        return std::vector<float>(values.data_ptr<float>(), values.data_ptr<float>() + values.numel());
    });
}

}  // namespace gse::neural
