// Words for one colour or one material, and the tones that things of that look have in light and shade.
#pragma once

#include <array>
#include <optional>
#include <string>

namespace gse::edit {

/// Tones of a look, display values in [0,1]: where the thing is darkest, and where it is lit.
struct Look {
    std::array<float, 3> shade{}, lit{};
    /// Tone at a share of the light in [0,1].
    std::array<float, 3> tone(float light) const;
};

/// Tones of a colour's or a material's word ("blue", "golden", "stone"); none for other words.
std::optional<Look> look_named(const std::string& word);

/// Tells whether a pixel (display values in [0,1]) has the look in that light: hue, chroma and lightness in
/// CIELAB agree with its tone there. A look without a hue asks for little chroma instead.
class LookTest {
public:
    explicit LookTest(const Look& look);
    bool has(const std::array<double, 3>& srgb, float light) const;

private:
    Look look_;
    bool has_hue_ = false;
    double hue_ = 0, chroma_ = 0;  // of the look's middle: radians; CIELAB units
};

}  // namespace gse::edit
