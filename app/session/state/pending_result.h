// The result of a run while nobody has said yet whether it is kept.
#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/engine_names.h"
#include "engine/base/image.h"
#include "engine/pipeline/run/edit_job.h"
#include "engine/scene/document.h"

namespace gse::app {

/// The object that an edit turned into another, and that other; empty for other edits. Words are
/// normalised.
struct Renamed {
    std::string from, to;
};
/// Renaming by a job that has located.
Renamed renamed_by(const EditJob& job);

/// Outcome of an edit that has not been applied yet.
struct PendingResult {
    GaussianSet before, set;
    std::shared_ptr<const std::vector<std::int64_t>> base_to_new;  // [before rows]
    std::vector<std::uint8_t> apart;  // [new rows] 1 = fills a hole, and belongs to no label
    std::string name, recipe, target;
    std::uint64_t seed = 0;
    bool adds = false;
    Renamed renamed;
    double seconds = 0, psnr_outside_db = 0;
    std::size_t changed_outside_label = 0;
    std::string verdict;  // of the model's encoder about the pictures; empty = nothing can judge them
    bool warns = false;   // they do not show the edit
    int stopped_at = -1;  // step at which the artist stopped it; -1 = it ran to its end
    int steps = 0;        // that it would have run
    std::shared_ptr<const Image> thumbnail;
    std::optional<NamedLabel> label;     // over the rows of `before`, that applying it brings along
    std::vector<PendingResult> changes;  // of a sentence with several, each on the set of the one before it;
                                         // empty = one edit
    std::size_t asked = 1;               // changes of the sentence
    std::string failed;                  // why the outcome is not what was asked for, and what to try
    std::vector<std::string> kept_out;   // changes of the sentence that failed, each with the reason

    const PendingResult& last_change() const { return changes.empty() ? *this : changes.back(); }
};

/// Changes as one result: from the set before the first to the last one's.
PendingResult together(std::vector<PendingResult> changes, std::string name);

/// Takes the outcome of a finished run. Throws Error (Cancelled) when it was stopped before its first step.
void fill_pending(EditJob& job, PendingResult& pending);
/// Takes the outcome with its report (edit_output.h).
void fill_pending(EditJob& job, const nlohmann::ordered_json& report, PendingResult& pending);

/// The edit of the stack that it becomes, without identity and delta.
EditNode node_of(const PendingResult& result);

/// The state with its label, and with `id` given to it as an edit on the stack (with_result()). The state
/// must have the rows of `before`.
DocumentState applied(const DocumentState& state, const PendingResult& result, std::uint64_t id);

/// The state with that edit, its node complete, on the stack (stack_edits.h). A label that bore the name of
/// what became another thing bears the new thing's, where no other does.
DocumentState with_result(const DocumentState& state, EditNode node, const PendingResult& result);

/// The edit that was running or waiting when a project was kept (`jobs` of it) comes off the stack again and
/// waits to be applied.
std::optional<PendingResult> take_back_edit(DocumentState& state, const nlohmann::json& jobs);

}  // namespace gse::app
