// The result of a run while nobody has said yet whether it is kept.
#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/image.h"
#include "engine/pipeline/edit_job.h"
#include "engine/scene/document.h"

namespace gse::pipeline {

/// What came of an edit that has not been applied yet.
struct PendingResult {
    GaussianSet before, set;
    std::shared_ptr<const std::vector<std::int64_t>> base_to_new;   // [before rows]
    std::string name, recipe, target;
    std::uint64_t seed = 0;
    bool adds = false;
    double seconds = 0, psnr_outside_db = 0;
    std::size_t changed_outside_label = 0;
    std::shared_ptr<const Image> thumbnail;
};

/// Takes what a finished run leaves. Throws Error (Cancelled) when it was stopped before its first step.
void fill_pending(EditJob& job, PendingResult& pending);

/// The edit of the stack that it becomes, without identity and delta.
EditNode node_of(const PendingResult& result);

/// The edit that was running or waiting when a project was kept (`jobs` of it) comes off the stack again and waits to be applied.
std::optional<PendingResult> take_back_edit(DocumentState& state, const nlohmann::json& jobs);

}  // namespace gse::pipeline
