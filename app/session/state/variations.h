// Other results of applied edits, to be exchanged for what was applied.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "app/session/state/waiting_results.h"
#include "engine/scene/stack_edits.h"

namespace gse::app {

/// Variations of the edits of one document, the newest last. Its project keeps them.
class KeptVariations {
public:
    static constexpr std::size_t MostBytes = std::size_t{1}
                                             << 30;  // of splats; the oldest are dropped beyond
    static constexpr std::size_t MostStored = std::size_t{256} << 20;  // the same, in a project, unpacked

    /// Keeps the results beside the applied one, which is `node`. `before`: the state that they are results
    /// of. One result alone has no variations.
    void keep(const WaitingResults& results, const EditNode& node, const DocumentState& before);
    const EditVariations* of(std::uint64_t edit) const;
    const std::vector<EditVariations>& all() const { return all_; }
    /// Those that a project of this stack holds: of its edits, the newest within MostStored bytes.
    std::vector<EditVariations> stored(const std::vector<EditNode>& stack) const;
    /// Takes those of a project that was opened.
    void take(std::vector<EditVariations> stored) { all_ = std::move(stored); }
    void forget() { all_.clear(); }

private:
    std::vector<EditVariations> all_;
};

/// The state with another variation of an edit of its stack. Switch and strength stay. Labels that hold what
/// the edit added hold what the other one adds.
DocumentState with_variation(const DocumentState& state, const EditNode& variation);

}  // namespace gse::app
