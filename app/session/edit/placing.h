// A labelled thing that is moved, turned, resized or copied by hand: one edit of the stack while it changes.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "engine/edit/placement/rearrangement.h"
#include "engine/heal/heal.h"
#include "engine/scene/document.h"
#include "ui/model/view_model.h"

namespace gse::app {

class Placing {
public:
    /// Thing of a label in a state. `front`: the world direction in which its front looks.
    Placing(DocumentState before, std::shared_ptr<const std::vector<std::uint8_t>> rows, const Vec3& front);

    const DocumentState& before() const { return before_; }
    const std::vector<std::uint8_t>& rows() const { return *rows_; }
    /// True for the thing of this label in this state.
    bool is_of(const DocumentState& state,
               const std::shared_ptr<const std::vector<std::uint8_t>>& rows) const;
    /// False where nothing of the label can be seen.
    bool found() const { return thing_.found(); }
    /// True for a thing from another scene that was put in: it stands over no hole, and has no shadow yet.
    bool put_in() const { return put_in_; }
    /// Place and size before the change, for the handles in the viewport.
    ui::PlacedThing shown() const;
    /// The state with an edit of that identity on top of the stack. `shadow`: of the thing where it stood,
    /// which goes along on the ground; null = it stays. Throws Error (InvalidArgument).
    DocumentState placed(const edit::RearrangeSettings& settings, std::uint64_t id,
                         const heal::Shadow* shadow = nullptr) const;
    /// Rows of the ground in the light that the placed thing leaves them.
    GaussianData in_its_shadow(const GaussianData& ground, const edit::RearrangeSettings& settings,
                               const heal::Shadow& shadow) const;

private:
    edit::Rearrangement places(const edit::RearrangeSettings& settings) const;
    bool shadow_leaves(const edit::Rearrangement& places) const;
    std::vector<Affine> shadow_maps(const edit::Rearrangement& places) const;

    DocumentState before_;
    std::shared_ptr<const std::vector<std::uint8_t>> rows_;  // [current of before_]
    edit::ThingFrame thing_;
    bool put_in_ = false;
    mutable std::vector<Vec3> others_;  // of copies, once one was asked for
};

/// "Place: right 0.30, turn 45, size 1.2".
std::string placing_text(const edit::RearrangeSettings& settings);

}  // namespace gse::app
