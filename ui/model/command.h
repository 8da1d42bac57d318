// Commands: everything that an artist can ask for, as values. Panels push them into a sink; after the frame
// the application takes them in their order. Work goes to job threads, and its outcome is in a later
// ViewModel.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "engine/localize/row_property.h"
#include "engine/scene/colour_adjustment.h"
#include "ui/model/view_model.h"

namespace gse::ui {

/// A region of the viewport, in pixels of its texture, that splats are selected with.
struct ScreenRegion {
    std::vector<std::array<float, 2>> polygon = {};  // closed; empty = use the circles
    std::vector<std::array<float, 2>> circles = {};  // centres of a brush stroke
    float radius_px = 0;
};

/// Uses of splats that were chosen by a property.
enum class PickedUse { NewLabel, Add, Remove, Delete };

namespace command {

// Files and recovery.
/// Opens a scene, a folder, a project, cameras of the open scene, or a PNG with a recipe.
struct Open {
    std::filesystem::path path;
    bool activated = false;  // see ReadingOptions
};
struct OpenSample {};
/// Saves the project; an empty path = its last file. Calls `then` (may be empty) once it is saved.
struct SaveProject {
    std::filesystem::path path = {};
    std::function<void()> then = {};
};
/// Stops a running edit, then calls `then`. With Keep, its state and all other unsaved work go to the
/// recovery folder. Otherwise its state, or the result that waits, is dropped.
struct LeaveEdit {
    bool keep = false;
    std::function<void()> then;
};
struct Recover {
    std::string project;
};
struct DiscardRecovery {
    std::string project;
};
/// Offers the work again another time.
struct PostponeRecovery {
    std::string project;
};
/// Opens the project whose scene was not there, with that file as its scene.
struct FindScene {
    std::filesystem::path path;
};
/// Leaves that project alone.
struct ForgetLostScene {};
/// Puts the scene into the project and saves it, or leaves it out of the next save.
struct EmbedScene {
    bool on = true;
};
struct SetUpAxis {
    std::string up;  // "y", "-y", "auto", ...
};
/// Removes splats that cannot be drawn (undoable).
struct RepairScene {};
struct CancelFileJob {};

// Searches, edits and results.
struct SetRequest {
    edit::EditRequest request;
};
struct Locate {
    bool source_alone = false;  // the sentence cannot be edited by: its source is looked for all the same
    bool by_server = false;  // the image server shows where it is; sends what SearchPart::server_search says
};
/// Labels the splats that an unsure search found.
struct LabelAnyway {};
/// Makes the changes that the sentence asks for, one after another.
struct Edit {
    std::vector<std::string> left_out = {};  // of its plan, in the plan's notation
};
struct Pause {
    bool paused = true;
};
/// Cancels the search or edit that runs.
struct Cancel {};
/// Keeps, drops or redraws a view of the round that is fitted to now.
struct OrderTarget {
    edit::TargetOrder order;
};
/// Lets the waiting edit fit to its redrawn views.
struct FitToTargets {};
struct ApplyResult {};
/// Drops the result that waits and those beside it.
struct DiscardResult {};
/// Edits once more with another seed. The result that waits is kept beside the new one.
struct AnotherResult {};
struct ShowResult {
    std::size_t index = 0;
};
struct ShowSnapshot {
    int index = -1;  // -1 = newest
};
/// Makes that state the result that waits.
struct TakeSnapshot {
    int iteration = 0;
};
/// Goes on from that state with the settings as they are now.
struct BranchFromSnapshot {
    int iteration = 0;
};
/// Moves the threshold of the attention. A drag is one step of undo.
struct SetAttentionThreshold {
    double value = 0;
    bool drag_ends = true;
};
/// Excludes a view of the search, or includes it. The label is voted again.
struct LeaveOutView {
    std::size_t view = 0;
    bool out = true;
};
/// Chooses the splats that may change: those of the active label, or those that a search finds.
struct SetScope {
    bool by_label = true;
};
/// Puts the settings of an applied edit into the prompt, with a new seed.
struct RepeatEdit {
    std::uint64_t id = 0;
};

// Labels, splats and the edit stack (all undoable).
struct SetLabelThreshold {
    float value = 0;
    bool drag_ends = true;
};
struct SetActiveLabel {
    int index = 0;
};
struct AddLabel {
    std::string name;
};
struct RenameLabel {
    int index = 0;
    std::string name;
};
struct DeleteLabel {
    int index = 0;
};
struct Select {
    ScreenRegion region;
    SetOperation operation = SetOperation::Add;
    bool stroke_ends = true;
};
/// Selects the object in the box, or the one under a polygon of one point.
struct CutOut {
    ScreenRegion box;
    SetOperation operation = SetOperation::Add;
};
/// Grows the label over its neighbours; negative shrinks.
struct GrowLabel {
    int steps = 1;
};
struct InvertLabel {};
struct ClearLabel {};
struct DeleteLabelledSplats {};
/// Deletes them and fills the hole with what is around it.
struct HealLabelledSplats {};
/// Adjusts the colours of the labelled splats, or of all if none is labelled. Several in a row start from
/// their common colours and are one step of undo. The neutral adjustment takes them back.
struct AdjustColours {
    ColourAdjustment adjustment;
};
/// Shows the labelled thing's place, for handles to drag, or no longer.
struct UsePlacing {
    bool on = false;
};
/// Moves, turns, resizes or copies the labelled thing. Several in a row start from its common place and are
/// one step of undo. The settings' defaults take them back. Where a drag ends, the thing's shadow goes along.
struct PlaceThing {
    edit::RearrangeSettings settings;
    bool drag_ends = true;
};
/// Removes what was painted over, and fills the place with what is around it.
struct HealStroke {
    ScreenRegion region;
};
/// Puts another scene into the open one, labelled by its name.
struct PutIn {
    std::filesystem::path path;
};
/// Fills the hole where the thing stood that was just placed.
struct HealPlace {};
/// Shows the splats of a choice by property until they are dropped. Only UsePicked changes anything.
struct PickRows {
    localize::RowChoice choice;
};
struct DropPicked {};
/// Asks for the colour that the picture shows at a pixel of the viewport; it comes as ViewModel::seen_colour.
struct PickColour {
    int x = 0, y = 0;
};
struct UsePicked {
    PickedUse use = PickedUse::NewLabel;
};
struct Undo {};
struct Redo {};
struct GoTo {
    std::size_t position = 0;
};
struct SetEditEnabled {
    std::uint64_t id = 0;
    bool enabled = true;
};
/// Blends an edit with the scene before it. A drag is one step of undo.
struct SetEditStrength {
    std::uint64_t id = 0;
    double strength = 1;
    bool drag_ends = true;
};
/// Puts another result of an applied edit in its place.
struct ExchangeVariation {
    std::uint64_t id = 0;
    std::size_t index = 0;  // of VariationsView::results
};
struct DeleteEdit {
    std::uint64_t id = 0;
};
struct MoveEdit {
    std::uint64_t id = 0;
    int places = 0;
};

// The view: never part of undo, viewpoints of the scene apart.
struct HideLabel {};
/// Hides all splats that are not labelled.
struct IsolateLabel {};
struct ShowHidden {};
struct SetCamera {
    Camera camera;  // in viewport pixels; resolution may drop while it moves
};
struct SetViewSettings {
    ViewSettings settings;
};
struct SetComparison {
    Comparison comparison = Comparison::None;
};
/// Compares with a step of undo. A second time = the original again.
struct CompareWith {
    std::size_t position = 0;
};
struct LookThrough {
    std::size_t view = 0;
};
/// Adds the present camera to the viewpoints.
struct AddView {};
struct DeleteView {
    std::size_t view = 0;
};
struct RenameView {
    std::size_t view = 0;
    std::string name;
};
/// Has a small picture of the scene drawn from there, for the list of views.
struct DrawView {
    std::size_t view = 0;
};
struct SetViewportSize {
    int width = 1, height = 1;  // framebuffer pixels
};

// Models.
struct SetModelSettings {
    ModelSettings settings;
};
/// Uses a file or folder of weights by its kind: as the model, a LoRA, or a segmenter. Says in one sentence
/// why another kind is of no use here, and what is.
struct OpenModel {
    std::filesystem::path path;
};
/// Tries a model, lists it, and uses it if it loads.
struct ChooseModel {
    std::string path;
};
/// Merges a LoRA (FILE or FILE:strength). The model stays as it was if that fails.
struct AddLora {
    std::string text;
};
struct SetLoraStrength {
    std::size_t index = 0;
    double strength = 1;
};
struct RemoveLora {
    std::size_t index = 0;
};
/// Tries weights of a segmenter; empty = none.
struct ChooseSegmenter {
    SegmenterRole role = SegmenterRole::Clicks;
    std::string path = {};
};
/// Bounds the disk cache of the networks' answers; 0 = none.
struct SetCacheMb {
    int most = 0;
};
struct ClearCache {};

// The image server.
/// Takes settings of it. A name and a password in the address are kept in the user's file of passwords.
struct SetServer {
    remote::ServerSettings choice;
};
/// Keeps name and password for the server in the user's file of passwords.
struct KeepServerPassword {
    std::string name, password;
};
/// Asks it what it is. No picture is sent.
struct TestServer {};
/// Looks for image servers on this machine.
struct FindServers {};
/// Has it draw the views of edits, or no longer.
struct UseServer {
    bool on = true;
};
/// Forgets address, facts and password.
struct ForgetServer {};

// Exports.
struct SetExports {
    ExportSettings settings;
};
/// `em_px`: size of the window's letters in pixels of the viewport's camera, for what lies over the picture.
struct ExportPicture {
    float em_px = 15;
};
struct ExportTurntable {};
struct ExportScene {};
struct ExportViewpoints {};
struct AddCameraKey {};
struct DeleteCameraKey {
    std::size_t index = 0;
};
/// Writes the camera path as JSON, or the film along it.
struct ExportCameraPath {
    bool as_film = false;
};

// The window.
/// Answers the application's question.
struct Answer {
    std::size_t index = 0;
};
struct DismissToast {
    std::size_t index = 0;
};
struct PressToast {
    std::size_t index = 0;
};
/// Opens the artist's guide in the desktop's browser.
struct OpenGuide {};
struct ToggleFullscreen {};
struct SetUiScale {
    float scale = 1;
};
struct SetKeymap {
    std::string text;  // Keymap::text()
};
struct Quit {};

}  // namespace command

using FileCommand = std::variant<command::Open, command::OpenSample, command::SaveProject, command::LeaveEdit,
                                 command::Recover, command::DiscardRecovery, command::PostponeRecovery,
                                 command::FindScene, command::ForgetLostScene, command::EmbedScene,
                                 command::SetUpAxis, command::RepairScene, command::CancelFileJob>;
using SearchCommand =
    std::variant<command::SetRequest, command::Locate, command::LabelAnyway, command::SetAttentionThreshold,
                 command::LeaveOutView, command::SetScope, command::RepeatEdit>;
using EditCommand =
    std::variant<command::Edit, command::Pause, command::Cancel, command::OrderTarget, command::FitToTargets,
                 command::ApplyResult, command::DiscardResult, command::AnotherResult, command::ShowResult,
                 command::ShowSnapshot, command::TakeSnapshot, command::BranchFromSnapshot>;
using LabelCommand =
    std::variant<command::SetLabelThreshold, command::SetActiveLabel, command::AddLabel, command::RenameLabel,
                 command::DeleteLabel, command::Select, command::CutOut, command::GrowLabel,
                 command::InvertLabel, command::ClearLabel, command::DeleteLabelledSplats,
                 command::AdjustColours, command::PickRows, command::DropPicked, command::UsePicked,
                 command::Undo, command::Redo, command::GoTo, command::SetEditEnabled,
                 command::SetEditStrength, command::ExchangeVariation, command::DeleteEdit,
                 command::MoveEdit>;
using PlaceCommand = std::variant<command::HealLabelledSplats, command::UsePlacing, command::PlaceThing,
                                  command::HealPlace, command::HealStroke, command::PutIn>;
using ViewCommand =
    std::variant<command::HideLabel, command::IsolateLabel, command::ShowHidden, command::SetCamera,
                 command::SetViewSettings, command::SetComparison, command::CompareWith, command::LookThrough,
                 command::AddView, command::DeleteView, command::RenameView, command::DrawView,
                 command::PickColour, command::SetViewportSize>;
using ModelCommand = std::variant<command::SetModelSettings, command::OpenModel, command::ChooseModel,
                                  command::AddLora, command::SetLoraStrength, command::RemoveLora,
                                  command::ChooseSegmenter, command::SetCacheMb, command::ClearCache>;
using ServerCommand = std::variant<command::SetServer, command::KeepServerPassword, command::TestServer,
                                   command::FindServers, command::UseServer, command::ForgetServer>;
using ExportCommand = std::variant<command::SetExports, command::ExportPicture, command::ExportTurntable,
                                   command::ExportScene, command::ExportViewpoints, command::AddCameraKey,
                                   command::DeleteCameraKey, command::ExportCameraPath>;
using NoticeCommand = std::variant<command::Answer, command::DismissToast, command::PressToast>;
using WindowCommand = std::variant<command::OpenGuide, command::ToggleFullscreen, command::SetUiScale,
                                   command::SetKeymap, command::Quit>;

/// A command; each alternative is the list of one controller.
using Command = std::variant<FileCommand, SearchCommand, EditCommand, LabelCommand, PlaceCommand, ViewCommand,
                             ModelCommand, ServerCommand, ExportCommand, NoticeCommand, WindowCommand>;

/// Commands of a frame in their order, kept until the frame is drawn. Nothing that panels read changes under
/// their hands.
class CommandSink {
public:
    void push(Command command) { commands_.push_back(std::move(command)); }
    bool empty() const { return commands_.empty(); }
    /// Commands so far. Those pushed while they run wait for the next time.
    std::vector<Command> take() { return std::exchange(commands_, {}); }

private:
    std::vector<Command> commands_;
};

}  // namespace gse::ui
