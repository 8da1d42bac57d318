// Rendering both sides of the picture, and resolving it.
#include "app/session/shown_picture.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "engine/base/error.h"

namespace gse::app {
namespace {

using PaintClock = std::chrono::steady_clock;

constexpr float LeastSolid = 0.3f;  // of a pixel, to have a depth that can be picked

/// Distance to the middle of the splats: the middle of the depth colours.
float depth_scale(const GaussianSet& set, const Camera& camera) {
    constexpr std::size_t samples = 4096;
    const std::size_t step = std::max<std::size_t>(set.size() / samples, 1);
    const auto position = set.position();
    Vec3 sum;
    double count = 0;
    for (std::size_t row = 0; row < set.size(); row += step) {
        const Vec3 place{position[row * 3], position[row * 3 + 1], position[row * 3 + 2]};
        if (!std::isfinite(place.x + place.y + place.z)) continue;
        sum = sum + place;
        count += 1;
    }
    return static_cast<float>(std::max(length((count > 0 ? sum / count : sum) - camera.centre()), 1e-12));
}

}  // namespace

preview::Display display_of(const PictureRequest& request) {
    preview::Display display;
    display.mode = static_cast<preview::Mode>(std::clamp(request.settings.mode, 0, 9));
    display.sh_degree = request.settings.sh_degree;
    display.antialiased = request.antialiased;
    display.transparent = request.transparent;
    try {
        display.background = parse_colour(request.settings.background);
    } catch (const Error&) { display.background = {0, 0, 0}; }
    const bool tints = display.mode == preview::Mode::Labels || request.settings.tint_labels;
    display.tint_strength = tints && request.values ? request.settings.tint_strength : 0;
    return display;
}

void NativePainter::paint_part(const PictureRequest& request, bool original, const Camera& camera,
                               int first_column, NativePicture& picture) {
    const auto& set = original ? request.original : request.set;
    preview::Display display = display_of(request);
    const bool has_values = !original && request.values && request.values->size() == set.size();
    if (!has_values) {
        display.tint_strength = 0;
        if (preview::needs_value(display)) display.mode = preview::Mode::Beauty;
    }
    raster::Settings settings;  // over black: the resolve adds the background
    settings.sh_degree = display.sh_degree;
    settings.antialiased = display.antialiased;
    const bool wants_value = preview::needs_value(display);
    if (wants_value)
        painter_.rasterizer().forward_values(set.spans(), camera, settings, *request.values, values_);
    const auto& light = painter_.paint(set.spans(), camera, settings);
    const float middle = display.mode == preview::Mode::Depth ? depth_scale(set, camera) : 1.0f;
    preview::resolve({&light.colour, &light.alpha, &light.depth, wants_value ? &values_ : nullptr}, display,
                     middle, painter_.pool(), part_);
    for (int y = 0; y < camera.height; ++y) {
        const auto row = static_cast<std::size_t>(y) * static_cast<std::size_t>(camera.width);
        std::copy_n(&part_[row * 4], static_cast<std::size_t>(camera.width) * 4,
                    &picture.rgba[(static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) +
                                   static_cast<std::size_t>(first_column)) *
                                  4]);
        for (int x = 0; x < camera.width; ++x) {
            const float alpha = light.alpha.data[row + static_cast<std::size_t>(x)];
            picture.depth.at(first_column + x, y, 0) =
                alpha > LeastSolid ? light.depth.data[row + static_cast<std::size_t>(x)] / alpha : 0.0f;
        }
    }
}

void NativePainter::paint(const PictureRequest& request, int width, int height, NativePicture& picture) {
    const auto start = PaintClock::now();
    picture.width = width;
    picture.height = height;
    picture.camera = request.camera;
    picture.full = width == request.camera.width && height == request.camera.height;
    picture.rgba.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4);
    picture.depth.resize(width, height, 1);
    Camera whole = request.camera.resized(width, height);
    whole.fy = request.camera.fy * height /
               request.camera.height;  // rounding of the height must not bend the picture
    whole.cy = request.camera.cy * height / request.camera.height;
    const int split =
        request.comparison == ui::Comparison::Original ? width
        : request.comparison == ui::Comparison::Wipe
            ? std::clamp(static_cast<int>(std::lround(request.settings.wipe * static_cast<float>(width))), 0,
                         width)
            : 0;
    // Columns of one camera are a camera themselves: only what is shown is rendered.
    if (split > 0) {
        Camera left = whole;
        left.width = split;
        paint_part(request, true, left, 0, picture);
    }
    if (split < width) {
        Camera right = whole;
        right.width = width - split;
        right.cx -= split;
        paint_part(request, false, right, split, picture);
    }
    picture.milliseconds = std::chrono::duration<double, std::milli>(PaintClock::now() - start).count();
}

Image shown_picture(const PictureRequest& request) {
    NativePainter painter;
    NativePicture picture;
    painter.paint(request, request.camera.width, request.camera.height, picture);
    Image image(picture.width, picture.height, request.transparent ? 4 : 3);
    const auto channels = static_cast<std::size_t>(image.channels);
    for (std::size_t pixel = 0; pixel < image.pixel_count(); ++pixel)
        for (std::size_t k = 0; k < channels; ++k)
            image.data[pixel * channels + k] = static_cast<float>(picture.rgba[pixel * 4 + k]) / 255.0f;
    return image;
}

std::array<float, 3> seen_colour(PictureRequest request, int x, int y) {
    const bool left =
        static_cast<float>(x) < request.settings.wipe * static_cast<float>(request.camera.width);
    if (request.comparison == ui::Comparison::Wipe)
        request.comparison = left ? ui::Comparison::Original : ui::Comparison::None;
    request.settings.mode = static_cast<int>(ui::DisplayMode::Beauty);
    request.settings.tint_labels = false;
    request.values = nullptr;
    // A pixel of a camera is a camera itself.
    request.camera.cx -= x;
    request.camera.cy -= y;
    request.camera.width = request.camera.height = 1;
    const Image pixel = shown_picture(request);
    return {pixel.data[0], pixel.data[1], pixel.data[2]};
}

}  // namespace gse::app
