// Random Gaussian sets with awkward values, and edits of them, for the tests of deltas, documents and project
// files.
#pragma once

#include <fmt/core.h>

#include <cstring>
#include <limits>
#include <span>
#include <vector>

#include "engine/base/random.h"
#include "engine/scene/document.h"

namespace gse::test {

/// Mostly ordinary numbers; some NaN, infinite, denormal and negative zero, whose bits must survive.
inline float awkward(Random& random) {
    switch (random.below(40)) {
        case 0: return std::numeric_limits<float>::quiet_NaN();
        case 1: return -std::numeric_limits<float>::infinity();
        case 2: return -0.0f;
        case 3: return std::numeric_limits<float>::denorm_min();
        default: return static_cast<float>(random.normal());
    }
}

inline void fill(std::vector<float>& values, Random& random) {
    for (float& value : values) value = awkward(random);
}

inline GaussianData random_data(std::size_t count, int degree, std::uint64_t seed) {
    Random random(seed);
    GaussianData data;
    data.sh_degree = degree;
    data.resize(count);
    for (auto* column : {&data.position, &data.log_scale, &data.rotation, &data.opacity_logit, &data.sh})
        fill(*column, random);
    return data;
}

inline GaussianSet random_set(std::size_t count, int degree, std::uint64_t seed) {
    return GaussianSet(random_data(count, degree, seed));
}

inline bool bits_equal(std::span<const float> a, std::span<const float> b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
}

inline bool bits_equal(const GaussianSet& a, const GaussianSet& b) {
    return a.sh_degree() == b.sh_degree() && bits_equal(a.position(), b.position()) &&
           bits_equal(a.log_scale(), b.log_scale()) && bits_equal(a.rotation(), b.rotation()) &&
           bits_equal(a.opacity_logit(), b.opacity_logit()) && bits_equal(a.sh(), b.sh());
}

/// Result of an edit of a set: rows kept in order, some of them changed, new ones at the end.
struct RandomEdit {
    GaussianSet after;
    std::vector<std::int64_t> base_to_new;
    std::vector<std::uint8_t> untouched;  // [before] stays bit for bit
};

inline RandomEdit random_edit(const GaussianSet& before, std::uint64_t seed, bool keep_all = false) {
    Random random(seed);
    const GaussianData old = before.to_data();
    GaussianData data;
    data.sh_degree = old.sh_degree;
    RandomEdit edit;
    for (std::size_t row = 0; row < before.size(); ++row) {
        const auto fate = random.below(10);
        edit.untouched.push_back(fate > 2 ? 1 : 0);
        if (fate == 0 && !keep_all) {
            edit.base_to_new.push_back(-1);
            continue;
        }
        edit.base_to_new.push_back(static_cast<std::int64_t>(data.size()));
        data.append_row(old, row);
        if (fate <= 2) data.position[(data.size() - 1) * 3 + random.below(3)] = awkward(random);
        if (fate == 2) data.sh.back() = awkward(random);
    }
    if (!keep_all) {
        const GaussianData fresh = random_data(random.below(20), old.sh_degree, random.next());
        for (std::size_t row = 0; row < fresh.size(); ++row) data.append_row(fresh, row);
    }
    edit.after = GaussianSet(std::move(data));
    return edit;
}

/// An edit node over the current state.
inline EditNode random_node(const DocumentState& state, std::uint64_t seed) {
    const RandomEdit edit = random_edit(state.current, seed);
    EditNode node;
    node.id = next_edit_id(state);
    node.name = fmt::format("edit {}", node.id);
    node.delta = std::make_shared<const SceneDelta>(
        make_delta(state.current, *state.row_ids, edit.after, edit.base_to_new, node.id));
    return node;
}

inline DocumentState with_edit(const DocumentState& state, EditNode node) {
    auto stack = state.stack;
    stack.push_back(std::move(node));
    return with_stack(state, std::move(stack));
}

inline NamedLabel random_label(const DocumentState& state, std::uint64_t seed) {
    Random random(seed);
    std::vector<float> weight(state.current.size());
    std::vector<std::int8_t> manual(state.current.size());
    for (std::size_t row = 0; row < weight.size(); ++row) {
        weight[row] = static_cast<float>(random.uniform());
        manual[row] = static_cast<std::int8_t>(static_cast<int>(random.below(3)) - 1);
    }
    NamedLabel label;
    label.name = fmt::format("label {}", seed);
    label.threshold = static_cast<float>(random.uniform());
    label.weight = std::make_shared<const std::vector<float>>(std::move(weight));
    label.manual = std::make_shared<const std::vector<std::int8_t>>(std::move(manual));
    return with_bits(std::move(label));
}

template <class T>
bool same_array(const std::shared_ptr<const std::vector<T>>& a,
                const std::shared_ptr<const std::vector<T>>& b) {
    if (a == nullptr || b == nullptr) return a == b;
    return a->size() == b->size() &&
           (a->empty() || std::memcmp(a->data(), b->data(), a->size() * sizeof(T)) == 0);
}

}  // namespace gse::test
