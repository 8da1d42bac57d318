// The document that an artist works on: base scene, stack of edits as deltas, labels and views, with undo.
// States are values that share their arrays, so a step of undo costs only its changes.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "engine/base/image.h"
#include "engine/scene/delta.h"
#include "engine/scene/label_field.h"
#include "engine/scene/scene.h"

namespace gse {

/// Label values of rows that are absent at present (their edit is off). They come back labelled.
struct AbsentRows {
    std::vector<RowId> ids;           // ascending
    std::vector<float> weight;        // [ids]
    std::vector<std::int8_t> manual;  // [ids]
};

/// A named label that an artist sees and corrects. bits[row] = manual[row] != 0 ? manual[row] > 0 :
/// weight[row] > threshold.
struct NamedLabel {
    std::string name;
    float threshold = 0.5f;
    std::string
        found_for;  // word that a search found it for, whatever it is called now; empty = not by a search
    // It was found with; 0 = what the model states, negative = not by a search.
    double attention_threshold = -1;
    std::string excluded_views;  // views of that search that did not vote, as numbers: "3, 17"
    std::string looked_from;     // azimuth of the view in which its thing was marked by hand, or looked for,
                                 // degrees; empty = not known
    std::shared_ptr<const std::vector<float>>
        weight;  // [N] in [0,1] as decided at the threshold, not by hand
    std::shared_ptr<const std::vector<std::int8_t>>
        manual;  // [N] +1 added, -1 removed by hand, 0 = as the weight says
    std::shared_ptr<const std::vector<std::uint8_t>> bits;  // [N] 0 or 1, what the others give
    std::shared_ptr<const AbsentRows> absent;               // may be null
    /// Field of its search. The weights follow from it and the threshold. Null for a label that was not
    /// searched for, and once its rows are others.
    std::shared_ptr<const FoundField> found = {};
};

/// Fills `bits` from weight, manual and threshold. A channel that is null counts as zeros.
NamedLabel with_bits(NamedLabel label);

/// One edit of the stack.
struct EditNode {
    std::uint64_t id = 0;
    std::string name;    // the sentence, or what was done
    std::string recipe;  // JSON: everything needed to repeat it; may be empty
    bool enabled = true;
    double strength = 1;  // how much of it is seen, see with_strength()
    std::shared_ptr<const SceneDelta> delta;
    std::shared_ptr<const Image> thumbnail;  // may be null
    double seconds = 0;
    double psnr_outside_db = 0;
    std::size_t changed_outside_label = 0;
};

/// One state of the document. A copy copies pointers.
struct DocumentState {
    GaussianSet base;    // as loaded
    ExtraColumns extra;  // [base.size()] each
    SceneInfo info;
    std::vector<EditNode> stack;                        // oldest first
    GaussianSet current;                                // base with the enabled edits applied
    std::shared_ptr<const std::vector<RowId>> row_ids;  // [current.size()]
    std::vector<NamedLabel> labels;                     // over the rows of `current`
    int active_label = -1;
    std::vector<View> views;
};

/// Calls visit(address, bytes) for every array the state holds. Arrays that states share have one address.
template <class F> void visit_arrays(const DocumentState& state, F&& visit) {
    for (const GaussianSet* set : {&state.base, &state.current}) {
        const GaussianBuffers arrays = set->buffers();
        for (const auto* array :
             {&arrays.position, &arrays.log_scale, &arrays.rotation, &arrays.opacity_logit, &arrays.sh})
            visit(static_cast<const void*>(array->get()), (*array)->size() * sizeof(float));
    }
    const auto visit_vector = [&](const auto& array) {
        if (array != nullptr)
            visit(static_cast<const void*>(array.get()), array->size() * sizeof(array->front()));
    };
    visit_vector(state.row_ids);
    for (const ExtraColumn& column : state.extra) visit_vector(column.values);
    for (const EditNode& edit : state.stack) {
        if (edit.delta != nullptr) visit(static_cast<const void*>(edit.delta.get()), edit.delta->byte_size());
        if (edit.thumbnail != nullptr)
            visit(static_cast<const void*>(edit.thumbnail.get()),
                  edit.thumbnail->data.size() * sizeof(float));
    }
    for (const NamedLabel& label : state.labels) {
        visit_vector(label.weight);
        visit_vector(label.manual);
        visit_vector(label.bits);
        if (label.found != nullptr)
            visit(static_cast<const void*>(label.found.get()),
                  label.found->field.probability.size() * (sizeof(float) + sizeof(double)));
        if (label.absent != nullptr)
            visit(static_cast<const void*>(label.absent.get()),
                  label.absent->ids.size() * (sizeof(RowId) + sizeof(float) + 1));
    }
}

/// State of a freshly loaded scene. Labels that the file carried become named labels.
DocumentState initial_state(const Scene& scene, std::vector<View> views);

/// Columns of the scene's file for the rows of `current`. Rows that edits added get zeros.
ExtraColumns current_columns(const DocumentState& state);

/// Identity for an edit to be pushed on this stack.
std::uint64_t next_edit_id(const DocumentState& state);

/// State with `current`, `row_ids` and the labels recomputed for another stack. Labels follow their rows.
DocumentState with_stack(const DocumentState& state, std::vector<EditNode> stack);

/// Undo and redo over named states, bounded by entries and bytes. Arrays shared with a neighbour count once.
/// When bytes run out, states away from the current one first give up their `current`, which base and stack
/// give again bit for bit. Then the oldest are forgotten.
class Document {
public:
    struct Limits {
        std::size_t entries = 100;
        std::size_t bytes = std::size_t{512} << 20;
    };
    Document() = default;
    explicit Document(DocumentState state);
    Document(DocumentState state, Limits limits);

    const DocumentState& state() const { return states_[position_].state; }
    bool empty() const { return states_.empty(); }
    /// Makes `state` the current one under `name`. States that could be redone are dropped. Consecutive steps
    /// of equal non-empty `merge_key` (a slider being dragged, a brush stroke) become one.
    void apply(std::string name, DocumentState state, const std::string& merge_key = {});
    bool can_undo() const { return position_ > 0; }
    bool can_redo() const { return position_ + 1 < states_.size(); }
    void undo();
    void redo();
    /// Names from the oldest. names()[position()] led to the current state.
    std::vector<std::string> names() const;
    std::size_t position() const { return position_; }
    /// State that undo or redo leads to, whole. The document stays at its place.
    DocumentState state_at(std::size_t position) const;
    /// Number of a state, see revision(). Positions move when the oldest states are forgotten.
    std::uint64_t revision_at(std::size_t position) const;
    void go_to(std::size_t position);
    /// Bytes held by undo and redo beyond the current state.
    std::size_t undo_bytes() const;
    /// Number of the current state, new for every applied one. Work is unsaved when it differs from the
    /// number at the last save. Undo back to the saved state restores the number.
    std::uint64_t revision() const { return revision_; }
    /// True when the step with that number is not undone: it led to the current state, or to one before it.
    /// Steps older than all that are kept count as done.
    bool includes(std::uint64_t revision) const;

private:
    struct Step {
        std::string name, merge_key;
        DocumentState state;
        std::uint64_t revision = 0;
        bool thin = false;  // `current` and `row_ids` are given up until the state is current again
    };
    void trim();
    std::vector<Step> states_;
    std::size_t position_ = 0;
    std::uint64_t revision_ = 0, next_revision_ = 1;
    Limits limits_;
};

}  // namespace gse
