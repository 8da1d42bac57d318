// Loading of weights with exact key accounting.
#include "engine/neural/weights/weights.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "engine/base/error.h"
#include "engine/neural/layers/parallel_for_batches.h"

namespace gse::neural {
namespace {

using Shape = std::vector<std::int64_t>;

Shape shape_of(const torch::Tensor& tensor) { return {tensor.sizes().begin(), tensor.sizes().end()}; }

std::string text_of(const Shape& shape) { return fmt::format("[{}]", fmt::join(shape, ",")); }

// A matrix and a 1x1 convolution of the same matrix hold the same numbers.
Shape without_unit_kernel(Shape shape) {
    if (shape.size() == 4 && shape[2] == 1 && shape[3] == 1) shape.resize(2);
    return shape;
}

Shape expected_in_file(const Shape& parameter, const WeightSource& source) {
    Shape shape = without_unit_kernel(parameter);
    if (source.transpose && shape.size() == 2) std::swap(shape[0], shape[1]);
    if (source.row >= 0) shape[0] *= source.rows;
    return shape;
}

std::string and_more(std::size_t count) { return count > 1 ? fmt::format(" (and {} more)", count - 1) : ""; }

WeightSource source_of(const LoadPlan& plan, const std::string& name) {
    return plan.map ? plan.map(name) : WeightSource{name};
}

}  // namespace

std::set<std::string> check_weights(const torch::nn::Module& module, const KeyShapes& shapes,
                                    const LoadPlan& plan, const std::filesystem::path& path) {
    std::vector<std::string> missing, wrong;
    std::set<std::string> used;
    for (const auto& item : module.named_parameters()) {
        const auto source = source_of(plan, item.key());
        const auto found = shapes.find(source.key);
        if (found == shapes.end()) {
            missing.push_back(source.key);
            continue;
        }
        used.insert(source.key);
        const auto wanted = expected_in_file(shape_of(item.value()), source);
        if (without_unit_kernel(found->second) != wanted)
            wrong.push_back(fmt::format("\"{}\" has the shape {} instead of {}", source.key,
                                        text_of(found->second), text_of(wanted)));
    }
    const char* hint =
        "the weights and the configuration do not belong together, or the download is incomplete";
    if (!missing.empty())
        throw Error(
            ErrorCode::Model,
            fmt::format("the {} has no tensor \"{}\"{}", plan.what, missing[0], and_more(missing.size())),
            hint, path);
    if (!wrong.empty())
        throw Error(ErrorCode::Model,
                    fmt::format("in the {} the tensor {}{}", plan.what, wrong[0], and_more(wrong.size())),
                    hint, path);
    std::vector<std::string> extra;
    for (const auto& [name, shape] : shapes)
        if (!used.contains(name) && !(plan.ignore && plan.ignore(name))) extra.push_back(name);
    if (!extra.empty())
        throw Error(ErrorCode::Model,
                    fmt::format("the {} has a tensor that is not known, \"{}\"{}", plan.what, extra[0],
                                and_more(extra.size())),
                    hint, path);
    return used;
}

std::uint64_t weight_bytes(const torch::nn::Module& module) {
    std::uint64_t bytes = 0;
    for (const auto& parameter : module.parameters())
        bytes += static_cast<std::uint64_t>(parameter.numel()) * sizeof(float);
    return bytes;
}

std::set<std::string> load_weights(torch::nn::Module& module, const TensorFile& file, const LoadPlan& plan) {
    auto used = check_weights(module, file.shapes(), plan, file.path());
    const auto parameters = module.named_parameters().pairs();
    const auto load = [&](const std::string& name, torch::Tensor value) {
        const auto source = source_of(plan, name);
        if (source.row < 0 && !source.transpose) return file.copy_to(source.key, value);
        auto tensor = file.tensor(source.key);
        if (source.transpose) tensor = tensor.t();
        if (source.row >= 0) tensor = tensor.chunk(source.rows, 0)[static_cast<std::size_t>(source.row)];
        value.copy_(tensor.reshape(value.sizes()));
    };
    // Reading, converting and the pages of the new weights take one thread each their time; every n-th,
    // because sizes grow with the level.
    const std::int64_t threads = batch_threads();
    parallel_for_batches(threads, true, [&](std::int64_t begin, std::int64_t end) {
        for (auto first = begin; first < end; ++first)
            for (auto i = static_cast<std::size_t>(first); i < parameters.size();
                 i += static_cast<std::size_t>(threads))
                load(parameters[i].first, parameters[i].second);
    });
    return used;
}

}  // namespace gse::neural
