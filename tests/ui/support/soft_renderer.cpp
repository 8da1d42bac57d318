// Draws what ImGui emits into an image on the processor, so that tests can look at the window without a
// device.
#include "tests/ui/support/soft_renderer.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace gse::test {
namespace {

struct Colour {
    float r = 1, g = 1, b = 1, a = 1;
};

Colour unpack(ImU32 packed) {
    const auto part = [packed](int shift) { return static_cast<float>(packed >> shift & 255) / 255; };
    return {part(IM_COL32_R_SHIFT), part(IM_COL32_G_SHIFT), part(IM_COL32_B_SHIFT), part(IM_COL32_A_SHIFT)};
}

Colour texel(const Image& picture, int x, int y) {
    x = std::clamp(x, 0, picture.width - 1);
    y = std::clamp(y, 0, picture.height - 1);
    const auto at = [&](int c) { return picture.at(x, y, std::min(c, picture.channels - 1)); };
    return {at(0), at(1), at(2), picture.channels == 4 ? at(3) : 1.0f};
}

Colour sample(const Image* picture, float u, float v) {
    if (picture == nullptr || picture->width == 0) return {};
    const float x = u * static_cast<float>(picture->width) - 0.5f,
                y = v * static_cast<float>(picture->height) - 0.5f;
    const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
    const float fx = x - static_cast<float>(x0), fy = y - static_cast<float>(y0);
    Colour sum{0, 0, 0, 0};
    for (int corner = 0; corner < 4; ++corner) {
        const float weight = (corner % 2 == 0 ? 1 - fx : fx) * (corner < 2 ? 1 - fy : fy);
        if (weight == 0) continue;
        const Colour c = texel(*picture, x0 + corner % 2, y0 + corner / 2);
        sum = {sum.r + weight * c.r, sum.g + weight * c.g, sum.b + weight * c.b, sum.a + weight * c.a};
    }
    return sum;
}

struct Target {
    Image& image;
    ImVec2 origin;
    ImVec4 clip;  // pixels: left, top, right, bottom
    const Image* texture;
};

float edge(const ImVec2& a, const ImVec2& b, float x, float y) {
    return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
}

/// Fill rule of graphics devices: a pixel on the shared side of two triangles belongs to one of them.
bool top_left(const ImVec2& a, const ImVec2& b) { return a.y == b.y ? b.x > a.x : b.y < a.y; }

void blend(float* pixel, const Colour& c) {
    pixel[0] += (c.r - pixel[0]) * c.a;
    pixel[1] += (c.g - pixel[1]) * c.a;
    pixel[2] += (c.b - pixel[2]) * c.a;
}

void fill_triangle(const Target& target, std::array<ImDrawVert, 3> v) {
    for (auto& vertex : v) vertex.pos = {vertex.pos.x - target.origin.x, vertex.pos.y - target.origin.y};
    float area = edge(v[0].pos, v[1].pos, v[2].pos.x, v[2].pos.y);
    if (area == 0 || !std::isfinite(area)) return;
    if (area < 0) {
        std::swap(v[1], v[2]);
        area = -area;
    }
    const auto [low_x, high_x] = std::minmax({v[0].pos.x, v[1].pos.x, v[2].pos.x});
    const auto [low_y, high_y] = std::minmax({v[0].pos.y, v[1].pos.y, v[2].pos.y});
    const int left = std::max(static_cast<int>(std::floor(low_x)), static_cast<int>(target.clip.x));
    const int right = std::min(static_cast<int>(std::ceil(high_x)), static_cast<int>(target.clip.z));
    const int top = std::max(static_cast<int>(std::floor(low_y)), static_cast<int>(target.clip.y));
    const int bottom = std::min(static_cast<int>(std::ceil(high_y)), static_cast<int>(target.clip.w));
    const std::array<Colour, 3> colours{unpack(v[0].col), unpack(v[1].col), unpack(v[2].col)};
    for (int y = top; y < bottom; ++y)
        for (int x = left; x < right; ++x) {
            const float px = static_cast<float>(x) + 0.5f, py = static_cast<float>(y) + 0.5f;
            std::array<float, 3> weight{};
            bool inside = true;
            for (std::size_t side = 0; side < 3 && inside; ++side) {
                const auto &a = v[(side + 1) % 3].pos, &b = v[(side + 2) % 3].pos;
                weight[side] = edge(a, b, px, py);
                inside = weight[side] > 0 || (weight[side] == 0 && top_left(a, b));
            }
            if (!inside) continue;
            const auto mix = [&](auto get) {
                return (weight[0] * get(0) + weight[1] * get(1) + weight[2] * get(2)) / area;
            };
            Colour c = sample(target.texture, mix([&](std::size_t i) { return v[i].uv.x; }),
                              mix([&](std::size_t i) { return v[i].uv.y; }));
            c.r *= mix([&](std::size_t i) { return colours[i].r; });
            c.g *= mix([&](std::size_t i) { return colours[i].g; });
            c.b *= mix([&](std::size_t i) { return colours[i].b; });
            c.a *= mix([&](std::size_t i) { return colours[i].a; });
            blend(&target.image.at(x, y, 0), c);
        }
}

}  // namespace

Image render_draw_data(const ImDrawData& data, const TextureLookup& textures) {
    Image image(static_cast<int>(data.DisplaySize.x), static_cast<int>(data.DisplaySize.y), 3, 0.0f);
    for (int index = 0; index < data.CmdListsCount; ++index) {
        const ImDrawList& list = *data.CmdLists[index];
        for (const ImDrawCmd& command : list.CmdBuffer) {
            if (command.UserCallback != nullptr) continue;
            ImVec4 clip(command.ClipRect.x - data.DisplayPos.x, command.ClipRect.y - data.DisplayPos.y,
                        command.ClipRect.z - data.DisplayPos.x, command.ClipRect.w - data.DisplayPos.y);
            clip.x = std::max(0.0f, clip.x);
            clip.y = std::max(0.0f, clip.y);
            clip.z = std::min(static_cast<float>(image.width), clip.z);
            clip.w = std::min(static_cast<float>(image.height), clip.w);
            const Target target{image, data.DisplayPos, clip, textures(command.GetTexID())};
            for (unsigned at = 0; at + 2 < command.ElemCount; at += 3) {
                const auto vertex = [&](unsigned offset) {
                    return list.VtxBuffer[static_cast<int>(
                        command.VtxOffset +
                        list.IdxBuffer[static_cast<int>(command.IdxOffset + at + offset)])];
                };
                fill_triangle(target, {vertex(0), vertex(1), vertex(2)});
            }
        }
    }
    return image;
}

Image font_picture(ImFontAtlas& atlas) {
    unsigned char* pixels = nullptr;
    int width = 0, height = 0;
    atlas.GetTexDataAsAlpha8(&pixels, &width, &height);
    Image image(width, height, 4, 1.0f);
    for (std::size_t at = 0; at < image.pixel_count(); ++at)
        image.data[at * 4 + 3] = static_cast<float>(pixels[at]) / 255;
    return image;
}

}  // namespace gse::test
