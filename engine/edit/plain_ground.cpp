// Rays to a plane.
#include "engine/edit/plain_ground.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "engine/edit/words.h"

namespace gse::edit {
namespace {

constexpr double PlainReach = 3;      // figures' heights: as wide as in the pictures that the bundled model learned from
constexpr double LeastUpright = 0.1;  // of its width: what is lower is a ground itself
constexpr int PlainSamples = 2;       // along a pixel's side

}  // namespace

std::optional<PlainGround> plain_ground(const std::string& sentence, const Standing& standing, const Vec3& up, const std::array<float, 3>& sky) {
    if (!standing.found() || standing.height < LeastUpright * standing.width()) return std::nullopt;
    // Means of what engine/synth paints. Of grass, snow and sand under a cat the last left the least of a rim; a grey like that of stone, which
    // is no ground in the pictures that the model learned from, did no better than the scene.
    static const std::map<std::string, std::array<float, 3>> known{{"grass", {0.36f, 0.62f, 0.15f}}, {"snow", {0.88f, 0.93f, 0.99f}}};
    std::array<float, 3> colour{0.85f, 0.73f, 0.5f};
    for (const auto& [word, of_word] : known)
        if (has_word(sentence, word)) colour = of_word;
    return PlainGround{standing, normalized(up), colour, sky};
}

Image picture_of(const PlainGround& plain, const Camera& camera) {
    Image picture(camera.width, camera.height, 3);
    const Vec3 from = camera.centre();
    const double above = dot(from - plain.standing.foot, plain.up), reach = PlainReach * figure_height(plain.standing);
    const auto hits = [&](double x, double y) {
        const Vec3 ray = camera.rotation.row(0) * ((x - camera.cx) / camera.fx) + camera.rotation.row(1) * ((y - camera.cy) / camera.fy) + camera.rotation.row(2);
        const double rises = dot(ray, plain.up), way = rises != 0 ? -above / rises : -1;
        return way > 0 && length(from + ray * way - plain.standing.foot) <= reach;
    };
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
            int on = 0;
            for (int v = 0; v < PlainSamples; ++v)
                for (int u = 0; u < PlainSamples; ++u) on += hits(x + (u + 0.5) / PlainSamples, y + (v + 0.5) / PlainSamples) ? 1 : 0;
            const float share = static_cast<float>(on) / (PlainSamples * PlainSamples);
            for (std::size_t c = 0; c < 3; ++c) picture.at(x, y, static_cast<int>(c)) = share * plain.ground[c] + (1 - share) * plain.sky[c];
        }
    return picture;
}

RoundTargets OnPlainGround::edit(const std::vector<RoundView>& views, const RoundInput& input, const JobControl& job) {
    if (input.anew) return input.round == 0 ? draw_anew(views, input, job) : guidance_.edit(views, input, job);
    return restyles() ? restyle(views, input, job) : guidance_.edit(views, input, job);
}

RoundTargets OnPlainGround::draw_anew(const std::vector<RoundView>& views, const RoundInput& input, const JobControl& job) {
    auto plain = views;
    for (auto& view : plain) view.rendered = view.original = view.backdrop.picture = picture_of(plain_, view.view.camera);
    auto drawn = guidance_.edit(plain, input, job);
    return drawn.outlines.empty() ? guidance_.edit(views, input, job) : drawn;
}

RoundTargets OnPlainGround::restyle(const std::vector<RoundView>& views, const RoundInput& input, const JobControl& job) {
    auto plain = views;
    for (auto& view : plain) {
        const auto ground = picture_of(plain_, view.view.camera);
        for (std::size_t p = 0; p < view.mask.data.size(); ++p)
            if (view.mask.data[p] == 0)
                for (std::size_t c = p * 3; c < p * 3 + 3; ++c) view.rendered.data[c] = view.original.data[c] = ground.data[c];
    }
    return guidance_.edit(plain, input, job);
}

}  // namespace gse::edit
