// Conditions, reasons and actions that menus, keys and buttons share.
#pragma once

#include <functional>
#include <string>

#include "ui/keys/keys.h"
#include "ui/model/context.h"
#include "ui/state/sentence.h"

namespace gse::ui {

/// Keys of a command, empty if it has none; "Brush (B)".
std::string keys_of(const Context& context, Shortcut command);
std::string with_key(const Context& context, std::string text, Shortcut command);

/// Reasons why these are off; empty = they are on.
std::string why_not_work(const Context& context);  // what is common to both
std::string why_not_locate(const Context& context);
std::string why_not_edit(const Context& context);
std::string why_not_label(const Context& context);  // there is no label, or a job runs
std::string why_not_save(const Context& context);
/// True for a step of the sentence that the artist does not want to be made.
bool is_left_out(const Context& context, const StepFacts& step);
/// Request with the word that is taken to be new if none is chosen: the coming edit.
edit::EditRequest as_planned(const Context& context);
/// Reason why the labelled splats cannot be hidden or isolated; empty = they can. Both change the display,
/// never the scene.
std::string why_not_hide(Context& context);
void hide_label(Context& context);
void isolate_label(Context& context);
/// Reason why views of the search cannot be excluded or included; empty = they can.
std::string why_not_vote(const Context& context);
/// Excludes the view of the search, or includes it. The label is voted again.
void toggle_vote(Context& context, int index);
std::string why_not_export(const Context& context, const std::string& path);
/// Saves a screenshot, with letters of the size that they have in the viewport.
void export_picture(Context& context);

/// Views that an edit will look from, of all: "24 of 63 views", "24 automatic views".
std::string views_text(const Context& context);

/// Puts another seed into the request.
void roll_seed(Context& context);
void run_locate(Context& context);
/// Lets the image server look for the source.
void run_server_search(Context& context);
void run_edit(Context& context);
/// Cancels the running job; asks first when it has worked for more than 30 s.
void cancel_job(Context& context);

void ask_open(Context& context);
/// Asks where the scene of the project is that could not be opened.
void ask_lost_scene(Context& context);
/// Opens. Asks first when there is unsaved work. Weights are opened in the Models panel.
void open_path(Context& context, const std::string& path);
/// Opens the path; of several, asks which.
void open_one_of(Context& context, const std::vector<std::string>& paths);
/// True for one file that may be a scene, while another scene is open.
bool can_be_put_in(const Context& context, const std::vector<std::string>& paths);
/// Reason why no scene can be put into the open one; empty = one can.
std::string why_not_put_in(const Context& context);
/// Asks whether a scene is put into the open one, or opened in its place.
void ask_put_in_or_open(Context& context, const std::string& path);
/// Puts in the scene of the last answer, if there is one. Once per frame.
void put_in_what_is_asked(Context& context);
/// Asks for a scene that is put into the open one.
void ask_put_in(Context& context);
void open_sample(Context& context);
void save(Context& context);
/// Saves under another name. Calls `then` (may be empty) once it is saved.
void save_as(Context& context, std::function<void()> then = {});
/// Acts. Asks first when there is unsaved work, a running or waiting edit included. `what` is the sentence of
/// the coming action.
void with_unsaved_work(Context& context, const std::string& what, std::function<void()> act);
void recover(Context& context, const std::string& file);
void discard_recovery(Context& context, const RecoveryView& found);
void quit(Context& context);
void add_label(Context& context);
/// Adds a label of that name and takes the tool that cuts out an object, for objects that no words find.
void label_by_hand(Context& context, const std::string& name);
/// Tells whether an edit waits for a click on the source, which the model does not know.
bool asks_for_click(const Context& context);
void set_tool(Context& context, Tool tool);
/// Switches the tint on, so that the labelled splats show.
void show_labelled(Context& context);
void toggle_wipe(Context& context);
/// Frames the labelled splats, else the scene.
void frame_selection(Context& context);
void go_home(Context& context);
/// Looks through the view `step` places further in the list.
void step_view(Context& context, int step);
void scale_ui(Context& context, float factor);

/// Rows of the active label that are set.
std::size_t label_count(Context& context);

/// Endings that the readers know.
const std::vector<std::string>& scene_extensions();
const std::vector<std::string>& film_extensions();

}  // namespace gse::ui
