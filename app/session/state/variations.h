// Other results of applied edits, to be exchanged for what was applied.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "app/session/state/waiting_results.h"
#include "engine/scene/document.h"

namespace gse::app {

/// Results of one edit as edits of the stack, each with the identity of that edit.
struct Variations {
    std::uint64_t edit = 0;       // identity on the stack
    std::vector<EditNode> nodes;  // in the order in which they were made
    std::vector<std::uint64_t> seeds;

    /// Index of the one that the stack holds; none = another one, or the edit is not on the stack.
    std::optional<std::size_t> applied(const std::vector<EditNode>& stack) const;
};

/// Variations of the edits of one document, the newest last. Lost when the document is closed.
class KeptVariations {
public:
    static constexpr std::size_t MostBytes = std::size_t{1}
                                             << 30;  // of splats; the oldest are dropped beyond

    /// Keeps the results beside the applied one, which is `node`. `before`: the state that they are results
    /// of. One result alone has no variations.
    void keep(const WaitingResults& results, const EditNode& node, const DocumentState& before);
    const Variations* of(std::uint64_t edit) const;
    const std::vector<Variations>& all() const { return all_; }
    void forget() { all_.clear(); }

private:
    std::vector<Variations> all_;
};

/// The state with another variation of an edit of its stack. Switch and strength stay. Labels that hold what
/// the edit added hold what the other one adds.
DocumentState with_variation(const DocumentState& state, const EditNode& variation);

}  // namespace gse::app
