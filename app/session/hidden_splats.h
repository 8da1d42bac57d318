// Splats that the artist does not want to see at present; the document never changes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "app/session/state/workspace.h"
#include "engine/scene/gaussian_set.h"
#include "engine/scene/hidden_rows.h"

namespace gse::app {

class HiddenSplats {
public:
    explicit HiddenSplats(Workspace& workspace) : workspace_(workspace) {}

    bool any() const { return !rows_.empty(); }
    std::size_t count() const { return count_; }      // of the document's splats
    std::uint64_t number() const { return number_; }  // another one after each change
    /// 1 for each hidden row of the document.
    std::vector<std::uint8_t> of_document() const;
    /// 1 for each hidden one of rows with these identities.
    std::vector<std::uint8_t> of_rows(const std::vector<RowId>& ids) const { return rows_.rows(ids); }

    /// Hides what is labelled, or all else.
    void hide_label(bool others);
    void show_all();
    /// Rows have come or gone.
    void follow_document();

    /// The set without hidden splats, made by `hidden_of`. Its arrays stay as long as nothing changes, so
    /// that nothing is uploaded anew.
    template <class F> GaussianSet seen(const GaussianSet& set, F hidden_of) {
        if (rows_.empty()) return set;
        for (const auto& known : seen_)
            if (known.of.shares_all_with(set)) return known.set;
        if (seen_.size() >= Sides) seen_.pop_front();
        seen_.push_back({set, with_hidden(set, hidden_of(set))});
        return seen_.back().set;
    }

private:
    static constexpr std::size_t Sides = 2;  // of a comparison
    struct SeenSet {
        GaussianSet of, set;
    };
    void change();

    Workspace& workspace_;
    HiddenRows rows_;
    std::size_t count_ = 0;
    std::uint64_t number_ = 0;
    std::deque<SeenSet> seen_;  // the last ones, made for rows_ and the document's rows as they are
};

}  // namespace gse::app
