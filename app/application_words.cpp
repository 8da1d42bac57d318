// Words: which of the sentence the model reads, what applied edits have said already, and what a label says of the edit.
#include <algorithm>

#include "app/application.h"
#include "app/engine_names.h"
#include "engine/base/error.h"
#include "engine/base/json.h"
#include "engine/edit/request.h"
#include "engine/pipeline/edit_job.h"
#include "engine/scene/label_ops.h"

namespace gse::app {

void Application::refresh_reading() {
    const auto words = edit::words_of(model_.request.prompt);
    const auto read = words.empty() ? 0
                                    : words_read(model_path_.empty() ? starter_model_path() : std::filesystem::path(model_path_), words);
    model_.words_read = read < words.size() ? read : 0;
}

/// What the applied edits say of the scene, and what the label says of the edit.
void Application::refresh_words() {
    if (document_.empty()) return;
    std::vector<edit::EditRequest> applied;
    for (const auto& node : document_.state().stack) {
        const auto json = try_parse_json<nlohmann::ordered_json>(node.recipe);
        if (!node.enabled || !json.is_object() || !json.contains("request")) continue;
        edit::EditRequest request;
        try {
            fields_from_json(request, json["request"]);
        } catch (const Error&) {   // of another version: what it said is not known
            continue;
        }
        applied.push_back(std::move(request));
    }
    model_.said_words = edit::words_said(applied);
    model_.labelled_by_hand = labelled_by_hand();
}

/// True when the active label was painted and not found by words.
bool Application::labelled_by_hand() const {
    const auto& state = document_.state();
    if (state.active_label < 0) return false;
    const auto& label = state.labels[static_cast<std::size_t>(state.active_label)];
    if (count_labelled(label) == 0) return false;
    return !label.weight || std::all_of(label.weight->begin(), label.weight->end(), [](float w) { return w == 0; });
}

void Application::label_anyway() {
    if (!job_ || work_.running() || pending_ || job_->found()) return;
    auto attention = std::make_shared<std::vector<float>>();
    work_.start({"Label what was found",
                 [job = job_, attention](const JobControl& control) {
                     job->set_control(control);
                     job->locate_anyway();
                     *attention = splat_attention(*job);
                 },
                 [this, job = job_, attention](const Error* error) {
                     if (error != nullptr) return error->code() == ErrorCode::Cancelled ? void() : report_error(*error);
                     take_located(job, std::move(*attention));
                     if (job->found()) label_located(*job, {}, {});
                 },
                 true});
}

/// True when what is labelled, and not a new search, says what the edit may change.
bool Application::label_drives_edit() const {
    if (labelled_by_hand()) return true;
    const auto& state = document_.state();
    if (state.active_label < 0) return false;
    const auto& label = state.labels[static_cast<std::size_t>(state.active_label)];
    const auto& request = model_.request;
    return count_labelled(label) > 0 && (label.name == edit::as_told(request.source) || label.name == edit::as_told(request.target));
}

}  // namespace gse::app
