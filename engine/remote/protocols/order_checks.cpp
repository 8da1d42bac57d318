// Checks of an order.
#include "engine/remote/protocols/order_checks.h"

#include <algorithm>

#include <fmt/format.h>

#include "engine/base/error.h"

namespace gse::remote {
namespace {

constexpr int LatentStep = 16, LongestSide = 4096;
constexpr std::uint32_t SeedEnd = std::uint32_t{1} << 31;
constexpr std::size_t MostAnswerBytes = std::size_t{64} << 20;
constexpr std::size_t BytesPerPixel = 4, MostTimesLarger = 4;

Error bad_order(const std::string& why, const std::string& hint) {
    return {ErrorCode::InvalidArgument, why, hint};
}

void check_sizes(const RedrawOrder& order) {
    const auto& picture = order.picture;
    const int step = order.side_step;
    if (step < LatentStep || step % LatentStep != 0)
        throw bad_order(fmt::format("sides in steps of {} cannot be drawn", step), "take a multiple of 16");
    const auto fits = [&](int side) { return side > 0 && side <= LongestSide && side % step == 0; };
    if (picture.channels != 3 || !fits(picture.width) || !fits(picture.height))
        throw bad_order(fmt::format("a picture of {} x {} cannot be redrawn", picture.width, picture.height),
                        fmt::format("take sides that are multiples of {}, up to 4096", step));
    const auto& mask = order.mask;
    if (!mask.data.empty() &&
        (mask.channels != 1 || mask.width != picture.width || mask.height != picture.height))
        throw bad_order("the mask has another size than its picture", "give both one size");
    for (const auto& reference : order.references)
        if (reference.channels != 3 || !reference.pixel_count() || reference.width > LongestSide ||
            reference.height > LongestSide)
            throw bad_order("a reference is no colour picture of up to 4096 pixels a side",
                            "take another one");
}

}  // namespace

void check_order(const RedrawOrder& order, const ServerFacts& facts) {
    check_sizes(order);
    if (order.prompt.find_first_not_of(" \t\n") == std::string::npos)
        throw bad_order("a server draws nothing without a sentence", "say what shall be drawn");
    if (!(order.strength > 0 && order.strength <= 1))
        throw bad_order(fmt::format("a strength of {} is not between 0 and 1", order.strength),
                        "take one above 0, and at most 1");
    if (order.steps < 1 || order.steps > 1000)
        throw bad_order(fmt::format("{} steps cannot be drawn", order.steps), "take 1 to 1000");
    if (order.seed >= SeedEnd) throw bad_order("the seed is too large for servers", "take one below 2^31");
    if (order.references.size() > facts.references)
        throw bad_order(
            fmt::format("the server takes {} references, not {}", facts.references, order.references.size()),
            "give fewer");
}

bool leaves_nothing(const RedrawOrder& order) {
    const auto& mask = order.mask.data;
    return !mask.empty() && std::none_of(mask.begin(), mask.end(), [](float value) { return value > 0.5f; });
}

std::size_t picture_answer_bytes(const RedrawOrder& order, std::size_t echoed) {
    const std::size_t picture = order.picture.pixel_count() * BytesPerPixel;
    const std::size_t bytes = (picture * MostTimesLarger + echoed * picture) / 3 * 4 + (std::size_t{1} << 20);
    return std::min(bytes, MostAnswerBytes);
}

}  // namespace gse::remote
