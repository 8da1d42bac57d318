// Values that the panels show: plain data that the application refreshes before every frame. No Vulkan, no
// torch, no threads.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/base/fields.h"
#include "engine/base/image.h"
#include "engine/base/job_status.h"
#include "engine/base/log.h"
#include "engine/edit/interfaces/view_targets.h"
#include "engine/edit/request/request.h"
#include "engine/edit/search/locate.h"
#include "engine/io/formats/scene_formats.h"
#include "engine/math/framing.h"
#include "engine/pipeline/models/model_catalogue.h"
#include "engine/pipeline/report/evidence_pictures.h"
#include "engine/remote/api/server_lora.h"
#include "engine/remote/api/server_settings.h"
#include "engine/scene/camera_key.h"
#include "engine/scene/document.h"
#include "ui/model/model_settings.h"

namespace gse::ui {

/// Handle of a picture on the screen device; 0 = none.
using TextureId = std::uint64_t;

/// Pictures for widgets: uploaded once per Image object, dropped when the object dies.
class Textures {
public:
    virtual ~Textures() = default;
    virtual TextureId texture(const std::shared_ptr<const Image>& image) = 0;
};

/// Display of the splats in the viewport; the order is that of the menu.
enum class DisplayMode {
    Beauty,
    Centres,
    Rings,
    Ellipsoids,
    Depth,
    Opacity,
    Labels,
    LabelWeight,
    Attention,
    Changed
};
constexpr std::array<const char*, 10> DisplayModeNames{"Beauty",    "Centres", "Rings",  "Ellipsoids",
                                                       "Depth",     "Opacity", "Labels", "Label weight",
                                                       "Attention", "Changed"};

enum class Tool { Orbit, Brush, Rectangle, Lasso, CutOut, PickColour, Place, Heal };
enum class SetOperation { Add, Remove, Intersect, Replace };
enum class Comparison { None, Wipe, Original };

/// Settings of the window that an artist makes; saved in the project. One list of fields.
struct ViewSettings {
    int mode = 0;  // DisplayMode
    int sh_degree = 3;
    bool tint_labels = true;  // labels over the beauty picture
    float tint_strength = 0.6f;
    bool show_axes = true;
    bool show_bounds = false;
    bool show_views = false;  // camera frusta
    bool show_hud = true;
    bool front_only = true;  // selection touches what is seen, not what is behind
    float brush_px = 24;
    std::string background = "#1d1f24";
    float wipe = 0.5f;
    double fov_degrees = 50;
    double move_speed = 1;

    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        f("mode", self.mode, "How splats are shown.", Range{0, 9});
        f("sh_degree", self.sh_degree, "Highest spherical-harmonics degree shown.", Range{0, 3});
        f("tint_labels", self.tint_labels, "Tint the labelled splats over the picture.");
        f("tint_strength", self.tint_strength, "How strong the tint is.", Range{0, 1});
        f("show_axes", self.show_axes, "World axes.");
        f("show_bounds", self.show_bounds, "Box around the scene.");
        f("show_views", self.show_views, "Cameras of the views.");
        f("show_hud", self.show_hud, "Frame rate and counts over the picture.");
        f("front_only", self.front_only, "Selecting touches the front only, not what is behind.");
        f("brush_px", self.brush_px, "Radius of the brush in pixels.", Range{1, 500});
        f("background", self.background, "Colour behind the scene.");
        f("wipe", self.wipe, "Place of the wipe between before and after.", Range{0, 1});
        f("fov_degrees", self.fov_degrees, "Horizontal field of view.", Range{5, 150});
        f("move_speed", self.move_speed, "Speed of flying.", Range{0.01, 100});
    }
};

/// A point of the curves in Progress.
struct LossPoint {
    int iteration = 0;
    float preservation = 0, anchor = 0, guidance_loss = 0, guidance_norm = 0, preservation_norm = 0;
};

/// A state of the running (or last) edit that can be looked at again.
struct SnapshotView {
    int iteration = 0;
    std::size_t splats = 0;
};

/// Result of Locate, per view.
using AttentionView = pipeline::SeenView;

