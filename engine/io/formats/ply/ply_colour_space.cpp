// Linear light becomes sRGB (IEC 61966-2-1), a splat at a time.
#include "engine/io/formats/ply/ply_colour_space.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>

#include "engine/base/error.h"
#include "engine/base/printable.h"
#include "engine/io/formats/ply/ply_body.h"
#include "engine/math/sh_projection.h"

namespace gse::io {
namespace {

constexpr std::string_view SpaceName = "color_space";
constexpr std::string_view SrgbNumber = "0", LinearNumber = "1";  // of SHARP
constexpr std::size_t LongestSpace = 40;                          // characters of a name in a warning

enum class ColourSpace : std::uint8_t { Srgb, Linear, Unknown };

struct Stated {
    ColourSpace space = ColourSpace::Srgb;
    std::string name;
};

/// Text in lower case without blanks, signs and quotes: "Colour space: Linear-sRGB" ->
/// "colourspacelinearsrgb".
std::string letters_of(std::string_view text) {
    std::string letters;
    for (const char letter : text)
        if (std::isalnum(static_cast<unsigned char>(letter)) != 0)
            letters += static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    return letters;
}

Stated space_of_name(std::string name) {
    const auto has = [&](std::string_view word) { return name.find(word) != std::string::npos; };
    const bool gamma = has("nonlinear") || has("gamma");
    const bool linear = !gamma && (has("linear") || name.starts_with("lin") || name == LinearNumber);
    const bool srgb = gamma || has("srgb") || name == SrgbNumber;
    const auto space = linear ? ColourSpace::Linear : srgb ? ColourSpace::Srgb : ColourSpace::Unknown;
    return {space, std::move(name)};
}

/// Colour space of the comments; the last one counts.
std::optional<Stated> space_of_comments(const PlyHeader& header) {
    std::optional<Stated> stated;
    for (const std::string& comment : header.comments) {
        const std::string letters = letters_of(comment);
        for (const std::string_view key : {"colorspace", "colourspace"})
            if (letters.starts_with(key) && letters.size() > key.size())
                stated = space_of_name(letters.substr(key.size()));
    }
    return stated;
}

/// Colour space of SHARP's element: 0 = sRGB, others linear. Nothing where the file ends before it.
std::optional<Stated> space_of_element(const PlyHeader& header, Bytes file) {
    const PlyElement* element = header.find(SpaceName);
    if (element == nullptr || element->count == 0 || element->properties.empty()) return std::nullopt;
    const auto column = static_cast<std::size_t>(std::max(element->find(SpaceName), 0));
    if (element->properties[column].is_list) return std::nullopt;
    try {
        PlyBody body(file, header);
        body.seek(*element);
        const PlyRowShape shape = row_shape(header, *element);
        std::vector<std::byte> row(shape.stride);
        body.read_row(*element, shape, row.data());
        const double value =
            load_ply_double(row.data() + shape.offsets[column], shape.types[column], shape.big_endian);
        return Stated{value == 0 ? ColourSpace::Srgb : ColourSpace::Linear, {}};
    } catch (const Error&) {  // the splats lie in front of it and are whole
        return std::nullopt;
    }
}

double srgb_of_linear(double value) {
    return value <= 0.0031308 ? 12.92 * value : 1.055 * std::pow(value, 1 / 2.4) - 0.055;
}

/// Base colours exactly. With view-dependent colour, the colours seen from every side, as near as the degree
/// can.
void linear_to_srgb(GaussianData& data) {
    constexpr double Middle = 0.5;
    const ShSampling sampling(data.sh_degree);
    std::array<double, ShDirections> values{};
    for (std::size_t row = 0; row < data.size(); ++row)
        for (std::size_t channel = 0; channel < 3; ++channel) {
            float* sh = data.sh.data() + row * data.sh_stride() + channel;
            if (data.sh_degree == 0) {
                *sh = static_cast<float>(
                    sh_from_colour(srgb_of_linear(colour_from_sh(static_cast<double>(*sh)))));
                continue;
            }
            for (std::size_t i = 0; i < ShDirections; ++i)
                values[i] = srgb_of_linear(std::max(0.0, Middle + sampling.value(i, sh, 3))) - Middle;
            sampling.project(values, sh, 3);
        }
}

}  // namespace

bool states_colour_space(const PlyHeader& header) {
    return header.find(SpaceName) != nullptr || space_of_comments(header);
}

void show_as_srgb(Scene& scene, const PlyHeader& header, Bytes file) {
    auto stated = space_of_element(header, file);
    if (!stated) stated = space_of_comments(header);
    if (!stated) return;
    if (stated->space == ColourSpace::Unknown)
        scene.info.warnings.push_back(fmt::format(
            "the file states the colour space \"{}\", which is not known; its colours are shown as "
            "they are stored",
            printable(stated->name.substr(0, LongestSpace))));
    if (stated->space != ColourSpace::Linear) return;
    GaussianData data = scene.gaussians.to_data();
    linear_to_srgb(data);
    scene.gaussians = GaussianSet(std::move(data));
    scene.info.warnings.push_back(
        "the colours of the file are linear light; they are converted to sRGB, as they are shown");
}

}  // namespace gse::io
