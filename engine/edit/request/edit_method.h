// The ways in which a model can lead an edit. A new way is an EditMethod object and its line in
// edit_methods.cpp; command line, window, estimate and report go by that table.
#pragma once

#include <span>
#include <string>

#include "engine/edit/request/checked_request.h"
#include "engine/edit/request/field_use.h"

namespace gse::edit {

/// Work that is left for the model, in units whose cost is measured.
struct MethodWork {
    double pulls = 0;            // gradients of a guidance
    double views = 0;            // redrawn pictures of the last round
    double early_views = 0;      // redrawn pictures of the rounds before it
    double denoising_steps = 0;  // of single pictures; those that are not guided count half
    double refreshed_masks = 0;  // masks that could follow the edit
    double searched_views = 0;   // pictures searched to see where something added is
    double pictures() const { return views + early_views; }
};

/// The optimiser as a method may run it. Each call throws Error as run_edit() does.
class MethodRun {
public:
    virtual ~MethodRun() = default;
    /// Has the model redraw views and fits the rows to them.
    virtual void fit_redrawn_views(const CheckedRequest& request) = 0;
    /// Follows the model's gradient at every step.
    virtual void follow_gradient(const CheckedRequest& request) = 0;
};

/// One way to lead an edit.
class EditMethod {
public:
    virtual ~EditMethod() = default;
    /// Value of LoopSettings::method.
    virtual const char* name() const = 0;
    /// Work of the model, for help texts: "redraws some views, the scene is fitted to them".
    virtual const char* description() const = 0;
    /// Driver of the edit: "redrawn views".
    virtual const char* leader() const = 0;
    /// How the edit goes on: "views are redrawn and fitted to".
    virtual const char* process() const = 0;
    /// FieldUse bits of the settings that count.
    virtual unsigned uses() const = 0;
    /// Tells whether the model draws views: they may show words that it cannot find, and are judged as they
    /// are.
    virtual bool draws_views() const = 0;
    /// Optimisation steps of an edit: one where nothing is drawn.
    int steps(const LoopSettings& settings, EditMode mode) const {
        return is_drawn(mode) ? drawn_steps(settings, mode) : 1;
    }
    /// Changes the settings so that an edit has about that many steps, at least one.
    virtual void set_steps(LoopSettings& settings, EditMode mode, int steps) const = 0;
    /// Explains the number of steps to the artist.
    virtual std::string steps_help(const LoopSettings& settings, EditMode mode) const = 0;
    /// Work from an iteration on. `drawn`: the search has drawn the new thing, which tells its colour.
    /// None where nothing is drawn.
    MethodWork work(const EditSettings& settings, const language::EditSentence& sentence, EditMode mode,
                    int first_iteration, bool drawn) const {
        return is_drawn(mode) ? drawn_work(settings, sentence, mode, first_iteration, drawn) : MethodWork{};
    }
    virtual void run(MethodRun& run, const CheckedRequest& request) const = 0;

    /// Tells whether a setting with these FieldUse bits changes anything.
    bool counts(unsigned field_uses) const { return field_uses == 0 || (field_uses & uses()) != 0; }

private:
    virtual int drawn_steps(const LoopSettings& settings, EditMode mode) const = 0;
    virtual MethodWork drawn_work(const EditSettings& settings, const language::EditSentence& sentence,
                                  EditMode mode, int first_iteration, bool drawn) const = 0;
};

/// All methods; "auto" means the first.
std::span<const EditMethod* const> edit_methods();

/// The method of that name, or the first for "auto"; null = there is none.
const EditMethod* method_named(const std::string& name);
/// The method of the settings, or the first where the name is unknown.
const EditMethod& method_of(const LoopSettings& settings);
/// Throws Error (InvalidArgument) for an unknown name.
void require_method(const std::string& name);

/// "auto" and the names of all methods.
std::span<const char* const> method_names();
/// One line per name, "auto" first.
const std::string& methods_explained();
/// Why a setting with these FieldUse bits does not count with the method, in two sentences; empty = it does.
std::string why_unused(const EditMethod& method, unsigned field_uses);

/// Optimisation steps of an edit by the method of its settings.
int loop_steps(const LoopSettings& settings, EditMode mode);

}  // namespace gse::edit
