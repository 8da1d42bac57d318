// Things that are put in, placed by hand, or deleted with their hole healed.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/session/edit/placing.h"
#include "app/session/state/workspace.h"
#include "app/session/view_controller.h"
#include "engine/heal/heal.h"

namespace gse::app {

class PlaceController {
public:
    PlaceController(Workspace& workspace, ViewController& view) : workspace_(workspace), view_(view) {}

    void run(const ui::PlaceCommand& command);
    /// Follows the label whose thing is placed. Once per frame.
    void refresh();
    void show(ui::PlacePart& model) const;

private:
    /// Placement that is the last step, while more of it changes it.
    struct Step {
        std::uint64_t revision = 0, id = 0;  // of the step, and of its edit
        edit::RearrangeSettings settings = {};
        double shadow_at = 0;  // of wall_seconds(), from which on the shadow goes along; Never = it has
    };
    static constexpr double Never = std::numeric_limits<double>::infinity();
    /// The thing healed away, with its shadow, as a thread measures it once.
    struct Measured {
        heal::Healed healed;
        bool done = false;
    };
    template <class C> void on(const C& command);
    const DocumentState& state() const { return workspace_.document.state(); }
    /// False, and said, while the stack cannot be changed.
    bool free_stack();
    /// The labelled rows; null, and said, where there are none or the stack cannot be changed.
    const NamedLabel* labelled();
    Vec3 front() const;
    void place(const edit::RearrangeSettings& settings, const heal::Shadow* shadow);
    void measure_shadow();
    void take_shadow_along();
    /// The shadow, where it is measured; else null.
    const heal::Shadow* known_shadow() const;
    void heal(const DocumentState& from, std::shared_ptr<const std::vector<std::uint8_t>> rows, bool stays);
    void start_healing(const std::string& title, const DocumentState& from,
                       std::shared_ptr<const std::vector<std::uint8_t>> rows, bool stays,
                       std::function<heal::Healed(const JobControl&)> healing);
    /// `stays`: rows that are not deleted; null = none.
    void take_healed(const std::string& title, const DocumentState& from, const heal::Healed& healed,
                     const std::shared_ptr<const std::vector<std::uint8_t>>& stays);
    void take_healed_place(const heal::Healed& healed);

    Workspace& workspace_;
    ViewController& view_;
    bool used_ = false;  // the artist places the labelled thing
    std::optional<Placing> thing_;
    std::optional<Step> step_;
    std::shared_ptr<Measured> measured_;  // of thing_; null until it is wanted
};

}  // namespace gse::app
