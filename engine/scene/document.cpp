// The document: stack of edits over a base, labels that follow their rows, undo bounded in memory.
#include "engine/scene/document.h"

#include <algorithm>
#include <numeric>
#include <unordered_map>

#include "engine/base/check.h"
#include "engine/base/error.h"
#include "engine/scene/strength.h"

namespace gse {
namespace {

constexpr float LoadedThreshold = 0.5f;  // labels of files are weights in [0,1] or bits
constexpr std::uint32_t NoRow = ~std::uint32_t{0};

using SharedIds = std::shared_ptr<const std::vector<RowId>>;

SharedIds base_ids(std::size_t count) {
    std::vector<RowId> ids(count);
    std::iota(ids.begin(), ids.end(), RowId{0});
    return std::make_shared<const std::vector<RowId>>(std::move(ids));
}

/// Delta of an edit of the stack, at its strength.
struct Change {
    const SceneDelta* delta = nullptr;
    double strength = 1;
    bool operator==(const Change&) const = default;
};

std::vector<Change> enabled_changes(const std::vector<EditNode>& stack) {
    std::vector<Change> changes;
    for (const EditNode& edit : stack)
        if (edit.enabled && edit.delta != nullptr) changes.push_back({edit.delta.get(), edit.strength});
    return changes;
}

/// Applies edits one after the other. Neighbours at full strength are applied at once.
std::pair<GaussianSet, std::vector<RowId>> apply_changes(const GaussianSet& set, std::span<const RowId> ids,
                                                         std::span<const Change> changes) {
    std::pair<GaussianSet, std::vector<RowId>> now{set, {ids.begin(), ids.end()}};
    std::vector<const SceneDelta*> whole;
    const auto apply_whole = [&] {
        if (!whole.empty()) now = apply_deltas(now.first, now.second, whole);
        whole.clear();
    };
    for (const Change& change : changes) {
        if (change.strength == 1) {
            whole.push_back(change.delta);
            continue;
        }
        apply_whole();
        now = apply_delta(now.first, now.second,
                          with_strength(now.first, now.second, *change.delta, change.strength));
    }
    apply_whole();
    return now;
}

/// Sets `current` and `row_ids` of `state` from its base and stack. `near` is a whole state. If its stack
/// begins alike over the same base, work starts from its result.
void rebuild_rows(DocumentState& state, const DocumentState& near) {
    const auto wanted = enabled_changes(state.stack);
    const auto done = enabled_changes(near.stack);
    const bool ahead = near.row_ids != nullptr && state.base.shares_all_with(near.base) &&
                       done.size() <= wanted.size() && std::equal(done.begin(), done.end(), wanted.begin());
    const GaussianSet start = ahead ? near.current : state.base;
    const SharedIds start_ids = ahead ? near.row_ids : base_ids(state.base.size());
    const std::span<const Change> rest = std::span(wanted).subspan(ahead ? done.size() : 0);
    if (rest.empty()) {
        state.current = start;
        state.row_ids = start_ids;
        return;
    }
    auto [set, ids] = apply_changes(start, *start_ids, rest);
    state.current = std::move(set);
    state.row_ids =
        ids == *start_ids ? start_ids : std::make_shared<const std::vector<RowId>>(std::move(ids));
}

/// Old row of equal identity for every new row, or NoRow.
std::vector<std::uint32_t> old_rows(std::span<const RowId> old_ids, std::span<const RowId> new_ids) {
    std::vector<std::uint32_t> rows(new_ids.size(), NoRow);
    std::size_t begin = 0;
    while (begin < new_ids.size()) {  // locate_rows wants ascending identities: one call for each stretch
        std::size_t end = begin + 1;
        while (end < new_ids.size() && new_ids[end] > new_ids[end - 1]) ++end;
        locate_rows(old_ids, new_ids.subspan(begin, end - begin), [&](std::size_t row, std::size_t k) {
            rows[begin + k] = static_cast<std::uint32_t>(row);
        });
        begin = end;
    }
    return rows;
}

/// Values that a row of a label holds.
struct LabelValue {
    RowId id = 0;
    float weight = 0;
    std::int8_t manual = 0;
};

LabelValue value_at(const NamedLabel& label, RowId id, std::size_t row) {
    return {id, label.weight != nullptr ? (*label.weight)[row] : 0.0f,
            label.manual != nullptr ? (*label.manual)[row] : std::int8_t{0}};
}

/// Follows labels from the rows of one state to those of another.
class LabelMover {
public:
    LabelMover(const DocumentState& before, const DocumentState& after)
        : before_ids_(*before.row_ids), after_ids_(*after.row_ids), from_(old_rows(before_ids_, after_ids_)) {
        std::vector<std::uint8_t> goes_on(before_ids_.size(), 0);
        for (std::size_t row = 0; row < from_.size(); ++row) {
            if (from_[row] != NoRow) goes_on[from_[row]] = 1;
            else arrived_.emplace_back(after_ids_[row], row);
        }
        for (std::size_t row = 0; row < goes_on.size(); ++row)
            if (goes_on[row] == 0) leaving_.push_back(row);
        std::sort(arrived_.begin(), arrived_.end());
        for (const EditNode& edit : after.stack) edits_.push_back(edit.id);
        std::sort(edits_.begin(), edits_.end());
    }

