// Colours of some rows changed by hand with the controls of picture editors. One affine map of the colour, so
// that it holds from every side.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "engine/base/fields.h"
#include "engine/math/vec.h"
#include "engine/scene/gaussian_set.h"

namespace gse {

struct ColourAdjustment {
    double hue = 0;  // degrees
    double saturation = 1;
    double brightness = 1;
    double contrast = 1;
    double temperature = 0;
    double density = 1;

    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        f("hue", self.hue, "Turns all hues, degrees: 120 makes red green.", Range{-180, 180});
        f("saturation", self.saturation, "0 = grey, 1 = as it is.", Range{0, 3});
        f("brightness", self.brightness, "Factor of the colour.", Range{0, 3});
        f("contrast", self.contrast, "Factor of the distance to the middle grey.", Range{0, 3});
        f("temperature", self.temperature, "Below 0 bluer, above 0 more orange.", Range{-1, 1});
        f("density", self.density,
          "Factor of what the splats cover (optical depth): below 1 fainter, above 1 more solid.",
          Range{0.02, 3});
    }
    bool operator==(const ColourAdjustment&) const = default;
};

/// Map colour -> linear * colour + offset, for display colours in [0,1].
struct ColourMap {
    Mat3 linear = Mat3::identity();
    Vec3 offset{0, 0, 0};
};

/// Temperature, brightness, contrast, saturation, hue, in this order. Saturation and hue are those of
/// feColorMatrix (W3C Filter Effects Module Level 1, 9.6), which leave the luma as it is.
ColourMap colour_map(const ColourAdjustment& adjustment);

/// The set with the rows adjusted whose byte is set. Spherical harmonics are linear, so the map holds in
/// every direction. Other rows, and rows with values that are not finite, stay bit for bit. Throws Error
/// (InvalidArgument) for numbers out of range.
GaussianSet adjusted(const GaussianSet& set, std::span<const std::uint8_t> rows,
                     const ColourAdjustment& adjustment);

/// Settings that differ from their defaults: "hue 30, saturation 1.2".
std::string adjustment_text(const ColourAdjustment& adjustment);

}  // namespace gse
