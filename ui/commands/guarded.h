// What menus, keys and buttons share: when a thing can be done, why not, and doing it.
#pragma once

#include <functional>
#include <string>

#include "ui/context.h"
#include "ui/keys/keys.h"

namespace gse::ui {

/// The keys of a command, empty where it has none; "Brush (B)".
std::string keys_of(const Context& context, Shortcut command);
std::string with_key(const Context& context, std::string text, Shortcut command);

/// Why these are off; empty = they are on.
std::string why_not_work(const Context& context);  // what is common to both
std::string why_not_locate(const Context& context);
std::string why_not_edit(const Context& context);
std::string why_not_label(const Context& context);  // there is no label, or a job runs
std::string why_not_save(const Context& context);
/// The request with the word that is taken to be new where none is chosen: what an edit will be.
edit::EditRequest as_planned(const Context& context);
/// Why what is labelled cannot be hidden or isolated; empty = it can. Both change what is seen, never the
/// scene.
std::string why_not_hide(Context& context);
void hide_label(Context& context);
void isolate_label(Context& context);
/// Why views of the search cannot be left out or put back; empty = they can.
std::string why_not_vote(const Context& context);
/// Leaves the view of the search out, or puts it back: the label is voted again.
void toggle_vote(Context& context, int index);
std::string why_not_export(const Context& context, const std::string& path);

/// How many views an edit will look from, of those there are: "24 of 63 views", "24 automatic views".
std::string views_text(const Context& context);

/// Another seed.
void roll_seed(Context& context);
void run_locate(Context& context);
void run_edit(Context& context);
/// Cancels the running job; asks first when it has worked for more than 30 s.
void cancel_job(Context& context);

void ask_open(Context& context);
/// Opens; asks first when there is unsaved work.
void open_path(Context& context, const std::string& path);
void open_sample(Context& context);
void save(Context& context);
/// `then` (may be empty) is called once it is saved.
void save_as(Context& context, std::function<void()> then = {});
/// Acts; asks first when there is unsaved work, a running or waiting edit included. `what` is to happen, as a
/// sentence.
void with_unsaved_work(Context& context, const std::string& what, std::function<void()> act);
void recover(Context& context, const std::string& file);
void discard_recovery(Context& context, const RecoveryView& found);
void quit(Context& context);
void add_label(Context& context);
/// A label of that name, and the tool that cuts out a thing, where no words find it.
void label_by_hand(Context& context, const std::string& name);
void set_tool(Context& context, Tool tool);
/// Switches the tint on: who labels has to see what.
void show_labelled(Context& context);
void toggle_wipe(Context& context);
/// Sees what is labelled, else the scene.
void frame_selection(Context& context);
void go_home(Context& context);
/// View `step` places further in the list.
void step_view(Context& context, int step);
void scale_ui(Context& context, float factor);

/// Rows of the active label that are set.
std::size_t label_count(Context& context);

/// Endings the readers know.
const std::vector<std::string>& scene_extensions();
const std::vector<std::string>& film_extensions();

}  // namespace gse::ui
