// gseditpro open: the window, its frame loop, and what ties its parts together.
#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <memory>

#include "app/cli/cli.h"
#include "app/engine_names.h"
#include "app/session/application.h"
#include "app/window/viewport.h"
#include "app/window/window_textures.h"
#include "engine/base/clock.h"
#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/log.h"
#include "engine/base/process.h"
#include "engine/base/process_memory.h"
#include "engine/io/image/image_file.h"
#include "engine/io/scene/reading_options.h"
#include "engine/pipeline/inventory/no_scene.h"
#include "engine/vulkan/device.h"
#include "engine/vulkan/error.h"
#include "engine/window/window.h"
#include "ui/frame/shell.h"
#include "ui/model/foreign_fonts.h"
#include "ui/model/theme.h"

namespace gse::app {
namespace {

struct OpenOptions {
    std::filesystem::path path;
    std::string preview = "auto", device;
    int width = 0, height = 0;  // 0 = as large as fits the screen
    float scale = 0;
    ReadingOptions reading;
    bool sample = false, validate = false;
};

// Nothing happens: what is due by the clock is looked after, nothing is drawn.
constexpr double IdleWait = 0.5;
constexpr double WorkingWait = 0.1;  // a job runs: its numbers move, the processor belongs to it
// The camera moves: the panels are drawn anew with every picture, or after this time.
constexpr double MovingFrame = 0.05;
constexpr double WorkingFrame = 0.04;   // the same while a job runs that needs the processor too,
constexpr double SoftwareFrame = 0.08;  // and where the processor draws the window as well
constexpr double ActiveSeconds = 0.6;   // after input every frame is drawn

nlohmann::ordered_json job_state(const JobStatus& job) {
    return {{"running", job.running}, {"paused", job.paused},   {"title", job.title}, {"stage", job.stage},
            {"step", job.step},       {"outcome", job.outcome}, {"error", job.error}};
}

nlohmann::ordered_json server_state(const ui::ServerView& server) {
    auto here = nlohmann::ordered_json::array();
    for (const auto& one : server.here) here.push_back({{"url", one.url}, {"usable", one.usable}});
    return {{"on", server.on},
            {"facts", server.facts.size()},
            {"problem", server.problem},
            {"lora", server.choice.lora},
            {"url", server.choice.url},
            {"looked", server.looked},
            {"here", here}};
}

nlohmann::ordered_json targets_state(const ui::ViewModel& model) {
    nlohmann::ordered_json state = {{"rounds", model.target_rounds.size()},
                                    {"waits", model.targets_wait},
                                    {"review", model.model_settings.review}};
    if (model.target_rounds.empty()) return state;
    for (const auto& target : model.target_rounds.back().targets)
        state["views"].push_back(
            {{"view", target.view}, {"redrawn", target.attempt}, {"dropped", target.dropped}});
    return state;
}

/// The active label, the one that the next edit changes (empty = a search finds it), and for each edit with
/// variations its identity and the index of the applied one.
nlohmann::ordered_json labels_state(const ui::ViewModel& model) {
    const bool open = model.document != nullptr && !model.document->empty();
    const int active = open ? model.document->state().active_label : -1;
    nlohmann::ordered_json state = {
        {"active", active < 0 ? "" : model.document->state().labels[static_cast<std::size_t>(active)].name},
        {"changes", model.scope.by_label ? model.scope.label : ""},
        {"variations", nlohmann::ordered_json::array()}};
    for (const auto& one : model.variations)
        state["variations"].push_back(
            {{"edit", one.edit}, {"applied", one.applied}, {"results", one.results.size()}});
    return state;
}

/// The window and everything in it.
class Editor {
public:
    explicit Editor(const OpenOptions& options)
        : window_(window_options(options)), viewport_(window_, parse_backend(options.preview)),
          textures_(window_),
          app_({.wake = [] { Window::wake(); },
                .on_scale = [this](float scale) { window_.set_ui_scale(scale); },
                .ui_scale = options.scale,
                .desktop_scale = window_.ui_scale(),
                .on_fullscreen = [this] { window_.set_fullscreen(!window_.fullscreen()); }}) {
        if (const char* map = std::getenv("GSE_UI_MAP")) widget_map_ = map;
        if (app_.model().ui_scale != window_.ui_scale()) window_.set_ui_scale(app_.model().ui_scale);
        if (options.sample) app_.run(ui::command::OpenSample{});
        else if (!options.path.empty()) app_.run(ui::command::Open{options.path, options.reading.activated});
    }

    /// Runs until the artist leaves.
    void run() {
        while (!app_.wants_to_quit()) {
            const bool woken = wait();
            if (window_.should_close() || interrupt_token().stop_requested()) {
                window_.set_should_close(false);
                if (interrupt_token().stop_requested()) break;
                shell_.request_quit();
            }
            try {
                frame(woken);
            } catch (const vulkan::DeviceLost& lost) {
                log::warning("the graphics device was lost and is set up again ({})", lost.what());
                window_.rebuild_device();
                ++devices_lost_;
            }
        }
        app_.set_layout(shell_.layout());
        app_.shut_down();
        if (window_.validation_messages() > 0)
            log::warning("the validation layers reported {} messages", window_.validation_messages());
    }