    NamedLabel move(NamedLabel label) const {
        std::vector<LabelValue> absent = outside(label);
        std::vector<float> weight;
        std::vector<std::int8_t> manual;
        if (label.weight != nullptr) weight = follow(*label.weight);
        if (label.manual != nullptr) manual = follow(*label.manual);
        std::erase_if(absent, [&](const LabelValue& value) {
            const auto found =
                std::lower_bound(arrived_.begin(), arrived_.end(), std::pair{value.id, std::size_t{0}});
            if (found == arrived_.end() || found->first != value.id) return !may_return(value.id);
            weight.resize(after_ids_.size());
            manual.resize(after_ids_.size());
            weight[found->second] = value.weight;
            manual[found->second] = value.manual;
            return true;
        });
        label.weight = weight.empty() && label.weight == nullptr
                           ? nullptr
                           : std::make_shared<const std::vector<float>>(std::move(weight));
        if (label.manual != nullptr || !manual.empty())
            label.manual = std::make_shared<const std::vector<std::int8_t>>(std::move(manual));
        label.absent = pack(absent);
        label.found = nullptr;
        label.bits = nullptr;
        return with_bits(std::move(label));
    }

private:
    template <class T> std::vector<T> follow(const std::vector<T>& values) const {
        std::vector<T> result(from_.size(), T{0});
        for (std::size_t row = 0; row < from_.size(); ++row)
            if (from_[row] != NoRow) result[row] = values[from_[row]];
        return result;
    }

