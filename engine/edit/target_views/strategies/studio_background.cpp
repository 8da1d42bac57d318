// Rays to a plane.
#include "engine/edit/target_views/strategies/studio_background.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/log.h"
#include "engine/edit/placement/ground_cover.h"
#include "engine/language/words.h"

namespace gse::edit {
namespace {

constexpr double LeastUpright = 0.1;  // of its width: what is lower is a ground itself
// Share of the ground around it: less is no ground that a picture would show.
constexpr double LeastGroundCover = 0.5;
// Share of the pictures: where a scene shows less of a ground, its surroundings are there.
constexpr double LeastShown = 0.05;
constexpr std::size_t LookedAt = 4;  // views that tell
constexpr int PlainSamples = 2;      // along a pixel's side

/// Takes what shows beside and through a thing for what is behind it in the scene.
void move_before(const Image& scene, const Image& shown, const Image& outline, Image& picture) {
    for (std::size_t i = 0; i < picture.data.size(); ++i) {
        const float through = 1 - std::clamp(outline.data[i / 3], 0.0f, 1.0f);
        picture.data[i] = std::clamp(picture.data[i] + through * (scene.data[i] - shown.data[i]), 0.0f, 1.0f);
    }
}

/// Share of the ground in some of the pictures, as far as the scene is not before it.
double shown_share(const StudioBackground& plain, const GaussianSet& set, const std::vector<View>& views,
                   raster::Rasterizer& rasterizer) {
    double shown = 0, pixels = 0;
    raster::ForwardOutput output;
    const std::size_t step = std::max<std::size_t>(1, views.size() / LookedAt);
    for (std::size_t v = 0; v < views.size(); v += step) {
        rasterizer.forward(set.spans(), views[v].camera, {}, output);
        const Image ground = shown_of(plain, views[v].camera);
        for (std::size_t i = 0; i < ground.data.size(); ++i)
            shown += ground.data[i] * (1 - output.alpha.data[i]);
        pixels += static_cast<double>(ground.data.size());
    }
    return pixels > 0 ? shown / pixels : 0;
}

}  // namespace

std::optional<StudioBackground> plain_ground(const std::string& sentence, const UprightBounds& standing,
                                             const Vec3& up, const ModelTraits& traits) {
    if (!standing.found() || standing.height < LeastUpright * standing.width()) return std::nullopt;
    std::string ground = traits.plain_grounds.front();
    for (const auto& word : traits.plain_grounds)
        if (language::has_phrase(sentence, word)) ground = word;
    return StudioBackground{standing, normalized(up), traits.ground_colours.at(ground), traits.sky,
                            traits.ground_reach * figure_height(standing)};
}

std::optional<GroundUnder> ground_under(const std::string& sentence, const GaussianSet& set,
                                        std::span<const std::uint8_t> bits, const Vec3& up, const Vec3& front,
                                        raster::Rasterizer& rasterizer, const ModelTraits& traits) {
    if (bits.size() != set.size()) return std::nullopt;
    const auto standing = standing_of(set, bits, up, front);
    const auto plain = plain_ground(sentence, standing, up, traits);
    if (!plain) return std::nullopt;
    const double cover = ground_cover(set, bits, standing, up, rasterizer);
    log::debug("{:.0f} % of the ground around it are there", 100 * cover);
    return GroundUnder{*plain, cover < LeastGroundCover};
}

std::optional<StudioBackground> ground_below(const std::string& sentence, const GaussianSet& set,
                                             const std::vector<View>& views, const Vec3& up,
                                             raster::Rasterizer& rasterizer, const ModelTraits& traits) {
    const auto whole = standing_of_scene(set, up);
    const auto plain = plain_ground(sentence, whole, up, traits);
    if (!plain) return std::nullopt;
    const double cover = ground_of_scene(set, whole, up, rasterizer);
    log::debug("{:.0f} % of the ground around what rises out of the scene are there", 100 * cover);
    return cover < LeastGroundCover && shown_share(*plain, set, views, rasterizer) >= LeastShown
               ? plain
               : std::nullopt;
}

Image shown_of(const StudioBackground& plain, const Camera& camera) {
    Image shown(camera.width, camera.height, 1);
    const Vec3 from = camera.centre();
    const double above = dot(from - plain.standing.foot, plain.up);
    const auto hits = [&](double x, double y) {
        const Vec3 ray = camera.rotation.row(0) * ((x - camera.cx) / camera.fx) +
                         camera.rotation.row(1) * ((y - camera.cy) / camera.fy) + camera.rotation.row(2);
        const double rises = dot(ray, plain.up), way = rises != 0 ? -above / rises : -1;
        return way > 0 && length(from + ray * way - plain.standing.foot) <= plain.reach;
    };
    for (int y = 0; y < shown.height; ++y)
        for (int x = 0; x < shown.width; ++x) {
            int on = 0;
            for (int v = 0; v < PlainSamples; ++v)
                for (int u = 0; u < PlainSamples; ++u)
                    on += hits(x + (u + 0.5) / PlainSamples, y + (v + 0.5) / PlainSamples) ? 1 : 0;
            shown.at(x, y, 0) = static_cast<float>(on) / (PlainSamples * PlainSamples);
        }
    return shown;
}

Image picture_of(const StudioBackground& plain, const Camera& camera) {
    const Image shown = shown_of(plain, camera);
    Image picture(camera.width, camera.height, 3);
    for (std::size_t i = 0; i < picture.data.size(); ++i)
        picture.data[i] =
            shown.data[i / 3] * plain.ground[i % 3] + (1 - shown.data[i / 3]) * plain.sky[i % 3];
    return picture;
}

Image before_plain(const StudioBackground& plain, const Camera& camera, const Image& picture,
                   const Image& depth) {
    Image result = picture_of(plain, camera);
    for (std::size_t i = 0; i < result.data.size(); ++i)
        if (depth.data[i / 3] > 0) result.data[i] = picture.data[i];
    return result;
}

Image before_plain(const StudioBackground& plain, const Camera& camera, const Image& picture,
                   const Image& alpha, const std::array<float, 3>& background) {
    const Image behind = picture_of(plain, camera);
    Image result = picture;
    for (std::size_t i = 0; i < result.data.size(); ++i)
        result.data[i] = std::clamp(
            picture.data[i] + (1 - alpha.data[i / 3]) * (behind.data[i] - background[i % 3]), 0.0f, 1.0f);
    return result;
}

EditedViews OnPlainGround::edit(const std::vector<EditView>& views, const EditViewsRequest& input,
                                const JobControl& job) {
    if (input.anew)
        return input.round == 0 ? draw_anew(views, input, job) : guidance_.edit(views, input, job);
    return supports_appearance_editing() ? restyle(views, input, job) : guidance_.edit(views, input, job);
}

EditedViews OnPlainGround::draw_anew(const std::vector<EditView>& views, const EditViewsRequest& input,
                                     const JobControl& job) {
    auto plain = views;
    for (auto& view : plain) {
        const auto& behind = view.clean_plate;
        view.clean_plate.picture = shown_ == BeforePlain::Scene
                                       ? before_plain(plain_, view.view.camera, behind.picture, behind.depth)
                                       : picture_of(plain_, view.view.camera);
        view.rendered = view.original = view.clean_plate.picture;
    }
    auto drawn = guidance_.edit(plain, input, job);
    if (drawn.outlines.empty()) return guidance_.edit(views, input, job);
    for (std::size_t v = 0; v < views.size(); ++v)
        move_before(views[v].clean_plate.picture, plain[v].clean_plate.picture, drawn.outlines[v],
                    drawn.images[v]);
    return drawn;
}

EditedViews OnPlainGround::restyle(const std::vector<EditView>& views, const EditViewsRequest& input,
                                   const JobControl& job) {
    auto plain = views;
    for (auto& view : plain) {
        const auto ground = picture_of(plain_, view.view.camera);
        for (std::size_t p = 0; p < view.mask.data.size(); ++p)
            if (view.mask.data[p] == 0)
                for (std::size_t c = p * 3; c < p * 3 + 3; ++c)
                    view.rendered.data[c] = view.original.data[c] = ground.data[c];
    }
    return guidance_.edit(plain, input, job);
}

}  // namespace gse::edit