    std::size_t validation_messages() const { return window_.validation_messages(); }

private:
    WindowOptions window_options(const OpenOptions& options) {
        WindowOptions window;
        window.width = options.width;
        window.height = options.height;
        window.device = options.device;
        window.validation = options.validate;
        window.dress = [this](ImFontAtlas& atlas, ImGuiStyle& style, float scale) {
            ui::dress(atlas, style, scale, shell_.glyphs(), [this](char32_t character, float size_px) {
                return foreign_fonts_.paint(character, size_px);
            });
            glyphs_dressed_ = shell_.glyphs().all().size();
        };
        window.take_character = [this](unsigned character) -> unsigned {
            return shell_.glyphs().shown(static_cast<char32_t>(character));
        };
        window.take_text = [this](const std::string& text) { return shell_.glyphs().shown(text); };
        window.give_text = [this](const std::string& text) { return shell_.glyphs().meant(text); };
        window.on_drop = [this](const std::vector<std::filesystem::path>& paths) {
            shell_.request_open(paths);
        };
        return window;
    }

    /// False: nothing has come in and nothing moves.
    bool wait() {
        const double frame = viewport_.waits_for_picture() ? MovingFrame : app_.busy() ? working_frame() : 0;
        bool came_in = false;
        for (double rest; (rest = frame_began_ + frame - wall_seconds()) > 0;) came_in |= window_.wait(rest);
        const bool active = came_in || moving() || wall_seconds() - last_input_ < ActiveSeconds;
        came_in |= active ? window_.poll() : window_.wait(app_.busy() ? WorkingWait : IdleWait);
        if (came_in) last_input_ = wall_seconds();
        return active || came_in || app_.busy();
    }

    bool moving() { return viewport_.busy() || textures_.uploads_waiting() || shell_.animating(); }

    double working_frame() { return window_.device().info().is_cpu ? SoftwareFrame : WorkingFrame; }

    void frame(bool woken) {
        frame_began_ = wall_seconds();
        if (app_.layout_changed()) shell_.set_layout(app_.layout());
        app_.update(viewport_);
        lose_device_if_asked();
        const bool captures = capture_wanted();
        at_rest_ = !woken && !moving() && !captures && !shell_.takes_text();  // a caret blinks
        if (at_rest_) return write_map();  // the window shows what it would show
        if (!window_.begin_frame()) return;
        viewport_.record();
        for (const auto& command : shell_.draw(app_.model(), textures_)) app_.run(command);
        if (shell_.glyphs().all().size() != glyphs_dressed_) window_.renew_fonts();
        if (captures) window_.request_capture();
        window_.end_frame();
        viewport_.set_window_ms((wall_seconds() - frame_began_) * 1000);
        set_title();
        if (captures) write_capture();
        write_map();
        if (frames_++ == 0) log::debug("first frame {:.0f} ms after the start", process_seconds() * 1000);
        if (frames_ == 1 && std::getenv("GSE_UI_FIRST_FRAME") != nullptr)
            write_file(std::getenv("GSE_UI_FIRST_FRAME"), fmt::format("{:.4f}\n", process_seconds()));
    }

    void set_title() {
        const auto& model = app_.model();
        const auto path = !model.project_path.empty() ? model.project_path : model.scene_path;
        std::string title = "GSEditPro";
        if (!path.empty())
            title =
                std::filesystem::path(path).filename().string() + (model.unsaved ? "* - " : " - ") + title;
        if (title == title_) return;
        title_ = title;
        window_.set_title(title);
    }