    /// Values of rows that were absent or are leaving, by ascending identity.
    std::vector<LabelValue> outside(const NamedLabel& label) const {
        std::vector<LabelValue> values;
        if (label.absent != nullptr)
            for (std::size_t i = 0; i < label.absent->ids.size(); ++i)
                values.push_back({label.absent->ids[i], label.absent->weight[i], label.absent->manual[i]});
        for (const std::size_t row : leaving_) {
            const LabelValue value = value_at(label, before_ids_[row], row);
            if (value.weight != 0 || value.manual != 0) values.push_back(value);
        }
        std::sort(values.begin(), values.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
        return values;
    }

    bool may_return(RowId id) const {
        const std::uint64_t edit = id >> EditIdShift;
        return edit == 0 || std::binary_search(edits_.begin(), edits_.end(), edit);
    }

    static std::shared_ptr<const AbsentRows> pack(const std::vector<LabelValue>& values) {
        if (values.empty()) return nullptr;
        AbsentRows rows;
        for (const LabelValue& value : values) {
            rows.ids.push_back(value.id);
            rows.weight.push_back(value.weight);
            rows.manual.push_back(value.manual);
        }
        return std::make_shared<const AbsentRows>(std::move(rows));
    }

    std::span<const RowId> before_ids_, after_ids_;
    std::vector<std::uint32_t> from_;                     // [after] row before, or NoRow
    std::vector<std::pair<RowId, std::size_t>> arrived_;  // identity and row after, ascending
    std::vector<std::size_t> leaving_;                    // rows before
    std::vector<std::uint64_t> edits_;
};

/// Label of a file. Bits that its weights do not give under the threshold become corrections by hand.
NamedLabel named(const Label& label, std::size_t count) {
    NamedLabel result;
    result.name = label.name;
    result.threshold = LoadedThreshold;
    result.weight = label.weight;
    if (label.bits != nullptr) {
        GSE_CHECK_EQ(label.bits->size(), count);
        std::vector<std::int8_t> manual(count, 0);
        bool any = false;
        for (std::size_t row = 0; row < count; ++row) {
            const bool by_weight = label.weight != nullptr && (*label.weight)[row] > LoadedThreshold;
            if (by_weight == ((*label.bits)[row] != 0)) continue;
            manual[row] = by_weight ? std::int8_t{-1} : std::int8_t{1};
            any = true;
        }
        if (any || label.weight == nullptr)
            result.manual = std::make_shared<const std::vector<std::int8_t>>(std::move(manual));
    }
    return with_bits(std::move(result));
}

void check_whole(const DocumentState& state) {
    GSE_CHECK(state.row_ids != nullptr);
    GSE_CHECK_EQ(state.row_ids->size(), state.current.size());
    for (const NamedLabel& label : state.labels)
        if (label.bits != nullptr) GSE_CHECK_EQ(label.bits->size(), state.current.size());
}

/// Arrays that the steps hold, with the number of their uses.
class Ledger {
public:
    void add(const DocumentState& state) {
        visit_arrays(state, [&](const void* address, std::size_t bytes) {
            auto& entry = entries_[address];
            if (entry.uses++ == 0) total_ += entry.bytes = bytes;
        });
        total_ += unshared(state);
    }
    void release(const DocumentState& state) {
        visit_arrays(state, [&](const void* address, std::size_t) {
            auto& entry = entries_[address];
            if (--entry.uses == 0) total_ -= entry.bytes;
        });
        total_ -= unshared(state);
    }
    std::size_t total() const { return total_; }

private:
    struct Entry {
        std::size_t bytes = 0, uses = 0;
    };
    static std::size_t unshared(const DocumentState& state) {
        std::size_t bytes = sizeof(DocumentState) + state.views.size() * sizeof(View) +
                            state.stack.size() * sizeof(EditNode) + state.labels.size() * sizeof(NamedLabel);
        for (const EditNode& edit : state.stack) bytes += edit.name.size() + edit.recipe.size();
        return bytes;
    }
    std::unordered_map<const void*, Entry> entries_;
    std::size_t total_ = 0;
};

}  // namespace

NamedLabel with_bits(NamedLabel label) {
    const std::size_t count = label.weight != nullptr   ? label.weight->size()
                              : label.manual != nullptr ? label.manual->size()
                              : label.bits != nullptr   ? label.bits->size()
                                                        : 0;
    std::vector<std::uint8_t> bits(count, 0);
    if (label.weight != nullptr) {
        const float* weight = label.weight->data();
        for (std::size_t row = 0; row < count; ++row) bits[row] = weight[row] > label.threshold ? 1 : 0;
    }
    if (label.manual != nullptr) {
        GSE_CHECK_EQ(label.manual->size(), count);
        const std::int8_t* manual = label.manual->data();
        for (std::size_t row = 0; row < count; ++row)
            bits[row] = manual[row] != 0 ? static_cast<std::uint8_t>(manual[row] > 0) : bits[row];
    }
    label.bits = std::make_shared<const std::vector<std::uint8_t>>(std::move(bits));
    return label;
}

DocumentState initial_state(const Scene& scene, std::vector<View> views) {
    if (scene.gaussians.size() >= NoRow)
        throw Error(ErrorCode::Unsupported, "the scene has more than four thousand million splats",
                    "split it");
    DocumentState state;
    state.base = state.current = scene.gaussians;
    state.info = scene.info;
    state.extra = scene.extra;
    state.row_ids = base_ids(state.base.size());
    for (const Label& label : scene.labels.labels) state.labels.push_back(named(label, state.base.size()));
    state.active_label = state.labels.empty() ? -1 : 0;
    state.views = std::move(views);
    return state;
}

ExtraColumns current_columns(const DocumentState& state) {
    if (state.extra.empty() || state.current.shares_all_with(state.base)) return state.extra;
    std::vector<std::int64_t> sources;
    for (const RowId id : *state.row_ids)
        sources.push_back(id < state.base.size() ? static_cast<std::int64_t>(id) : -1);
    return gathered(state.extra, sources);
}

std::uint64_t next_edit_id(const DocumentState& state) {
    std::uint64_t last = 0;
    for (const EditNode& edit : state.stack) last = std::max(last, edit.id);
    return last + 1;
}

DocumentState with_stack(const DocumentState& state, std::vector<EditNode> stack) {
    DocumentState next = state;
    next.stack = std::move(stack);
    rebuild_rows(next, state);
    if (next.row_ids == state.row_ids || state.labels.empty()) return next;
    if (*next.row_ids == *state.row_ids) {
        next.row_ids = state.row_ids;
        return next;
    }
    const LabelMover mover(state, next);
    for (NamedLabel& label : next.labels) label = mover.move(std::move(label));
    return next;
}

Document::Document(DocumentState state) : Document(std::move(state), Limits{}) {}

Document::Document(DocumentState state, Limits limits) : limits_(limits) {
    check_whole(state);
    revision_ = next_revision_++;
    states_.push_back({"Open", {}, std::move(state), revision_, false});
}

void Document::apply(std::string name, DocumentState state, const std::string& merge_key) {
    GSE_CHECK(!states_.empty());
    check_whole(state);
    states_.resize(position_ + 1);
    revision_ = next_revision_++;
    Step step{std::move(name), merge_key, std::move(state), revision_, false};
    if (!merge_key.empty() && states_.back().merge_key == merge_key) {
        states_.back() = std::move(step);
    } else {
        states_.push_back(std::move(step));
        ++position_;
    }
    trim();
}

void Document::undo() {
    if (can_undo()) go_to(position_ - 1);
}

void Document::redo() {
    if (can_redo()) go_to(position_ + 1);
}

std::vector<std::string> Document::names() const {
    std::vector<std::string> names;
    for (const Step& step : states_) names.push_back(step.name);
    return names;
}

void Document::go_to(std::size_t position) {
    GSE_CHECK(position < states_.size());
    if (position == position_) return;
    Step& step = states_[position];
    if (step.thin) {
        rebuild_rows(step.state, states_[position_].state);
        check_whole(step.state);
        step.thin = false;
    }
    step.merge_key.clear();  // what follows is another stroke
    position_ = position;
    revision_ = step.revision;
    trim();
}

DocumentState Document::state_at(std::size_t position) const {
    GSE_CHECK(position < states_.size());
    DocumentState state = states_[position].state;
    if (states_[position].thin) rebuild_rows(state, states_[position_].state);
    return state;
}

std::uint64_t Document::revision_at(std::size_t position) const {
    GSE_CHECK(position < states_.size());
    return states_[position].revision;
}

bool Document::includes(std::uint64_t revision) const {
    if (states_.empty()) return false;
    const auto end = states_.begin() + static_cast<std::ptrdiff_t>(position_) + 1;
    return revision < states_.front().revision ||
           std::any_of(states_.begin(), end, [&](const Step& step) { return step.revision == revision; });
}

std::size_t Document::undo_bytes() const {
    Ledger all, current;
    for (const Step& step : states_) all.add(step.state);
    if (!states_.empty()) current.add(states_[position_].state);
    return all.total() - current.total();
}

void Document::trim() {
    const auto drop_one = [&] {  // the oldest, or what could be redone last
        if (position_ > 0) {
            states_.erase(states_.begin());
            --position_;
        } else {
            states_.pop_back();
        }
    };
    while (states_.size() > std::max<std::size_t>(limits_.entries, 1)) drop_one();
    Ledger all, current;
    for (const Step& step : states_) all.add(step.state);
    current.add(states_[position_].state);
    const auto over = [&] { return all.total() - current.total() > limits_.bytes; };
    const auto thin = [&](Step& step) {
        if (step.thin || !over() || step.state.current.shares_all_with(step.state.base)) return;
        all.release(step.state);
        step.state.current = GaussianSet();
        step.state.row_ids = nullptr;
        step.thin = true;
        all.add(step.state);
    };
    for (std::size_t i = 0; i < position_; ++i) thin(states_[i]);
    for (std::size_t i = states_.size(); i-- > position_ + 1;) thin(states_[i]);
    while (states_.size() > 1 && over()) {
        all.release(position_ > 0 ? states_.front().state : states_.back().state);
        drop_one();
    }
}

}  // namespace gse
