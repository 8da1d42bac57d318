// A round that ended before all of its views were drawn: the choice to fit the scene to those that are there.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/mailbox.h"

namespace gse::remote {

/// Least part of a round that a scene may be fitted to.
inline constexpr double LeastDrawnShare = 0.6;
inline constexpr std::size_t LeastDrawn = 4;  // views

/// True where so many of the wanted views are enough to fit the scene to.
bool is_enough(std::size_t drawn, std::size_t wanted);

/// Views of a round that ended early.
struct PartialRound {
    std::size_t drawn = 0, wanted = 0;
    std::vector<std::string> missing = {};  // names of those that were not drawn
    std::string reason = {};                // a sentence with a remedy; empty = the artist ended the drawing
};

/// Words for people: "6 of 8 views are drawn; ring_06 and ring_07 are missing".
std::string partial_text(const PartialRound& round);

/// Ends a drawing from another thread, so that the views that are there can be used.
class DrawingStop {
public:
    /// Ends the drawing that is under way. False where no drawing with enough views is, and where it was
    /// ended before.
    bool request();

    // For the round that draws:
    /// Enough views are there: the drawing may be ended by `source`.
    void offer(std::stop_source source) { offered_.put(std::move(source)); }
    /// The drawing is over. False where request() came first.
    bool withdraw() { return offered_.take().has_value(); }

private:
    Mailbox<std::stop_source> offered_;
};

/// Use of rounds that end early.
struct PartialRounds {
    /// Answers whether the scene is fitted to what is there; may wait for the artist. Empty = it is not.
    std::function<bool(const PartialRound&)> fits = {};
    std::shared_ptr<DrawingStop> stop = {};  // null = a round is ended with its job alone
};

}  // namespace gse::remote