/// Outcome of the last search.
struct SearchView {
    std::uint64_t number = 0;  // another one for each search; 0 = there was none
    edit::Confidence confidence;
    edit::SearchProblem problem = edit::SearchProblem::None;
    std::string message, remedy;  // of the problem
    std::optional<double> front;  // azimuth in degrees, [0, 360), where the pictures said it
    bool on_ground = false;       // the model was shown a ground that the scene does not have
};

/// A model that was found on this machine.
struct ModelView : pipeline::FoundModel {
    bool chosen = false;
    bool checking = false;  // it is being loaded, to see whether it can be used
};

/// A LoRA that is merged into the model in use.
struct LoraView {
    std::string path;
    std::string name;
    double strength = 1;
};

/// Prompt of a segmenter: clicks on the attention (SAM), or a noun (CLIPSeg).
enum class SegmenterRole : std::uint8_t { Clicks, Words };

/// Segmenter that cuts masks out of pictures.
struct SegmenterView {
    std::string
        path;  // of its weights; empty = none: GrabCut follows clicks, and nouns are left to the attention
    bool checking = false;  // others are being loaded, to see whether they can be used
};

struct LogLine {
    log::Level level = log::Level::Info;
    std::string time;  // "14:02:07"
    std::string text;
};

/// Cost of an edit, before it starts.
struct Estimate {
    double seconds = -1;  // negative = not known yet
    double tflop = -1;    // 10^12 operations of the networks
    double memory_mb = -1;
    double memory_free_mb = -1;
    std::array<double, edit::Qualities.size()> quality_seconds{-1, -1, -1};  // of each quality
    std::vector<double> step_seconds = {};  // of each step of a sentence with several changes; else empty
    int server_pictures = 0;                // least number that the image server draws; 0 = it draws none
    double server_seconds = -1;  // that they take; negative = none was drawn yet. Not in the other figures
};

/// A short message over the viewport, with an optional button.
struct Toast {
    std::string text;
    bool is_error = false;
    double age_seconds = 0;
    std::string button;  // empty = none
};

/// Question of the application. The choice comes back as command::Answer.
struct AskedQuestion {
    struct Answer {
        std::string text, detail = {};
        bool dangerous = false;
        bool listed = false;  // one of many, in a list above the buttons
    };
    std::uint64_t number = 0;  // another one for every question; 0 = none
    std::string title, text;
    std::vector<Answer> answers;
};

/// Work of a session that ended without saving it.
struct RecoveryView {
    std::string file;                        // for recover() and discard_recovery()
    std::string name;                        // of the project or scene: "scene.ply"
    std::string place;                       // its whole path
    std::string facts;                       // "today 14:02, 4,914 splats, 2 edits"
    std::string running;                     // what ran or waited then; empty = nothing
    std::shared_ptr<const Image> thumbnail;  // may be null
    bool offered = false;                    // also over an open scene
};

/// Settings of a picture or film to be written (Export panel and dialogs).
struct ExportSettings {
    int width = 1920, height = 1080;
    bool as_shown = true;  // the screenshot: size, crop, tint and comparison of the viewport
    bool transparent = false;
    std::string picture_path = "screenshot.png";
    std::string film_path = "turntable.mp4";  // .mp4, .webm, or a folder for PNGs
    int frames = 120;
    double fps = 30;
    double degrees = 360;
    double start_degrees = 0;
    bool ease = false;
    double radius_factor = 1;  // of the fitted distance
    double elevation_degrees = 12;
    bool around_label = false;  // centre: what is labelled, else the scene
    bool before_after = false;
    std::string scene_path = "edited.ply";  // format by extension
    bool with_labels = false;
    bool visible_only = false;
    FormatChoices format_choices = standard_choices();  // option of a scene format -> value
    std::string viewpoints_path = "cameras.json";       // format by name: transforms... is nerfstudio's
    std::string camera_path_path = "camera_path.json";

    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        f("width", self.width, "Width in pixels.", Range{16, 16384});
        f("height", self.height, "Height in pixels.", Range{16, 16384});
        f("as_shown", self.as_shown,
          "The screenshot has the size, the crop, the tint and the comparison of the viewport.");
        f("transparent", self.transparent, "Transparent background (PNG).");
        f("picture_path", self.picture_path, "File of the screenshot.");
        f("film_path", self.film_path, "File of the turntable: .mp4, .webm, or a folder for PNG frames.");
        f("frames", self.frames, "Frames of the turntable.", Range{1, 100000});
        f("fps", self.fps, "Frames per second.", Range{1, 240});
        f("degrees", self.degrees, "How far it turns.", Range{-36000, 36000});
        f("start_degrees", self.start_degrees,
          "Direction of the start, degrees from where you look at the scene.", Range{-3600, 3600});
        f("ease", self.ease, "Start and stop gently.");
        f("radius_factor", self.radius_factor, "Distance, relative to the fitted one.", Range{0.05, 20});
        f("elevation_degrees", self.elevation_degrees, "Height above the horizon.", Range{-89, 89});
        f("around_label", self.around_label, "Turn around what is labelled, and frame it.");
        f("before_after", self.before_after, "Before and after side by side.");
        f("scene_path", self.scene_path, "File of the scene; its ending says the format.");
        f("with_labels", self.with_labels,
          "Write the label as a float column, where the format has room for it.");
        f("visible_only", self.visible_only, "Leave out what is hidden in the window.");
        for (const io::FormatOption* option : format_options())
            f(option->name.c_str(), self.format_choices.find(option->name)->second, option->help.c_str(),
              Range{static_cast<double>(option->values.front().value),
                    static_cast<double>(option->values.back().value)});
        f("viewpoints_path", self.viewpoints_path,
          "File of the viewpoints: cameras.json or transforms.json.");
        f("camera_path_path", self.camera_path_path, "File of the camera path.");
    }
};