    /// For scripts that drive the window: places of the widgets as JSON, a picture of the window on request,
    /// and a device that gets lost.
    void lose_device_if_asked() {
        const std::filesystem::path request = widget_map_.string() + ".lose_device";
        if (widget_map_.empty() || !std::filesystem::exists(request)) return;
        std::filesystem::remove(request);
        window_.device().pretend_lost();
    }
    void write_map() {
        if (widget_map_.empty() || wall_seconds() - map_written_ < 0.1) return;
        map_written_ = wall_seconds();
        rests_ += at_rest_;
        shell_.write_widgets(widget_map_);
        write_file(widget_map_.string() + ".state", state_json().dump(1));
    }
    nlohmann::ordered_json state_json() {
        const auto& model = app_.model();
        nlohmann::ordered_json state;
        state["scene"] = model.scene_path;
        state["project"] = model.project_path;
        state["unsaved"] = model.unsaved;
        state["saved_at"] = model.saved_at;
        state["embeds"] = model.embeds;
        state["lost_scene"] = model.lost.scene;
        state["export_scene"] = model.exports.scene_path;
        state["question"] = model.question.title;
        state["server"] = server_state(model.server);
        state["labelled"] = model.labelled;
        state["labels"] = labels_state(model);
        state["splats"] = app_.document().empty() ? 0 : app_.document().state().current.size();
        state["stack"] = app_.document().empty() ? 0 : app_.document().state().stack.size();
        state["undo_position"] = app_.document().empty() ? 0 : app_.document().position();
        state["views_attended"] = model.attention.size();
        state["left_out"] = model.request.excluded_views;
        state["hidden"] = model.hidden;
        state["picked"] = model.picked.count;
        state["compared"] = model.compared_name;
        state["source"] = model.request.source;
        state["sentence"] = model.request.prompt;
        state["target"] = app_.target();
        state["method"] = model.request.method;
        state["search"] = {{"number", model.search.number},
                           {"confidence", model.search.confidence.value},
                           {"message", model.search.message},
                           {"remedy", model.search.remedy}};
        if (model.search.front) state["search"]["front"] = *model.search.front;
        state["job"] = job_state(model.job);
        state["file_job"] = job_state(model.file_job);
        state["estimate"] = {{"seconds", model.estimate.seconds},
                             {"tflop", model.estimate.tflop},
                             {"memory_mb", model.estimate.memory_mb}};
        state["losses"] = model.losses.size();
        state["snapshots"] = model.snapshots.size();
        state["result_waiting"] = model.result_waiting;
        state["targets"] = targets_state(model);
        state["cost"] = {{"unet", model.cost.unet}, {"tflop", model.cost.tflop}};
        state["comparison"] = static_cast<int>(model.comparison);
        state["mode"] = model.view.mode;
        state["frames"] = frames_;
        state["rests"] = rests_;
        state["focus"] = shell_.focused();
        state["busy"] = viewport_.busy();
        state["devices_lost"] = devices_lost_;
        state["framebuffer"] = {window_.framebuffer_width(), window_.framebuffer_height()};
        state["recoverable"] = model.recoverable.size();
        state["offers"] = nlohmann::ordered_json::array();
        for (const auto& found : model.recoverable) state["offers"].push_back(found.name);
        state["validation_messages"] = window_.validation_messages();
        state["toasts"] = nlohmann::ordered_json::array();
        for (const auto& toast : model.toasts) state["toasts"].push_back(toast.text);
        return state;
    }
    bool capture_wanted() const {
        return !widget_map_.empty() && std::filesystem::exists(widget_map_.string() + ".capture");
    }
    void write_capture() {
        const auto picture = window_.take_capture();
        if (!picture) return;
        const std::filesystem::path request = widget_map_.string() + ".capture";
        std::string target = read_file(request);
        while (!target.empty() && (target.back() == '\n' || target.back() == ' ')) target.pop_back();
        if (!target.empty()) write_png(target, *picture);
        std::filesystem::remove(request);
    }

    ui::Shell shell_;  // before the window: dropped files reach it
    ui::ForeignFonts foreign_fonts_;
    std::size_t glyphs_dressed_ = 0;
    Window window_;
    Viewport viewport_;
    WindowTextures textures_;
    Application app_;
    std::filesystem::path widget_map_;
    std::string title_;
    double last_input_ = wall_seconds(), map_written_ = 0, frame_began_ = 0;
    bool at_rest_ = false;
    std::size_t frames_ = 0, rests_ = 0, devices_lost_ = 0;  // rests: times that nothing had to be drawn
};

void run_open(const OpenOptions& options) {
    pipeline::refuse_weights(options.path);
    if (std::getenv("DISPLAY") == nullptr && std::getenv("WAYLAND_DISPLAY") == nullptr)
        throw Error(ErrorCode::Unsupported, "there is no display to open a window on",
                    "work without one: gseditpro edit --demo --headless");
    Editor editor(options);
    editor.run();
    if (options.validate && editor.validation_messages() > 0)
        throw Error(ErrorCode::Foreign,
                    fmt::format("the validation layers reported {} messages", editor.validation_messages()),
                    "see the log");
}

}  // namespace

void add_window_command(CLI::App& app, CommandContext&) {
    auto options = std::make_shared<OpenOptions>();
    auto* command =
        app.add_subcommand("open", "Open the editor's window (what happens without a command, too)");
    command->add_option("file", options->path, "Scene, folder, project or a picture with a recipe in it");
    bind_fields(*command, options->reading, "Reading");
    command->add_flag("--sample", options->sample, "Open the bundled scene");
    command->add_option("--preview", options->preview, "Who paints the viewport: auto, vulkan or native")
        ->capture_default_str();
    command->add_option("--device", options->device, "Graphics device: number or part of its name");
    command
        ->add_option("--width", options->width,
                     "Width of the window; what fits the screen unless it is given")
        ->check(CLI::Range(320, 16384));
    command->add_option("--height", options->height, "Height of the window")->check(CLI::Range(240, 16384));
    command
        ->add_option("--scale", options->scale,
                     "Size of text and controls for this start; 0 = as chosen in the window")
        ->check(CLI::Range(0.0, 4.0));
    command->add_flag("--validate", options->validate,
                      "Vulkan validation layers; any message is an error at the end");
    command->callback([options] { run_open(*options); });
}

void run_default_window() { run_open({}); }

}  // namespace gse::app
