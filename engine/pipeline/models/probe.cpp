// Thinning by rows.
#include "engine/pipeline/models/probe.h"

#include <array>
#include <vector>

#include "engine/base/check.h"

namespace gse::pipeline {

ProbeScene probe_scene(const GaussianSet& scene, const edit::EditPlan& plan, std::size_t most) {
    GSE_CHECK_EQ(plan.label.size(), scene.size());
    ProbeScene probe{scene, plan};
    if (scene.size() <= most || most == 0) return probe;
    const std::size_t every = (scene.size() + most - 1) / most;
    std::array<std::size_t, 2> seen{};  // not labelled, labelled
    std::vector<unsigned char> keep(scene.size(), 0);
    probe.plan.label.clear();
    for (std::size_t row = 0; row < scene.size(); ++row) {
        const std::uint8_t labelled = plan.label[row] != 0 ? 1 : 0;
        if (seen[labelled]++ % every != 0) continue;
        keep[row] = 1;
        probe.plan.label.push_back(labelled);
    }
    probe.set = scene.filtered(keep);
    return probe;
}

}  // namespace gse::pipeline
