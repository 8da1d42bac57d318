// Counts, words, and a stop that only a round with enough views takes.
#include "engine/remote/drawing/partial_round.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "engine/base/printable.h"

namespace gse::remote {

bool is_enough(std::size_t drawn, std::size_t wanted) {
    return drawn >= LeastDrawn && static_cast<double>(drawn) >= LeastDrawnShare * static_cast<double>(wanted);
}

std::string partial_text(const PartialRound& round) {
    std::vector<std::string> names;
    for (const auto& name : round.missing) names.push_back(printable(name));
    const auto drawn = fmt::format("{} of {} views are drawn", round.drawn, round.wanted);
    if (names.empty()) return drawn;
    return fmt::format("{}; missing: {}", drawn, fmt::join(names, ", "));
}

bool DrawingStop::request() {
    auto source = offered_.take();
    return source && source->request_stop();
}

}  // namespace gse::remote
