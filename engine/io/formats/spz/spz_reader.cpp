// Niantic .spz. v1-v3 are one gzip stream (or that stream bare), v4 a header, a table and one zstd frame per
// attribute.
//
// Frame: the format's document says the stored axes are right, up, back. Real pairs of a scene in .spz and
// .ply agree only under it. So y and z are negated on loading, unless the extension
// SPZ_ADOBE_coordinate_system names another frame.
#include <fmt/core.h>

#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>

#include "engine/base/error.h"
#include "engine/io/bytes/byte_reader.h"
#include "engine/io/bytes/claims.h"
#include "engine/io/bytes/encoding.h"
#include "engine/io/bytes/half.h"
#include "engine/io/bytes/inflate.h"
#include "engine/io/formats/spz/spz_format.h"

namespace gse::io {
namespace {

constexpr std::size_t HeaderBytes = 16;
constexpr std::size_t HeaderBytesV4 = 32;
constexpr int HighestDegree = 4;
constexpr std::uint8_t FlagAntialiased = 1;
constexpr std::uint8_t FlagExtensions = 2;
constexpr std::uint8_t FlagLevels = 0x80;  // Spark's levels of detail
constexpr std::uint32_t CoordinateSystemExtension = 0xadbe0003;
constexpr std::uint32_t RightUpBack = 4;
constexpr std::uint32_t LastAxisFlip = 8;  // later values also exchange axes
constexpr std::uint64_t LargestExtensions = 1 << 20;
constexpr std::size_t MostNamed = 5;  // unknown extensions in the warning

struct Header {
    std::uint32_t version = 0;
    std::uint64_t count = 0;
    int degree = 0;
    int fractional_bits = 0;
    std::uint8_t flags = 0;
    std::uint8_t streams = 0;  // v4

