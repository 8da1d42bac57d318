// Colours, stripes, rims.
#include "engine/laboratory/bench/inconsistent_server.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "engine/base/content_hash.h"
#include "engine/base/error.h"
#include "engine/localize/clusters.h"

namespace gse::bench {
namespace {

using Colour = std::array<double, 3>;

constexpr double Hue = 220;     // degrees, of what is painted without error
constexpr double NearHue = 75;  // degrees from it: what counts as painted
constexpr double LeastChroma = 0.15;
constexpr double Gain = 1.5;           // of the light
constexpr double FollowedShare = 0.2;  // of the error that is left where the server follows something painted
constexpr double Stripe = 9;           // px
constexpr double SmallHole = 0.25;     // of the picture: a smaller mask may be continued from around it
constexpr double Ring = 6;             // px around a mask that is looked at

Colour colour_of(double hue) {
    const auto channel = [hue](double shift) {
        const double place = std::fmod(hue + shift + 360, 360.0) / 60;
        return 0.15 + 0.85 * std::clamp(std::abs(place - 3) - 1, 0.0, 1.0);
    };
    return {channel(0), channel(240), channel(120)};
}

/// Hue in degrees and chroma of a pixel.
std::pair<double, double> hue_of(const Image& picture, std::size_t pixel) {
    const double r = picture.data[pixel * 3], g = picture.data[pixel * 3 + 1],
                 b = picture.data[pixel * 3 + 2];
    const double most = std::max({r, g, b}), chroma = most - std::min({r, g, b});
    if (chroma <= 0) return {0, 0};
    const double place = most == r   ? std::fmod((g - b) / chroma + 6, 6.0)
                         : most == g ? (b - r) / chroma + 2
                                     : (r - g) / chroma + 4;
    return {60 * place, chroma};
}

/// Mean hue of painted pixels, of those that `counts` names; nothing where hardly any is.
template <class F> std::optional<double> painted_hue(const Image& picture, F&& counts) {
    double sum = 0, pixels = 0, all = 0;
    for (std::size_t i = 0; i < picture.pixel_count(); ++i) {
        if (!counts(i)) continue;
        all += 1;
        const auto [hue, chroma] = hue_of(picture, i);
        if (chroma < LeastChroma || std::abs(hue - Hue) > NearHue) continue;
        sum += hue, pixels += 1;
    }
    if (pixels < 0.02 * all || pixels < 16) return std::nullopt;
    return sum / pixels;
}

Mask mask_of(const Image& image, const Image& picture) {
    Mask mask(picture.width, picture.height, image.data.empty() ? 1 : 0);
    for (std::size_t i = 0; i < image.data.size(); ++i) mask.data[i] = image.data[i] > 0.5f ? 1 : 0;
    return mask;
}

}  // namespace

InconsistentServer::InconsistentServer(const Inconsistency& amounts, std::string model)
    : amounts_(amounts), model_(std::move(model)) {}

remote::ServerFacts InconsistentServer::probe(const JobControl&) {
    remote::ServerFacts facts;
    facts.kind = remote::ServerKind::Comfy;
    facts.product = "inconsistent";
    facts.model = model_;
    facts.references = 2;
    return facts;
}

/// The colour for a picture: near to what is painted in a reference or around the mask, else at random.
Colour InconsistentServer::colour_for(const remote::RedrawOrder& order, Random& random) const {
    const double error = random.uniform(-amounts_.hue, amounts_.hue);
    std::optional<double> followed;
    if (!order.references.empty())
        followed = painted_hue(order.references.back(), [](std::size_t) { return true; });
    const Mask mask = mask_of(order.mask, order.picture);
    if (!followed && static_cast<double>(mask.count()) < SmallHole * static_cast<double>(mask.data.size())) {
        const Mask grown = localize::dilate(mask, Ring);
        followed = painted_hue(order.picture,
                               [&](std::size_t i) { return grown.data[i] != 0 && mask.data[i] == 0; });
    }
    return colour_of(followed ? *followed + FollowedShare * error : Hue + error);
}

remote::RedrawnPicture InconsistentServer::redraw(const remote::RedrawOrder& order, const JobControl& job) {
    if (job.stop_requested()) throw Error(ErrorCode::Cancelled, "drawing was stopped");
    ContentHash hash;
    hash.image(order.picture);
    hash.numbers(order.seed);
    Random random(hash.key().low);
    const auto colour = colour_for(order, random);
    const double phase = random.uniform(0, 2 * std::numbers::pi);
    const Mask mask =
        localize::dilate(mask_of(order.mask, order.picture), -random.uniform(0, amounts_.outline));
    Image drawn = order.picture;
    for (int y = 0; y < drawn.height; ++y)
        for (int x = 0; x < drawn.width; ++x) {
            const double light =
                (order.picture.at(x, y, 0) + order.picture.at(x, y, 1) + order.picture.at(x, y, 2)) / 3.0;
            const double stripe =
                1 + amounts_.texture * std::sin(2 * std::numbers::pi * (x + y) / Stripe + phase);
            for (int c = 0; c < 3; ++c) {
                double value = drawn.at(x, y, c);
                if (mask.at(x, y) != 0) {
                    const double painted = Gain * light * colour[static_cast<std::size_t>(c)] * stripe;
                    value += order.strength * (painted - value);
                }
                value += amounts_.noise * random.normal();
                drawn.at(x, y, c) = static_cast<float>(std::clamp(value, 0.0, 1.0));
            }
        }
    return {std::move(drawn), model_};
}

Image painted_truth(const Image& picture) {
    const auto colour = colour_of(Hue);
    Image truth = picture;
    for (std::size_t i = 0; i < truth.data.size(); i += 3) {
        const double light = (picture.data[i] + picture.data[i + 1] + picture.data[i + 2]) / 3.0;
        for (std::size_t c = 0; c < 3; ++c)
            truth.data[i + c] = static_cast<float>(std::clamp(Gain * light * colour[c], 0.0, 1.0));
    }
    return truth;
}

}  // namespace gse::bench