/// The model's drawing of a few views before the loop.
struct GateView {
    std::vector<std::shared_ptr<const Image>> pictures;  // [S,S,3]
    std::string verdict;                                 // empty = nobody can judge them
    bool warns = false;                                  // they do not show the edit
};

/// A view as the model has redrawn it.
struct TargetView {
    std::size_t view = 0;  // of the edit's views
    std::string name;
    std::shared_ptr<const Image> before, after;  // [H,W,3]
    Camera camera;
    int attempt = 0;       // how often it was redrawn anew
    bool dropped = false;  // the fit does not use it
    bool ordered = false;  // something was said about it that is not done yet
    bool missing = false;  // it was never drawn
};

/// The redrawn views of a round.
struct TargetRound {
    int round = 0, rounds = 1;
    std::vector<TargetView> targets;
    std::string sentence = {};  // that the model was told, where it is not the artist's own
    std::vector<std::string> warnings = {};
};

/// Scope of the next edit: a label, or the result of a search.
struct EditScope {
    std::string label;       // that it uses or could use, with splats in it; empty = there is none
    std::size_t splats = 0;  // of it
    bool by_label = false;   // it says what may change; else the words are looked for
    bool corrected = false;  // something of it was set by hand
    std::string shown;       // the active label, where the edit uses another one; else empty
    std::string present;     // thing that the edit would add although the scene has one; else empty
};

/// Colour of a pixel of the picture, as it is seen.
struct SeenColour {
    std::uint64_t number = 0;       // another one for every answer to command::PickColour; 0 = none yet
    std::array<float, 3> colour{};  // in [0,1]
};

/// Splats that are chosen by a property, shown before anything is done with them.
struct PickedRows {
    bool shown = false;    // they take the place of the label's tint
    bool working = false;  // the property is being measured
    std::size_t count = 0;
    std::shared_ptr<const std::vector<float>>
        values;  // [N] of the property, NaN where there is none; null until it is measured
};

/// Labelled thing that is placed by hand, as it stood before: world units and unit vectors.
struct PlacedThing {
    Vec3 foot;             // the middle of where it stands
    Vec3 side, up, front;  // right, up and towards who looks at the front
    double height = 0, width = 0;
};

/// Requests of the running or last job to the networks.
struct NetworkCost {
    std::uint64_t unet = 0, encoder = 0, decoder = 0;  // passes over one picture
    double tflop = 0;                                  // 10^12 operations
};

/// One of several results that can be applied.
struct ResultView {
    std::shared_ptr<const Image> thumbnail;  // may be null
    std::uint64_t seed = 0;
};

/// Project that could not be opened, because its scene is not where it was.
struct LostScene {
    std::string project;  // or the work to recover; empty = there is none
    std::string name;     // of the project: "bear.gsep"
    std::string scene;    // where it was
};

