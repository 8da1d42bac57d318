// Size, place, surroundings, change: the first flaw counts.
#include "engine/remote/views/acceptance.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include <fmt/format.h>

#include "engine/base/check.h"

namespace gse::remote {
namespace {

constexpr double MostPsnr = 99;
constexpr double LeastOutside = 0.01;    // share of the pixels from which surroundings say something
constexpr double WorthMoving = 0.25;     // px: less is not worth the blur of resampling
constexpr double WorthMovingGain = 0.3;  // dB by which moving back must better the surroundings

/// Size that came, as the square that was asked for; empty where its aspect is another one.
Image at_asked_size(Image answer, int side, std::string& note) {
    if (answer.width == side && answer.height == side) return answer;
    if (answer.width < 1 || answer.height < 1) return {};
    const double aspect = static_cast<double>(answer.width) / answer.height;
    if (std::abs(aspect - 1) > SameAspect) return {};
    note = fmt::format("the server answered with {} x {} pixels in place of {} x {}", answer.width,
                       answer.height, side, side);
    return at_side(answer, side);
}

bool is_large(const Similarity& moved) {
    return std::hypot(moved.dx, moved.dy) > MostShift || std::abs(moved.scale - 1) > MostScale ||
           std::abs(moved.angle) > MostScale;
}

/// Slope of the light of every pixel, from differences of its neighbours.
std::vector<double> edges_of(const Image& picture) {
    const auto light = [&](int x, int y) {
        x = std::clamp(x, 0, picture.width - 1), y = std::clamp(y, 0, picture.height - 1);
        return picture.at(x, y, 0) + picture.at(x, y, 1) + picture.at(x, y, 2);
    };
    std::vector<double> edges;
    edges.reserve(picture.pixel_count());
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x)
            edges.push_back(std::hypot(light(x + 1, y) - light(x - 1, y), light(x, y + 1) - light(x, y - 1)));
    return edges;
}

/// Moves the picture back where that makes its surroundings alike.
void undo_drift(const ViewFrame& frame, CheckedPicture& checked) {
    const auto moved = register_pictures(frame.picture, checked.picture, frame.sent_mask);
    if (!moved) return;
    const int side = frame.picture.width;
    if (moved->reach() * side < WorthMoving) return;
    Image back = moved_back(checked.picture, *moved);
    const double psnr = psnr_outside(frame.picture, back, frame.sent_mask);
    if (psnr < checked.psnr + WorthMovingGain || psnr < LeastPsnr) return;
    checked.drift = moved->reach();
    checked.psnr = psnr;
    if (is_large(*moved)) {
        checked.flaw = Flaw::Moved;
        checked.note = fmt::format("the server moved the picture by {:.0f} pixels",
                                   std::max(1.0, moved->reach() * side));
        return;
    }
    checked.picture = std::move(back);
}

}  // namespace

bool is_square(const Image& picture) {
    return std::abs(picture.width - picture.height) <= SameAspect * picture.width;
}

double psnr_outside(const Image& sent, const Image& drawn, const Mask& mask) {
    GSE_CHECK_EQ(sent.data.size(), drawn.data.size());
    GSE_CHECK_EQ(mask.data.size(), sent.pixel_count());
    double squares = 0;
    std::size_t pixels = 0;
    for (std::size_t i = 0; i < mask.data.size(); ++i) {
        if (mask.data[i] != 0) continue;
        for (std::size_t c = 0; c < 3; ++c) {
            const double difference = sent.data[i * 3 + c] - drawn.data[i * 3 + c];
            squares += difference * difference;
        }
        ++pixels;
    }
    if (static_cast<double>(pixels) < LeastOutside * static_cast<double>(mask.data.size())) return -1;
    const double mean = squares / (3 * static_cast<double>(pixels));
    return mean > 0 ? std::min(MostPsnr, -10 * std::log10(mean)) : MostPsnr;
}

double change_inside(const Image& before, const Image& after, const Mask& mask) {
    GSE_CHECK_EQ(before.data.size(), after.data.size());
    double sum = 0;
    std::size_t pixels = 0;
    for (std::size_t i = 0; i < mask.data.size(); ++i) {
        if (mask.data[i] == 0) continue;
        for (std::size_t c = 0; c < 3; ++c)
            sum += std::abs(before.data[i * 3 + c] - after.data[i * 3 + c]) / 3;
        ++pixels;
    }
    return pixels > 0 ? sum / static_cast<double>(pixels) : 0;
}

double edge_correlation(const Image& picture, const Image& other) {
    GSE_CHECK_EQ(picture.data.size(), other.data.size());
    const auto a = edges_of(picture), b = edges_of(other);
    const auto count = static_cast<double>(a.size());
    const double mean_a = std::accumulate(a.begin(), a.end(), 0.0) / count;
    const double mean_b = std::accumulate(b.begin(), b.end(), 0.0) / count;
    double product = 0, square_a = 0, square_b = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double of_a = a[i] - mean_a, of_b = b[i] - mean_b;
        product += of_a * of_b, square_a += of_a * of_a, square_b += of_b * of_b;
    }
    return square_a > 0 && square_b > 0 ? product / std::sqrt(square_a * square_b) : 0;
}

CheckedPicture check_answer(const ViewFrame& frame, Image answer) {
    CheckedPicture checked;
    const int side = frame.picture.width;
    const int width = answer.width, height = answer.height;
    checked.picture = at_asked_size(std::move(answer), side, checked.note);
    if (checked.picture.data.empty()) {
        checked.flaw = Flaw::WrongSize;
        checked.note = fmt::format("the server answered with {} x {} pixels in place of {} x {}", width,
                                   height, side, side);
        return checked;
    }
    checked.psnr = psnr_outside(frame.picture, checked.picture, frame.sent_mask);
    if (checked.psnr >= 0) undo_drift(frame, checked);
    if (checked.flaw != Flaw::None) return checked;
    if (checked.psnr >= 0 && checked.psnr < LeastPsnr) {
        checked.flaw = Flaw::Unrelated;
        checked.note =
            fmt::format("the server has not looked at our picture: its surroundings differ (PSNR {:.1f} dB)",
                        checked.psnr);
        return checked;
    }
    if (change_inside(frame.original, checked.picture, frame.mask) < LeastChange) {
        checked.flaw = Flaw::Unedited;
        checked.note = "the server sent the picture back unchanged";
        return checked;
    }
    if (checked.psnr >= 0 && checked.psnr < GoodPsnr)
        checked.note = fmt::format("what lies around the object changed, too (PSNR {:.1f} dB)", checked.psnr);
    return checked;
}

}  // namespace gse::remote
