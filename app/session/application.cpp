// The editor behind the window: routes commands, runs the frame, keeps the program's settings.
#include "app/session/application.h"

#include <algorithm>
#include <variant>

#include "app/session/state/json_values.h"
#include "engine/base/desktop.h"
#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/io/files/user_files.h"
#include "engine/pipeline/models/installed.h"
#include "engine/scene/label_ops.h"

namespace gse::app {
namespace {

namespace command = ui::command;

template <class... F> struct Overloaded : F... { using F::operator()...; };

}  // namespace

Application::Application(ApplicationOptions options)
    : workspace_(std::move(options)), view_(workspace_),
      models_(workspace_,
              [this](const auto& before, const auto& after) { search_.move_request(before, after); }),
      servers_(workspace_), costs_(workspace_, models_),
      search_(workspace_, view_, models_, servers_, costs_),
      edits_(workspace_, view_, models_, servers_, costs_, search_),
      labels_(workspace_, view_, models_, search_, edits_), places_(workspace_, view_),
      exports_(workspace_, view_, search_, edits_),
      files_(workspace_, {view_, models_, servers_, search_, edits_, labels_, exports_}) {
    workspace_.run = [this](const ui::Command& command) { run(command); };
    load_settings();
    models_.start();
    show();
}

Application::~Application() {
    workspace_.jobs.reset();  // jobs end before what they use
    workspace_.queue.set_wake({});
}

void Application::run(const ui::Command& command) {
    std::visit(Overloaded{[this](const ui::FileCommand& one) { files_.run(one); },
                          [this](const ui::SearchCommand& one) { search_.run(one); },
                          [this](const ui::EditCommand& one) { edits_.run(one); },
                          [this](const ui::LabelCommand& one) { labels_.run(one); },
                          [this](const ui::PlaceCommand& one) { places_.run(one); },
                          [this](const ui::ViewCommand& one) { view_.run(one); },
                          [this](const ui::ModelCommand& one) { models_.run(one); },
                          [this](const ui::ServerCommand& one) { servers_.run(one); },
                          [this](const ui::ExportCommand& one) { exports_.run(one); },
                          [this](const ui::NoticeCommand& one) { workspace_.notices.run(one); },
                          [this](const ui::WindowCommand& one) { run_window(one); }},
               command);
    if (workspace_.settings_changed) save_settings();
    show();
}

bool Application::busy() const {
    const auto& jobs = *workspace_.jobs;
    return jobs.works() || jobs.files.running() || files_.leaving() || workspace_.notices.shows_toasts() ||
           view_.moving() || files_.counts_later();
}

// Frames

void Application::update(PreviewHost& preview) {
    workspace_.queue.run();
    const auto now = Clock::now();
    const double frame = std::chrono::duration<double>(now - last_frame_).count();
    last_frame_ = now;
    if (frame > 0) frames_per_second_ = 0.9 * frames_per_second_ + 0.1 / std::max(frame, 1e-4);
    workspace_.notices.refresh();
    edits_.refresh();
    servers_.refresh();
    follow_document();
    search_.refresh();
    if (!workspace_.document.empty()) labels_.refresh(), places_.refresh();
    exports_.refresh();
    files_.refresh();
    if (workspace_.document.empty()) {
        view_.draw_nothing();
    } else {
        Stage stage = edits_.stage();
        labels_.dress(stage);
        view_.draw(preview, stage);
    }
    if (workspace_.settings_changed) save_settings();
    show();
}

void Application::follow_document() {
    const auto& document = workspace_.document;
    const Seen now{workspace_.opened, document.revision()};
    const Seen before = std::exchange(seen_, now);
    if (document.empty() || before == now) return;
    if (before.opened != now.opened) servers_.take_document();
    if (before.opened == now.opened && now.revision < before.revision) forget_undone();
    view_.follow_document();
    search_.follow_document();
    const NamedLabel* label = workspace_.active_label();
    workspace_.labelled = label != nullptr ? count_labelled(*label) : 0;
}

/// Drops the words, pictures and figures of an undone step. Evidence of a search comes back with a redo.
void Application::forget_undone() {
    const auto done = [this](std::uint64_t step) { return workspace_.document.includes(step); };
    workspace_.notices.forget_undone(done);
    if (workspace_.jobs->works() || workspace_.results || done(workspace_.worked_at)) return;
    workspace_.forget_work();
    edits_.forget_run();
}

void Application::show() {
    workspace_.notices.show(model_);
    files_.show(model_);
    view_.show(model_);
    models_.show(model_);
    servers_.show(model_);
    costs_.show(model_);
    search_.show(model_);
    edits_.show(model_);
    labels_.show(model_);
    places_.show(model_);
    exports_.show(model_);
    model_.job = workspace_.jobs->work.status();
    model_.file_job = workspace_.jobs->files.status();
    model_.cannot_edit = workspace_.document.empty()   ? "Open a scene first."
                         : workspace_.jobs->works()    ? "A job is running."
                         : workspace_.jobs->reads_work ? "Another scene is being opened."
                         : workspace_.results          ? "Apply or discard the edit first."
                                                       : "";
    model_.frames_per_second = frames_per_second_;
    model_.keymap = keymap_;
    model_.ui_scale = ui_scale_;
}

void Application::shut_down() {
    save_settings();
    files_.shut_down(quit_);
}

// Settings

void Application::save_settings() {
    workspace_.settings_changed = false;
    nlohmann::json json;
    json["ui_scale"] = chosen_scale_;
    json["keys"] = keymap_;
    models_.settings_to_json(json);
    servers_.settings_to_json(json);
    costs_.settings_to_json(json);
    if (!workspace_.layout.empty()) json["layout"] = workspace_.layout;
    json["view"] = lasting(fields_to_json(view_.settings()));
    json["exports"] = lasting(fields_to_json(exports_.settings()));
    gse::save_settings(json);
}

void Application::load_settings() {
    const auto json = gse::load_settings();
    const auto& options = workspace_.options;
    const bool scaled = json.contains("ui_scale") && json["ui_scale"].is_number();
    chosen_scale_ = scaled ? std::clamp(json["ui_scale"].get<float>(), 0.0f, 4.0f) : 0.0f;
    ui_scale_ = options.ui_scale > 0 ? options.ui_scale
                : chosen_scale_ > 0  ? chosen_scale_
                                     : options.desktop_scale;
    keymap_ = text_of(json, "keys");
    models_.settings_from_json(json);
    servers_.settings_from_json(json);
    costs_.settings_from_json(json);
    try {
        auto view = view_.settings();
        auto exports = exports_.settings();
        if (json.contains("view")) fields_from_json(view, lasting(json["view"]));
        view_.set_settings(view);
        if (json.contains("exports")) fields_from_json(exports, lasting(json["exports"]));
        exports_.set_settings(exports);
    } catch (const std::exception& error) {  // of another version, or edited by hand
        log::warning("some settings of view and export cannot be used ({})", error.what());
    }
    workspace_.layout = text_of(json, "layout");
    workspace_.layout_loaded = !workspace_.layout.empty();
}

// Commands of the window itself

template <> void Application::on(const command::OpenGuide&) {
    try {
        open_document(pipeline::guide_path());
    } catch (const Error& error) { workspace_.notices.report(error); }
}

template <> void Application::on(const command::ToggleFullscreen&) {
    if (workspace_.options.on_fullscreen) workspace_.options.on_fullscreen();
}

template <> void Application::on(const command::SetUiScale& one) {
    ui_scale_ = chosen_scale_ = one.scale;
    if (workspace_.options.on_scale) workspace_.options.on_scale(one.scale);
    workspace_.settings_changed = true;
}

template <> void Application::on(const command::SetKeymap& one) {
    keymap_ = one.text;
    workspace_.settings_changed = true;
}

template <> void Application::on(const command::Quit&) { quit_ = true; }

void Application::run_window(const ui::WindowCommand& command) {
    std::visit([this](const auto& one) { on(one); }, command);
}

}  // namespace gse::app