/// Results of an applied edit, which can be exchanged for each other.
struct VariationsView {
    std::uint64_t edit = 0;  // identity on the stack
    std::vector<ResultView> results;
    std::size_t applied = 0;  // index into results
};

// Parts of the view model: each is assembled by one controller of the application.

/// The document and its files.
struct DocumentPart {
    const Document* document = nullptr;  // null or empty() = nothing open
    std::uint64_t opened = 0;            // another number for each document
    SceneStatistics statistics;
    std::string scene_path, project_path;
    std::string suggested_project;    // where a first save goes unless the artist says otherwise
    bool unsaved = false;             // a running or waiting edit counts
    std::string saved_at;             // "saved 14:02 (autosave on)"
    std::vector<std::string> recent;  // paths, newest first
    std::vector<std::shared_ptr<const Image>> recent_pictures;  // of them; null or missing = none
    std::vector<RecoveryView> recoverable;                      // newest first
    bool embeds = false;  // the project holds its scene, or will with the next save
    bool linked = false;  // there is a file of the scene that the project may refer to
    LostScene lost;
};

/// The viewport and its settings.
struct ViewportPart {
    TextureId viewport = 0;           // the rendered picture
    TextureId viewport_original = 0;  // to draw left of the wipe; 0 = the picture holds both sides already
    int viewport_width = 0,
        viewport_height = 0;  // pixels of `camera`; the texture may have fewer while moving
    std::shared_ptr<const Image> viewport_depth;  // [H,W,1] may be null; for front-only selection and picking
    Camera camera;                                // of the picture shown
    OrbitParameters orbit;                        // home: the fitted orbit,
    Bounds home;                                  // and what is to be seen from there
    Bounds framing;                               // of the whole scene
    SeenColour seen_colour;
    double render_ms = 0;
    std::string renderer;    // "native AVX-512", "Vulkan: llvmpipe"
    std::size_t hidden = 0;  // splats of the scene that the artist does not want to see at present
    ViewSettings view;
    Comparison comparison = Comparison::None;
    // Pictures of the document's views; null = not drawn yet (command::DrawView).
    std::vector<std::shared_ptr<const Image>> view_pictures;
    std::uint64_t compared_revision = 0;  // of the step that comparisons show as before; 0 = the usual
    std::string compared_name;            // of that step
};

/// The request and its search results.
struct SearchPart {
    edit::EditRequest request;
    std::vector<std::string> said_words;   // by the applied edits of the scene: no news any more
    std::vector<std::string> made_things;  // by the applied edits
    std::size_t words_read = 0;            // of the sentence, by the text encoder; 0 = all, or not known
    std::string read_target;  // the word that a search of this sentence saw to be new; empty = none looked
    EditScope scope;
    bool labelled_by_hand = false;  // nothing has to be found: the active label says what may change
    Estimate estimate;
    std::vector<AttentionView> attention;
    std::string attention_word, attention_mode;  // "bear", "modify: ..."
    double attention_threshold = 0.5;
    bool attention_arriving = false;   // a search is under way: views come in as they are attended
    bool voting = false;               // the job only votes anew: more views can be left out meanwhile
    bool attention_corrected = false;  // the label was set by hand since: the masks are older than it
    SearchView search;
    // Pictures and address of a search by the image server; empty = it cannot look for the source, or need
    // not.
    std::string server_search;
};

/// Judgement of the result that waits.
struct ResultVerdict {
    std::string text;     // of the model's encoder about the redrawn pictures; empty = nothing can judge them
    bool warns = false;   // they do not show the edit
    int stopped_at = -1;  // step at which the artist stopped it; -1 = it ran to its end
    int steps = 0;        // that it would have run
    std::vector<std::string> changes = {};   // of a sentence with several, that were made
    std::size_t asked = 1;                   // that the sentence had
    std::vector<std::string> kept_out = {};  // changes that failed, each with the reason
};

