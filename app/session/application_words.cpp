// Words: which of the sentence the model reads, what applied edits have said already, and what a label says
// of the edit.
#include <fmt/format.h>

#include <algorithm>

#include "app/cli/engine_names.h"
#include "app/session/application.h"
#include "engine/base/error.h"
#include "engine/base/json.h"
#include "engine/edit/request/request.h"
#include "engine/pipeline/run/edit_job.h"
#include "engine/scene/label_ops.h"

namespace gse::app {

void Application::refresh_reading() {
    const auto words = edit::words_of(model_.request.prompt);
    const auto read = words.empty() ? 0
                                    : words_read(model_path_.empty() ? starter_model_path()
                                                                     : std::filesystem::path(model_path_),
                                                 words);
    model_.words_read = read < words.size() ? read : 0;
}

/// What the applied edits say of the scene, and what the label says of the edit.
void Application::refresh_words() {
    if (!document_.empty()) model_.said_words = edit::words_said(applied_requests(document_.state().stack));
}

/// Null where there is none.
const NamedLabel* Application::active_label() const {
    if (document_.empty()) return nullptr;
    const auto& state = document_.state();
    if (state.active_label < 0 || state.active_label >= static_cast<int>(state.labels.size())) return nullptr;
    return &state.labels[static_cast<std::size_t>(state.active_label)];
}

/// What the next edit would change, made anew only when words, label or choice are others.
void Application::refresh_reach() {
    const auto& request = model_.request;
    const auto choice = reach_choice_ ? fmt::format("{} {} {}", reach_choice_->by_label, reach_choice_->label,
                                                    reach_choice_->source)
                                      : "";
    auto key = fmt::format("{}\n{}\n{}\n{}\n{}\n{}", document_.revision(), model_.search.number,
                           request.source, request.target, model_path_, choice);
    if (key == reach_key_) return;
    reach_key_ = std::move(key);
    const auto& labels = document_.state().labels;
    const auto& words = searched_.words;
    model_.attention_corrected =
        !model_.attention.empty() && std::any_of(labels.begin(), labels.end(), [&](const NamedLabel& label) {
            return (label.found_for == model_.attention_word ||
                    label.found_for == edit::as_told(words.source)) &&
                   !label.found_for.empty() && corrected_by_hand(label);
        });
    model_.reach = {};
    model_.labelled_by_hand = false;
    const NamedLabel* label = active_label();
    if (label == nullptr || count_labelled(*label) == 0) return;
    model_.reach = {label->name, count_labelled(*label), label_drives_edit(),
                    !label->found_for.empty() && corrected_by_hand(*label)};
    model_.labelled_by_hand = model_.reach.by_label && stands_alone(*label, request, model_.known_words);
}

void Application::set_reach(bool by_label) {
    if (const NamedLabel* label = active_label())
        reach_choice_ = ReachChoice{by_label, label->name, edit::as_told(model_.request.source)};
}

/// Who makes, corrects or picks a label by hand means it to be edited.
void Application::choose_label_by_hand() {
    if (const NamedLabel* label = active_label();
        label != nullptr && (made_by_hand(*label) || count_labelled(*label) == 0))
        set_reach(true);
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
                     if (error != nullptr)
                         return error->code() == ErrorCode::Cancelled ? void() : report_error(*error);
                     take_located(job, std::move(*attention));
                     if (job->found()) label_located(*job, {}, {});
                 },
                 true});
}

/// True when what is labelled, and not a new search, says what the edit may change.
bool Application::label_drives_edit() const {
    const NamedLabel* label = active_label();
    return label != nullptr && label_says(*label, model_.request, model_.known_words, reach_choice_);
}

}  // namespace gse::app
