// antimatter15 .splat: 32 bytes per splat, no header, no spherical harmonics beyond the base colour.
#include <fmt/core.h>

#include <cmath>

#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/base/memory.h"
#include "engine/io/bytes/byte_reader.h"
#include "engine/io/bytes/claims.h"
#include "engine/io/bytes/encoding.h"
#include "engine/io/formats/scene_format.h"

namespace gse::io {
namespace {

constexpr std::size_t RowBytes = 32;  // f32 position[3], f32 linear scale[3], u8 rgba, u8 rotation wxyz

float log_scale_of(float linear) {
    const float value = std::log(linear);  // NaN for a negative scale; counted by the statistics
    return value < FlattestLogScale ? FlattestLogScale : value;
}

void parse_row(const std::byte* source, GaussianData& data, std::size_t row) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        data.position[row * 3 + axis] = load_scalar<float>(source + 4 * axis);
        data.log_scale[row * 3 + axis] = log_scale_of(load_scalar<float>(source + 12 + 4 * axis));
        data.sh[row * 3 + axis] =
            static_cast<float>(sh_from_colour(static_cast<unsigned>(source[24 + axis]) / 255.0));
    }
    data.opacity_logit[row] = byte_logits()[static_cast<unsigned>(source[27])];
    double squares = 0;
    std::array<double, 4> q{};
    for (std::size_t i = 0; i < 4; ++i) {
        q[i] = (static_cast<int>(source[28 + i]) - 128) / 128.0;
        squares += q[i] * q[i];
    }
    const double norm = squares > 0 ? std::sqrt(squares) : 1;
    for (std::size_t i = 0; i < 4; ++i) data.rotation[row * 4 + i] = static_cast<float>(q[i] / norm);
}

Scene parse_splat(Bytes bytes) {
    if (bytes.empty() || bytes.size() % RowBytes != 0)
        throw Error(ErrorCode::Malformed,
                    fmt::format("a .splat file has 32 bytes per splat; {} bytes are not a multiple of it",
                                bytes.size()),
                    "the file is cut off or not a .splat file");
    const std::size_t count = bytes.size() / RowBytes;
    require_memory(splat_bytes(count, 0), fmt::format("the scene of {} splats", count));
    GaussianData data;
    data.resize(count);
    for (std::size_t row = 0; row < data.size(); ++row) parse_row(bytes.data() + row * RowBytes, data, row);
    Scene scene;
    scene.info.format = "splat";
    scene.gaussians = GaussianSet(std::move(data));
    return scene;
}

std::vector<std::uint32_t> write_splat(const Scene& scene, const SaveOptions&, const TakePiece& take) {
    const GaussianSet set = storable_rows(scene.gaussians, ".splat");
    if (set.sh_degree() > 0)
        log::warning("a .splat file keeps base colours only; view-dependent colour is lost");
    std::string out;
    out.reserve(set.size() * RowBytes);
    const std::size_t sh_stride = set.size() > 0 ? set.sh().size() / set.size() : 3;
    for (std::size_t row = 0; row < set.size(); ++row) {
        for (std::size_t axis = 0; axis < 3; ++axis) append_value(out, set.position()[row * 3 + axis]);
        for (std::size_t axis = 0; axis < 3; ++axis)
            append_value(out, std::exp(set.log_scale()[row * 3 + axis]));
        for (std::size_t c = 0; c < 3; ++c)
            append_value(out,
                         to_byte(255 * colour_from_sh(static_cast<double>(set.sh()[row * sh_stride + c]))));
        append_value(out, to_byte(255 * opacity_from_logit(static_cast<double>(set.opacity_logit()[row]))));
        for (const double component : unit_quaternion(set.rotation().data() + row * 4))
            append_value(out, to_byte(component * 128 + 128));
    }
    take(out);
    return {};
}

}  // namespace

SceneFormat splat_format() {
    return {.name = "splat",
            .title = ".splat",
            .extensions = {".splat"},
            .mime = {.type = "model/x-splat", .comment = "Gaussian splats (.splat)"},
            .read = parse_splat,
            .write = write_splat,
            .keeps_view_colour = false};
}

}  // namespace gse::io
