// Rows, labels and columns of two scenes.
#include "engine/scene/transform/merge.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "engine/base/check.h"
#include "engine/base/error.h"
#include "engine/scene/transform/joined_sets.h"
#include "engine/scene/transform/transformed.h"

namespace gse {
namespace {

Label widened(const Label& label, std::size_t rows) {
    std::vector<float> weight(rows, 0);
    std::vector<std::uint8_t> bits(rows, 0);
    if (label.weight) std::copy(label.weight->begin(), label.weight->end(), weight.begin());
    if (label.bits) std::copy(label.bits->begin(), label.bits->end(), bits.begin());
    return {label.name, std::make_shared<const std::vector<float>>(std::move(weight)),
            std::make_shared<const std::vector<std::uint8_t>>(std::move(bits))};
}

std::string free_name(const std::vector<Label>& labels, const std::string& name) {
    const auto taken = [&](const std::string& candidate) {
        return std::any_of(labels.begin(), labels.end(),
                           [&](const Label& label) { return label.name == candidate; });
    };
    std::string candidate = name;
    for (int number = 2; taken(candidate); ++number) candidate = fmt::format("{} {}", name, number);
    return candidate;
}

}  // namespace

Scene merged(const Scene& host, const Scene& guest, const Affine& placement, const std::string& name) {
    const std::size_t before = host.gaussians.size(), rows = before + guest.gaussians.size();
    Scene scene;
    scene.info = host.info;
    for (const std::string& warning : guest.info.warnings)
        if (std::find(scene.info.warnings.begin(), scene.info.warnings.end(), warning) ==
            scene.info.warnings.end())
            scene.info.warnings.push_back(warning);
    scene.gaussians = joined(std::array{host.gaussians, transformed(guest.gaussians, placement)});
    for (const Label& label : host.labels.labels) scene.labels.labels.push_back(widened(label, rows));
    std::vector<float> weight(rows, 0);
    std::fill(weight.begin() + static_cast<std::ptrdiff_t>(before), weight.end(), 1.0f);
    scene.labels.labels.push_back(make_label(free_name(scene.labels.labels, name), std::move(weight), 0.5f));
    std::vector<std::int64_t> sources(rows, -1);
    std::iota(sources.begin(), sources.begin() + static_cast<std::ptrdiff_t>(before), std::int64_t{0});
    scene.extra = gathered(host.extra, sources);
    return scene;
}

EditNode merge_of(const DocumentState& state, const Scene& guest, const Affine& placement,
                  const std::string& name, std::uint64_t id) {
    GSE_CHECK(id > 0 && id < (std::uint64_t{1} << EditIdShift));
    if (guest.gaussians.size() >= (std::uint64_t{1} << EditIdShift))
        throw Error(ErrorCode::Unsupported, "the scene has more than four thousand million splats",
                    "split it");
    SceneDelta delta;
    delta.changed_rows.sh_degree = state.current.sh_degree();
    delta.added_rows = transformed(guest.gaussians.to_data(), placement);
    delta.added.resize(delta.added_rows.size());
    std::iota(delta.added.begin(), delta.added.end(), id << EditIdShift);
    EditNode node;
    node.id = id;
    node.name = fmt::format("Insert {}", name);
    node.delta = std::make_shared<const SceneDelta>(std::move(delta));
    return node;
}

}  // namespace gse
