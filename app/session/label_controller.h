// Labels, splats chosen by a property, the edit stack and its undo steps: every change is one named step.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/session/edit_controller.h"
#include "app/session/model_controller.h"
#include "app/session/search_controller.h"
#include "app/session/state/workspace.h"
#include "app/session/view_controller.h"
#include "engine/localize/row_picking.h"

namespace gse::app {

class LabelController {
public:
    LabelController(Workspace& workspace, ViewController& view, ModelController& models,
                    SearchController& search, EditController& edits)
        : workspace_(workspace), view_(view), models_(models), search_(search), edits_(edits) {}

    void run(const ui::LabelCommand& command);
    /// Follows the splats that are chosen by a property. Once per frame.
    void refresh();
    void show(ui::LabelPart& model) const;
    /// Another document is open: nothing is chosen or adjusted in it.
    void take_document();
    /// Nothing is chosen by a property any more.
    void drop_picked();
    /// Adds what splats are chosen by a property.
    void dress(Stage& stage) const;

    /// Changes the edit stack, unless a job runs or a result waits.
    void change_stack(const std::string& name, const std::function<void(std::vector<EditNode>&)>& change,
                      const std::string& merge_key = {});

private:
    /// Colours that are being adjusted, while that is the last step.
    struct AdjustedColours {
        DocumentState before;
        std::uint64_t revision, id;  // of the step, and of its edit
    };
    template <class C> void on(const C& command);
    const DocumentState& state() const { return workspace_.document.state(); }
    /// Changes the active label; where there is none, a new one with that name or a number behind it.
    void change_label(const std::string& name, const std::function<NamedLabel(NamedLabel)>& change,
                      const std::string& merge_key = {}, const std::string& new_name = "selection");
    void add_label(NamedLabel label, const std::string& step);
    void take_cut_out(const std::vector<std::uint8_t>& rows, ui::SetOperation operation, const Camera& camera,
                      const Vec3& up);
    bool stack_is_free();
    void delete_rows(const std::vector<std::uint8_t>& rows);
    void measure_picked();

    Workspace& workspace_;
    ViewController& view_;
    ModelController& models_;
    SearchController& search_;
    EditController& edits_;
    std::optional<AdjustedColours> adjusted_;
    std::optional<localize::RowPicking> picking_;  // splats chosen by a property
    ui::PickedRows picked_;
    std::uint64_t hidden_seen_ = 0;  // what is hidden is not picked
};

}  // namespace gse::app