    std::uint64_t position_bytes() const { return version == 1 ? 6 : 9; }
    std::uint64_t rotation_bytes() const { return version >= 3 ? 4 : 3; }
    std::uint64_t sh_bytes() const { return static_cast<std::uint64_t>((degree + 1) * (degree + 1) - 1) * 3; }
    std::uint64_t row_bytes() const { return position_bytes() + 1 + 3 + 3 + rotation_bytes() + sh_bytes(); }
};

/// Attribute arrays of any version.
struct Arrays {
    Bytes position, alpha, colour, scale, rotation, sh;
};

[[noreturn]] void throw_bad_spz(const std::string& what) {
    throw Error(ErrorCode::Malformed, "the SPZ file " + what, "the file is cut off or damaged; get it again");
}

Header parse_header(Bytes bytes) {
    if (bytes.size() < HeaderBytes) throw_bad_spz("ends inside its header");
    if (load_scalar<std::uint32_t>(bytes.data()) != SpzMagic) throw_bad_spz("does not begin with NGSP");
    Header header;
    header.version = load_scalar<std::uint32_t>(bytes.data() + 4);
    header.count = load_scalar<std::uint32_t>(bytes.data() + 8);
    header.degree = std::to_integer<int>(bytes[12]);
    header.fractional_bits = std::to_integer<int>(bytes[13]);
    header.flags = std::to_integer<std::uint8_t>(bytes[14]);
    header.streams = std::to_integer<std::uint8_t>(bytes[15]);
    if (header.version < 1 || header.version > 4)
        throw Error(ErrorCode::Unsupported,
                    fmt::format("SPZ version {} is not known; 1 to 4 are", header.version));
    if (header.degree > HighestDegree) throw_bad_spz(fmt::format("claims SH degree {}", header.degree));
    if (header.fractional_bits > 23)
        throw_bad_spz(fmt::format("claims {} fractional bits", header.fractional_bits));
    if (header.count == 0) throw_bad_spz("holds no splats");
    return header;
}

Arrays split_arrays(const Header& header, Bytes body) {
    ByteReader reader(body, "the SPZ file");
    Arrays arrays;
    arrays.position = reader.take(header.count * header.position_bytes());
    arrays.alpha = reader.take(header.count);
    arrays.colour = reader.take(header.count * 3);
    arrays.scale = reader.take(header.count * 3);
    arrays.rotation = reader.take(header.count * header.rotation_bytes());
    arrays.sh = reader.take(header.count * header.sh_bytes());
    return arrays;
}

/// Facts in the extensions of a file.
struct Extensions {
    std::optional<std::uint32_t> frame;
    std::string unknown;  // their types, with commas between them
};

/// Records of [u32 type][u32 length][payload].
Extensions parse_extensions(Bytes bytes) {
    Extensions extensions;
    std::set<std::uint32_t> unknown;
    ByteReader reader(bytes, "the extension list of the SPZ file");
    while (reader.remaining() >= 8) {
        const auto type = reader.read<std::uint32_t>();
        const auto length = reader.read<std::uint32_t>();
        const Bytes payload = reader.take(length);
        if (type == CoordinateSystemExtension && payload.size() >= 4)
            extensions.frame = load_scalar<std::uint32_t>(payload.data());
        else if (unknown.size() < MostNamed) unknown.insert(type);
    }
    for (const std::uint32_t type : unknown)
        extensions.unknown += fmt::format("{}{:#x}", extensions.unknown.empty() ? "" : ", ", type);
    return extensions;
}

/// One sentence on everything in the file that is passed over. Empty when that is nothing.
std::string passed_over(const Header& header, const Extensions& extensions) {
    const unsigned flags = header.flags & ~static_cast<unsigned>(FlagAntialiased | FlagExtensions);
    std::string parts;
    if (flags != 0)
        parts = fmt::format("flags {:#x}{}", flags,
                            (flags & FlagLevels) != 0 ? " (levels of detail, all drawn at once)" : "");
    if (!extensions.unknown.empty())
        parts += (parts.empty() ? "extensions " : " and extensions ") + extensions.unknown;
    return parts.empty() ? "" : "the SPZ file has parts that are not known and passed over: " + parts;
}

void unpack_positions(const Header& header, Bytes bytes, std::vector<float>& out) {
    const double step = std::ldexp(1.0, -header.fractional_bits);
    for (std::size_t i = 0; i < out.size(); ++i) {
        if (header.version == 1) {
            out[i] = half_to_float(load_scalar<std::uint16_t>(bytes.data() + 2 * i));
            continue;
        }
        const std::byte* source = bytes.data() + 3 * i;
        const std::uint32_t word = (static_cast<std::uint32_t>(source[0]) << 8) |
                                   (static_cast<std::uint32_t>(source[1]) << 16) |
                                   (static_cast<std::uint32_t>(source[2]) << 24);
        out[i] = static_cast<float>((std::bit_cast<std::int32_t>(word) >> 8) * step);
    }
}

/// Unpacks a rotation from x, y, z as bytes; w >= 0 follows.
std::array<double, 4> unpack_rotation_bytes(const std::byte* source) {
    std::array<double, 4> xyzw{};
    double rest = 1;
    for (std::size_t i = 0; i < 3; ++i) {
        xyzw[i] = std::to_integer<int>(source[i]) / 127.5 - 1;
        rest -= xyzw[i] * xyzw[i];
    }
    xyzw[3] = std::sqrt(std::max(0.0, rest));
    return xyzw;
}

/// Unpacks a rotation. Two bits name the largest of (x,y,z,w). The other three follow from high to low, a
/// sign and nine bits each.
std::array<double, 4> unpack_rotation_word(std::uint32_t word) {
    std::array<double, 4> xyzw{};
    const std::size_t largest = word >> 30;
    double rest = 1;
    int shift = 20;
    for (std::size_t i = 0; i < 4; ++i) {
        if (i == largest) continue;
        const std::uint32_t field = (word >> shift) & 1023;
        const double magnitude = (field & 511) / 511.0 / std::numbers::sqrt2;
        xyzw[i] = (field & 512) != 0 ? -magnitude : magnitude;
        rest -= magnitude * magnitude;
        shift -= 10;
    }
    xyzw[largest] = std::sqrt(std::max(0.0, rest));
    return xyzw;
}

void unpack_rotations(const Header& header, Bytes bytes, std::vector<float>& out) {
    for (std::size_t row = 0; row < out.size() / 4; ++row) {
        const std::byte* source = bytes.data() + row * header.rotation_bytes();
        const std::array<double, 4> q = header.version >= 3
                                            ? unpack_rotation_word(load_scalar<std::uint32_t>(source))
                                            : unpack_rotation_bytes(source);
        for (std::size_t i = 0; i < 4; ++i) out[row * 4 + i] = static_cast<float>(q[(i + 3) % 4]);
    }
}

GaussianData unpack(const Header& header, const Arrays& arrays) {
    GaussianData data;
    data.sh_degree = std::min(header.degree, MaxShDegree);
    data.resize(static_cast<std::size_t>(header.count));
    unpack_positions(header, arrays.position, data.position);
    unpack_rotations(header, arrays.rotation, data.rotation);
    const std::size_t kept = rest_of_degree(data.sh_degree) * 3;
    for (std::size_t row = 0; row < data.size(); ++row) {
        data.opacity_logit[row] = byte_logits()[std::to_integer<unsigned>(arrays.alpha[row])];
        float* sh = data.sh.data() + row * data.sh_stride();
        for (std::size_t i = 0; i < 3; ++i) {
            data.log_scale[row * 3 + i] =
                static_cast<float>(std::to_integer<int>(arrays.scale[row * 3 + i])) / 16 - 10;
            sh[i] = static_cast<float>((std::to_integer<int>(arrays.colour[row * 3 + i]) / 255.0 - 0.5) /
                                       SpzColourScale);
        }
        const std::byte* rest = arrays.sh.data() + row * header.sh_bytes();
        for (std::size_t i = 0; i < kept; ++i)
            sh[3 + i] = static_cast<float>(std::to_integer<int>(rest[i]) - 128) / 128;
    }
    return data;
}

/// Signs that take the stored frame to right, down, forward. Values 1 to 8 are right, up, front bits plus
/// one.
AxisSigns signs_of_frame(std::optional<std::uint32_t> frame, std::vector<std::string>& warnings) {
    if (frame && (*frame == 0 || *frame > LastAxisFlip)) {
        warnings.push_back(
            "the SPZ file states a coordinate system that is not handled; it is shown as stored");
        return {};
    }
    const std::uint32_t bits = frame.value_or(RightUpBack) - 1;
    return {(bits & 1) != 0 ? 1 : -1, (bits & 2) != 0 ? -1 : 1, (bits & 4) != 0 ? 1 : -1};
}

Scene make_scene(const Header& header, const Arrays& arrays, const Extensions& extensions) {
    Scene scene;
    scene.info.format = "spz";
    scene.info.antialiased = (header.flags & FlagAntialiased) != 0;
    if (header.degree > MaxShDegree)
        scene.info.warnings.push_back("spherical harmonics of degree 4 are cut to degree 3");
    if (const std::string warning = passed_over(header, extensions); !warning.empty())
        scene.info.warnings.push_back(warning);
    GaussianData data = unpack(header, arrays);
    flip_axes(data, signs_of_frame(extensions.frame, scene.info.warnings));
    scene.gaussians = GaussianSet(std::move(data));
    return scene;
}

/// Reads v1-v3, already out of the gzip stream.
Scene parse_flat(Bytes bytes) {
    const Header header = parse_header(bytes);
    if (header.version == 4) throw_bad_spz("of version 4 lies inside a gzip stream");
    const Bytes body = bytes.subspan(HeaderBytes);
    const Arrays arrays = split_arrays(header, body);
    const Bytes rest = body.subspan(static_cast<std::size_t>(header.count * header.row_bytes()));
    return make_scene(header, arrays,
                      (header.flags & FlagExtensions) != 0 ? parse_extensions(rest) : Extensions{});
}

/// Checks the claims of the streams and of the header's count before anything is unpacked.
void check_count(const Header& header, Bytes file) {
    const std::uint64_t splats = splat_bytes(header.count, std::min(header.degree, MaxShDegree));
    check_claim({splats + header.count * header.row_bytes(), file.size()},
                fmt::format("the SPZ file's {} splats", header.count));
}

Scene parse_gzip(Bytes bytes) {
    const std::vector<std::byte> start = inflate_gzip(bytes, HeaderBytes);
    const Header header = parse_header(start);
    const std::uint64_t size = HeaderBytes + header.count * header.row_bytes();
    check_count(header, bytes);
    return parse_flat(inflate_gzip(bytes, size + LargestExtensions));
}

Scene parse_streams(Bytes bytes) {
    const Header header = parse_header(bytes);
    if (bytes.size() < HeaderBytesV4) throw_bad_spz("ends inside its header");
    const std::uint64_t table = load_scalar<std::uint32_t>(bytes.data() + HeaderBytes);
    if (table < HeaderBytesV4 || table > bytes.size()) throw_bad_spz("places its table outside of itself");
    check_count(header, bytes);
    const std::array<std::uint64_t, 6> row_bytes = {header.position_bytes(), 1, 3, 3, header.rotation_bytes(),
                                                    header.sh_bytes()};
    std::array<std::vector<std::byte>, 6> streams;
    ByteReader toc(bytes.subspan(static_cast<std::size_t>(table)), "the SPZ file");
    ByteReader frames = toc;
    frames.skip(std::uint64_t{16} * header.streams);
    std::size_t used = 0;
    for (std::size_t i = 0; i < row_bytes.size(); ++i) {
        if (row_bytes[i] == 0) continue;
        if (used++ >= header.streams) throw_bad_spz("lacks some of its streams");
        const auto compressed = toc.read<std::uint64_t>();
        const auto raw = toc.read<std::uint64_t>();
        if (raw != header.count * row_bytes[i])
            throw_bad_spz(fmt::format("has a stream of {} bytes where {} splats need {}", raw, header.count,
                                      header.count * row_bytes[i]));
        streams[i] = decompress_zstd(frames.take(compressed), raw);
    }
    const Bytes extensions = bytes.subspan(HeaderBytesV4, static_cast<std::size_t>(table) - HeaderBytesV4);
    return make_scene(header, {streams[0], streams[1], streams[2], streams[3], streams[4], streams[5]},
                      parse_extensions(extensions));
}

bool is_bare(Bytes bytes) {
    return bytes.size() >= 4 && load_scalar<std::uint32_t>(bytes.data()) == SpzMagic;
}

/// Other scenes come in gzip streams too.
bool detect_spz(Bytes bytes) {
    if (!is_gzip(bytes)) return is_bare(bytes);
    try {
        return is_bare(inflate_gzip(bytes, sizeof SpzMagic));
    } catch (const Error&) { return false; }
}

Scene parse_spz(Bytes bytes) {
    if (is_gzip(bytes)) return parse_gzip(bytes);
    const bool streams = bytes.size() >= 8 && load_scalar<std::uint32_t>(bytes.data() + 4) >= 4;
    return streams ? parse_streams(bytes) : parse_flat(bytes);
}

FormatOption version_option() {
    return {.name = "spz_version",
            .help = "Version of a .spz: 3 (most programs read it), 4 (newest) or 2 (oldest)",
            .values = {{OldestSpzVersion, "Version 2", "For the oldest programs; rotations are coarser."},
                       {UsualSpzVersion, "3", "What most programs read."},
                       {NewestSpzVersion, "4", "The newest: not read by every program yet."}},
            .standard = UsualSpzVersion};
}

std::vector<std::uint32_t> write_chosen_spz(const Scene& scene, const SaveOptions& options,
                                            const TakePiece& take) {
    take(write_spz(scene, chosen_value(version_option(), options)));
    return {};
}

}  // namespace

SceneFormat spz_format() {
    return {.name = "spz",
            .title = "SPZ",
            .extensions = {".spz"},
            .mime = {.type = "model/x-spz",
                     .comment = "Gaussian splats (SPZ)",
                     .magic = {"NGSP"},
                     .magic_priority = 60,
                     .weight = 60},
            .detect = detect_spz,
            .read = parse_spz,
            .write = write_chosen_spz,
            .keeps_antialiasing = true,
            .options = {version_option()}};
}

}  // namespace gse::io
