// Names, proof and thumbnail of a result.
#include "app/session/state/pending_result.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "app/session/state/located_label.h"
#include "engine/base/error.h"
#include "engine/base/json.h"
#include "engine/base/log.h"
#include "engine/edit/request/edit_method.h"
#include "engine/pipeline/report/edit_output.h"
#include "engine/pipeline/run/loop.h"
#include "engine/scene/row_values.h"
#include "engine/scene/stack_edits.h"

namespace gse::app {

Renamed renamed_by(const EditJob& job) {
    if (job.located().mode != edit::EditMode::Replace) return {};
    const auto& sentence = job.recipe().request.sentence();
    return {sentence.source(), new_thing(sentence, edit::EditMode::Replace)};
}

namespace {

void require_steps(const EditJob& job) {
    if (job.result().iterations == 0)
        throw Error(ErrorCode::Cancelled, "the edit was stopped before its first step");
}

/// New rows of a result that fill a hole: [new rows] 0 or 1.
std::vector<std::uint8_t> new_rows_apart(const edit::EditResult& result) {
    std::vector<std::uint8_t> old(result.set.size(), 0), apart;
    for (const auto row : result.base_to_new)
        if (row >= 0) old[static_cast<std::size_t>(row)] = 1;
    for (std::size_t row = 0; row < old.size() && row < result.hole_fill.size(); ++row)
        if (old[row] == 0) apart.push_back(result.hole_fill[row]);
    return apart;
}

}  // namespace

void fill_pending(EditJob& job, PendingResult& pending) {
    require_steps(job);  // before the work of a report
    fill_pending(job, make_report(job), pending);
}

void fill_pending(EditJob& job, const nlohmann::ordered_json& report, PendingResult& pending) {
    const auto& result = job.result();
    require_steps(job);
    pending.before = job.scene().gaussians;
    pending.set = result.set;
    pending.base_to_new = std::make_shared<const std::vector<std::int64_t>>(result.base_to_new);
    pending.apart = new_rows_apart(result);
    const auto& request = job.recipe().request;
    pending.name = request.prompt();
    pending.target = request.target();
    pending.seed = request.seed;
    pending.adds = job.located().mode == edit::EditMode::Add;
    pending.renamed = renamed_by(job);
    pending.recipe = json_text(recipe_to_json(job.recipe().plain()), -1);
    for (const auto& [stage, seconds] : result.seconds) pending.seconds += seconds;
    pending.psnr_outside_db = report["psnr_outside_db"].get<double>();
    pending.changed_outside_label = result.changed_outside_label;
    pending.steps = edit::loop_steps(job.recipe().request, job.located().mode);
    if (result.stopped) pending.stopped_at = result.iterations;
    constexpr int ThumbnailPx = 288;  // large enough to judge
    constexpr double Nearer = 0.8;    // of the film's distance: what was changed fills the picture
    OrbitParameters orbit = job.film_orbit();
    orbit.radius *= Nearer;
    const Camera camera = orbit_camera(orbit, job.film_front() + 0.35, ThumbnailPx, ThumbnailPx);
    pending.thumbnail = std::make_shared<const Image>(
        job.painter().paint(job.drawn_result().spans(), camera, job.plan().settings).colour);
}

EditNode node_of(const PendingResult& result) {
    EditNode node;
    node.name = result.name;
    node.recipe = result.recipe;
    node.seconds = result.seconds;
    node.psnr_outside_db = result.psnr_outside_db;
    node.changed_outside_label = result.changed_outside_label;
    node.thumbnail = result.thumbnail;
    return node;
}

DocumentState with_result(const DocumentState& before, EditNode node, const PendingResult& result) {
    DocumentState state = with_edit(before, std::move(node), result.target, result.adds, result.apart);
    const auto called = [](const std::string& name) {
        return [&name](const NamedLabel& label) { return label.name == name; };
    };
    if (result.renamed.to.empty() ||
        std::any_of(state.labels.begin(), state.labels.end(), called(result.renamed.to)))
        return state;
    const auto label = std::find_if(state.labels.begin(), state.labels.end(), called(result.renamed.from));
    if (label != state.labels.end()) label->name = result.renamed.to;
    return state;
}

DocumentState applied(const DocumentState& before, const PendingResult& result, std::uint64_t id) {
    DocumentState state = result.label ? with_found_label(before, *result.label) : before;
    EditNode node = node_of(result);
    node.id = id;
    node.delta = std::make_shared<const SceneDelta>(
        make_delta(result.before, *state.row_ids, result.set, *result.base_to_new, id));
    return with_result(state, std::move(node), result);
}

PendingResult together(std::vector<PendingResult> changes, std::string name) {
    PendingResult whole = changes.back();
    std::vector<std::int64_t> rows = *changes.front().base_to_new;
    for (std::size_t i = 1; i < changes.size(); ++i) rows = chained(std::move(rows), *changes[i].base_to_new);
    whole.before = changes.front().before;
    whole.base_to_new = std::make_shared<const std::vector<std::int64_t>>(std::move(rows));
    whole.name = std::move(name);
    whole.label.reset();
    whole.renamed = {};
    whole.seconds = 0, whole.changed_outside_label = 0;
    whole.verdict.clear(), whole.warns = false;
    for (const auto& change : changes) {
        whole.seconds += change.seconds;
        whole.changed_outside_label += change.changed_outside_label;
        whole.psnr_outside_db = std::min(whole.psnr_outside_db, change.psnr_outside_db);
        if (change.warns && !whole.warns)
            whole.verdict = fmt::format("\"{}\": {}", change.name, change.verdict), whole.warns = true;
    }
    whole.changes = std::move(changes);
    return whole;
}

std::optional<PendingResult> take_back_edit(DocumentState& state, const nlohmann::json& jobs) {
    try {
        const auto edit = jobs.find("edit");
        if (edit == jobs.end() || state.stack.empty() ||
            edit->value("id", std::uint64_t{0}) != state.stack.back().id)
            return std::nullopt;
        const EditNode node = state.stack.back();
        auto stack = state.stack;
        stack.pop_back();
        DocumentState before = with_stack(state, std::move(stack));
        PendingResult pending;
        pending.set = state.current;
        pending.base_to_new =
            std::make_shared<const std::vector<std::int64_t>>(row_map(*before.row_ids, *state.row_ids));
        pending.name = node.name;
        pending.recipe = node.recipe;
        pending.target = edit->value("target", "");
        pending.seed = edit->value("seed", std::uint64_t{0});
        pending.adds = edit->value("adds", false);
        pending.verdict = edit->value("verdict", "");
        pending.warns = edit->value("warns", false);
        pending.stopped_at = edit->value("stopped_at", -1);
        pending.steps = edit->value("steps", 0);
        pending.renamed = {edit->value("source", ""), edit->value("becomes", "")};
        pending.seconds = node.seconds;
        pending.psnr_outside_db = node.psnr_outside_db;
        pending.changed_outside_label = node.changed_outside_label;
        pending.thumbnail = node.thumbnail;
        state = std::move(before);
        return pending;
    } catch (const nlohmann::json::exception& error) {
        log::warning("the edit stays on the stack, its description is damaged ({})", error.what());
        return std::nullopt;
    }
}

}  // namespace gse::app