/// The running or last edit and its results.
struct EditPart {
    bool edit_running = false;
    GateView gate;
    std::vector<TargetRound> target_rounds;  // of an edit that views lead, in their order
    bool targets_wait = false;               // the fit of the last round begins when the artist says so
    NetworkCost cost;                        // of the running or last search or edit
    std::vector<LossPoint> losses;
    std::vector<SnapshotView> snapshots;
    int shown_snapshot = -1;        // index into snapshots, -1 = the result that waits, else the newest
    bool result_waiting = false;    // an edit is done and asks: apply or discard
    std::size_t result_splats = 0;  // of the result that waits
    std::size_t result_changed_outside = 0;  // splats outside the label that are not as they were
    double result_psnr_outside_db = 0;
    double result_seconds = 0;  // that the whole job took
    ResultVerdict verdict;
    std::vector<ResultView> results;         // of which one waits, the others beside it
    std::size_t shown_result = 0;            // index into results
    std::vector<VariationsView> variations;  // of edits of the stack
};

/// Labels and splats chosen by a property.
struct LabelPart {
    std::size_t labelled = 0;  // splats of the active label
    PickedRows picked;
    bool adjusting = false;  // the last step is an adjustment of colours, which more of it changes
};

/// The labelled thing while the artist places it.
struct PlacePart {
    std::optional<PlacedThing> placed;  // none = nothing is labelled, or it is not placed by hand
    bool placing = false;               // the last step is a placement, which more of it changes
};

/// Models and their settings.
struct ModelPart {
    std::vector<ModelView> models;
    std::vector<std::string> known_words;           // of the chosen model; empty = open vocabulary
    std::vector<std::string> generated_vocabulary;  // that it draws besides and does not look for
    bool words_known = false;                       // known_words has been read
    edit::EditRequest request_defaults;             // values that suit the model in use
    ModelSettings model_settings, model_settings_defaults;
    bool edits_by_instruction = false;  // the model in use is told what to do, too
    std::vector<LoraView> loras;
    bool loras_checking = false;              // others are being loaded, to see whether they can be used
    std::array<SegmenterView, 2> segmenters;  // by SegmenterRole
    int cache_mb = 0;                         // most that answers of the networks take on the disk; 0 = none
    std::uint64_t cache_bytes = 0;            // that they take
};

/// Answer of an image server to the question what it is, and its use.
struct ServerView {
    struct Fact {
        std::string name, value;
        std::string origin = {};  // of a value that could be another: "from the model's name"
    };
    remote::ServerSettings choice;  // nothing secret is in them
    remote::ServerSettings usual;   // as the family says: side, steps, guidance, strength; 0 = not asked yet
    bool on = false;                // it draws the views of edits
    bool testing = false;           // it is being asked
    bool is_comfy = false;          // it draws by workflows
    std::vector<Fact> facts;
    std::vector<std::string> notes;          // of the server, or about it
    std::vector<std::string> models, loras;  // to choose from; empty = not told
    remote::LoraNames lora_names = remote::LoraNames::Listed;
    std::vector<std::string> families{"auto"};  // to choose from
    std::string problem;  // why it cannot be used, with the remedy; empty = none is known
    int side_step = 64;   // px: sides of the family's pictures are multiples
    /// Program on a port of this machine.
    struct Here {
        std::string url, text;
        bool usable = false;
    };
    bool looking = false;    // for servers on this machine
    bool looked = false;     // the list is of a look that ended
    std::vector<Here> here;  // to choose from
};

/// Picture that the server draws now, as far as it is.
struct DrawingView {
    std::shared_ptr<const Image> sent, preview;  // [H,W,3] each, of any size; null = nothing to see
};

struct ServerPart {
    ServerView server;
    DrawingView drawing;
};

struct ExportPart {
    ExportSettings exports;
    std::vector<CameraKey> camera_keys;
};

struct NoticePart {
    AskedQuestion question;
    std::span<const LogLine> log;
    std::vector<Toast> toasts;
};

/// Jobs and the window itself.
struct WindowPart {
    JobStatus job;            // search, edit
    JobStatus file_job;       // load, export, save
    std::string cannot_edit;  // why Locate and Edit are off; empty = they are on
    double frames_per_second = 0;
    std::string keymap;  // Keymap::text(); empty = as it is by default
    float ui_scale = 1;
};

/// Everything the panels read. Assembled before every frame, never changed by them. Pointers and spans are
/// valid for the frame.
struct ViewModel : DocumentPart,
                   ViewportPart,
                   SearchPart,
                   EditPart,
                   LabelPart,
                   PlacePart,
                   ModelPart,
                   ServerPart,
                   ExportPart,
                   NoticePart,
                   WindowPart {};

}  // namespace gse::ui
