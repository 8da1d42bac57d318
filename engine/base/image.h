// Plain images: interleaved float colour (or one channel) and byte masks; row 0 is the top.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gse {

/// Float image [height, width, channels], interleaved. Colours are display values in [0,1] unless said
/// otherwise.
struct Image {
    int width = 0;
    int height = 0;
    int channels = 0;
    std::vector<float> data;

    Image() = default;
    Image(int width_px, int height_px, int channel_count, float fill = 0.0f)
        : width(width_px), height(height_px), channels(channel_count),
          data(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px) *
                   static_cast<std::size_t>(channel_count),
               fill) {}

    std::size_t pixel_count() const {
        return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    }
    float& at(int x, int y, int c) {
        return data[(static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                     static_cast<std::size_t>(x)) *
                        static_cast<std::size_t>(channels) +
                    static_cast<std::size_t>(c)];
    }
    float at(int x, int y, int c) const { return const_cast<Image*>(this)->at(x, y, c); }
    /// Sets the size. Memory is kept, so a size that was seen before allocates nothing.
    void resize(int width_px, int height_px, int channel_count) {
        width = width_px;
        height = height_px;
        channels = channel_count;
        data.resize(pixel_count() * static_cast<std::size_t>(channel_count));
    }
};

/// Byte mask [height, width]: 0 = outside, 1 = inside.
struct Mask {
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> data;

    Mask() = default;
    Mask(int width_px, int height_px, std::uint8_t fill = 0)
        : width(width_px), height(height_px),
          data(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px), fill) {}

    std::uint8_t& at(int x, int y) {
        return data[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                    static_cast<std::size_t>(x)];
    }
    std::uint8_t at(int x, int y) const { return const_cast<Mask*>(this)->at(x, y); }
    std::size_t count() const {
        std::size_t inside = 0;
        for (const auto value : data) inside += value != 0 ? 1u : 0u;
        return inside;
    }
};

}  // namespace gse
