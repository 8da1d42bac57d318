// State of the window between frames: tools, open dialogs, caches of widgets. Never the document.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "engine/localize/row_property.h"
#include "ui/keys/keyboard.h"
#include "ui/keys/keymap.h"
#include "ui/model/context.h"
#include "ui/model/layout.h"
#include "ui/state/camera_control.h"
#include "ui/state/sentence.h"
#include "ui/widgets/chips.h"
#include "ui/widgets/file_browser.h"
#include "ui/widgets/histogram.h"

namespace gse::ui {

/// A question in the middle of the window; every answer closes it.
struct Question {
    struct Answer {
        std::string text;
        bool dangerous = false;
        std::function<void()> act;  // empty = nothing happens
        std::string detail = {};
        bool listed = false;  // one of many, in a list above the buttons
    };
    std::string title, text;
    std::vector<Answer> answers;
    bool pending = false;
};

/// Viewport: camera, tools and the shape that is drawn with the mouse.
struct ViewportState {
    CameraControl camera;
    SentCameras sent;
    bool camera_known = false;
    double fov_setting = 0;  // last seen, to notice a change in Settings
    OrbitParameters home;    // last seen
    std::optional<Bounds>
        labelled_home;  // of the label that Home framed last; none = what stands on the ground
    Tool tool = Tool::Orbit;
    SetOperation operation = SetOperation::Add;  // without keys held
    bool stroke = false;                         // a tool's drag goes on
    SetOperation stroke_operation = SetOperation::Add;
    ImVec2 stroke_start{};
    std::vector<std::array<float, 2>> path;  // of the drag, in window coordinates
    int sent_width = 0, sent_height = 0;     // last asked for
    ImVec2 low{}, high{};                    // of the picture on the screen
    int selected_view = -1;
    bool flipped = false;  // ` is held
    Comparison before_flip = Comparison::None;
    bool wipe_dragged = false;
    float bars_bottom = 0;  // lower edge of what floated at the top in the last frame
    ImVec2 foot_low{};      // upper left corner of what floated at the foot; its y is that of `high` where
                            // nothing did
    double moved_at = -10;  // ImGui time of the last move
    std::optional<bool> tint_before;  // the artist's, while a colour is picked
    int drag_button = -1;             // mouse button that navigates, -1 = none
};

/// Facts about the sentence, kept until it changes.
struct PromptState {
    std::string key;  // what the rest was computed from
    std::vector<Chip> chips;
    std::string problem;         // why the request cannot be run; empty = it can
    std::string locate_problem;  // the same for Locate alone
    std::vector<std::string> source_suggestions;
    std::string source_help;
    bool source_known = true;
    double typed_at = -1e9;       // time of ImGui when a letter of a field was typed last
    std::string settings_filter;  // what "All settings" is searched for
    std::string guessed_target;
    edit::EditWords told;  // SentenceFacts::told
    std::vector<StepFacts> steps;
    bool refused = false;               // SentenceFacts::refused
    std::string missing;                // SentenceFacts::missing
    std::vector<std::string> left_out;  // steps that are not made, by their notation
    std::string cut_at;                 // first word that the text encoder does not read
    bool seed_locked = true;            // open: every edit gets another seed
    bool advanced = false;
};

/// Layer of the chosen search view over the picture, while the camera stands there.
enum class Over : std::uint8_t { Nothing, Attention, Mask };

struct AttentionState {
    int chosen = 0;
    Over over = Over::Nothing;
    std::shared_ptr<const Image> layer;       // [H,W,4] over the picture
    std::shared_ptr<const void> layer_of;     // map or mask it was made from
    double threshold = -1;                    // while dragged, else negative
    std::shared_ptr<const Image> picture;     // thresholded map over the render
    std::shared_ptr<const Image> picture_of;  // the map it was made from
    double picture_threshold = -1;
    double above = 0;                 // share of the picture above the threshold
    std::uint64_t problem_shown = 0;  // number of the failed search that was brought to the front
    bool points = true;
};

struct LabelsState {
    WeightHistogram histogram;
    float threshold = -1;  // while dragged, else negative
    int renamed = -1;
    std::string name;
    bool focus_name = false;
    std::shared_ptr<const std::vector<std::uint8_t>> counted;
    std::size_t count = 0;
    int steps = 1;
};

/// Splats by a property, with the last choice of each property.
struct PickState {
    int property = 0;
    bool within = false;
    int frames_to_bring = 0;         // in which it is scrolled to, after it was unfolded
    std::uint64_t colour_taken = 0;  // number of the last ViewModel::seen_colour
    bool seen = false;               // in this frame: what is chosen is only shown while its controls are
    std::array<localize::RowChoice, 4> choices{
        {{localize::RowProperty::Opacity, {}, 0.1f, false, false},
         {localize::RowProperty::Size,
          {},
          static_cast<float>(localize::property_value(localize::RowProperty::Size, 0.05)),
          true,
          false},
         {localize::RowProperty::Colour, {0.5f, 0.5f, 0.5f}, 0.15f, false, false},
         {localize::RowProperty::Isolation,
          {},
          static_cast<float>(localize::property_value(localize::RowProperty::Isolation, 4)),
          true,
          false}}};
    WeightHistogram histogram;
};

/// Colours adjusted by hand, as the controls stand.
struct AdjustState {
    ColourAdjustment values;
    bool adjusting = false;   // in the last frame
    int frames_to_bring = 0;  // as in PickState
};

/// Place of the labelled thing by hand, as the controls stand.
struct PlaceState {
    edit::RearrangeSettings values;
    bool placing = false;  // in the last frame
    bool used = false;     // command::UsePlacing as it was sent last
    int handle = -1;       // that is dragged, or under the mouse; -1 = none
    bool dragged = false;
    bool ends = false;  // a change was sent that is not told to be the drag's last one
    ImVec2 start{};     // of the drag
    edit::RearrangeSettings start_values;
    int frames_to_bring = 0;  // as in PickState
};

/// Changes of the labelled splats by hand.
struct HandState {
    AdjustState adjust;
    PlaceState place;
};

/// Keys as the artist has them.
struct KeysState {
    std::string read;                  // ViewModel::keymap that `keymap` was read from
    std::optional<Shortcut> choosing;  // its next keys are those of this command
    std::string note;                  // what came of the last choice
};

struct ProgressState {
    bool curves = false, cost = false;  // they are unfolded
    bool logarithmic = true;
    std::array<bool, 3> losses{true, true, true};
    std::array<bool, 2> norms{true, true};
};

struct TargetsState {
    int chosen = -1;      // round, -1 = the last
    int waited_for = -1;  // round whose fit waited in the last frame, -1 = none
    std::string view;     // that a dropped picture is for; empty = none is selected
};

struct LogState {
    std::array<bool, 4> shown{false, true, true, true};  // Debug, Info, Warning, Error
    std::string filter;
    std::size_t lines_seen = 0;
    bool follow = true;
};

struct ViewsState {
    int renamed = -1;
    std::string name;  // as it is typed
    bool focus_name = false;
    std::uint64_t asked_at = 0;      // revision of the document of which
    std::vector<std::size_t> asked;  // these views were asked to be drawn
    int names_from = -1;             // a view with this number is new, and named next; -1 = none is awaited
};

struct HistoryState {
    std::uint64_t chosen = 0;  // identity of an edit
};

/// Texts that are being typed in Models.
struct ModelsState {
    std::string model_path, lora_text;
    std::array<std::string, 2> segmenter_paths;  // by SegmenterRole
    std::string server_url, server_problem;      // as it is typed; why that is no address
    std::string server_shown;                    // address in use when the text was last taken from it
    std::string server_user, server_password;
    std::string server_lora, server_option, server_workflow, server_ca;
};

/// Requests to carry out before the next frame is drawn.
struct Asked {
    bool save_as = false;
    std::function<void()> after_save;  // of save_as
    bool quit = false;
    struct {
        std::string what;
        std::function<void()> act;    // empty = none
    } leave;                          // once more: an edit was discarded, other work may be left
    std::vector<std::string> open;    // paths to open one of, from outside; empty = none
    bool dropped = false;             // they were dropped on the window
    std::string put_in;               // scene to put into the open one; empty = none
    std::uint64_t question_seen = 0;  // number of the application's last question that was shown
};

struct UiState {
    Layout layout = Layout::standard();
    ViewportState viewport;
    PromptState prompt;
    AttentionState attention;
    LabelsState labels;
    PickState pick;
    HandState by_hand;
    Keymap keymap;
    KeysState keys;
    ProgressState progress;
    TargetsState targets;
    LogState log;
    HistoryState history;
    ViewsState views;
    FileBrowser files;
    Question question;
    KeyboardState keyboard;
    std::array<bool, AreaCount> front_changed{true, true, true};  // a tab has to be brought to the front
    bool help_open = false, about_open = false;
    Asked asked;
    ModelsState models;
    bool animating = false;
    std::uint64_t document = 0;  // ViewModel::opened that the rest was of
};

/// Forgets all that belongs to one scene. Sizes, tools' settings, keys and what was typed for models stay.
void forget_scene(UiState& state);

/// Brings a panel to the front.
void show_panel(UiState& state, PanelId panel);

}  // namespace gse::ui
