// GaussianSplats3D .ksplat (version 0.1): sections of buckets, positions relative to the centre of their
// bucket.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/error.h"
#include "engine/io/bytes/byte_reader.h"
#include "engine/io/bytes/claims.h"
#include "engine/io/bytes/encoding.h"
#include "engine/io/bytes/half.h"
#include "engine/io/formats/scene_format.h"

namespace gse::io {
namespace {

constexpr std::size_t HeaderBytes = 4096;
constexpr std::size_t SectionHeaderBytes = 1024;
constexpr float UsualShRange = 1.5f;

struct Header {
    std::uint32_t max_sections = 0;
    std::uint16_t level = 0;  // 0 floats, 1 halves, 2 bytes for SH
    float sh_low = 0, sh_high = 0;
};

struct Section {
    std::uint64_t count = 0, max_count = 0, bucket_size = 0, buckets = 0, bucket_bytes = 0;
    std::uint64_t full_buckets = 0, partial_buckets = 0;
    double block = 0, range = 0;
    int degree = 0;

    std::uint64_t row_bytes(std::uint16_t level) const {
        const std::uint64_t rest = rest_of_degree(degree) * 3;
        return level == 0 ? 44 + 4 * rest : 24 + (level == 1 ? 2 : 1) * rest;
    }
};

[[noreturn]] void throw_malformed_ksplat(const std::string& what) {
    throw Error(ErrorCode::Malformed, "the .ksplat file " + what,
                "the file is cut off or damaged; get it again");
}

Header parse_header(Bytes bytes) {
    if (bytes.size() < HeaderBytes) throw_malformed_ksplat("ends inside its header");
    const std::byte* source = bytes.data();
    if (std::to_integer<int>(source[0]) != 0 || std::to_integer<int>(source[1]) < 1)
        throw Error(ErrorCode::Unsupported, "this is not a .ksplat file of version 0.1");
    Header header;
    header.max_sections = load_scalar<std::uint32_t>(source + 4);
    header.level = load_scalar<std::uint16_t>(source + 20);
    header.sh_low = load_scalar<float>(source + 36);
    header.sh_high = load_scalar<float>(source + 40);
    if (header.sh_low == 0) header.sh_low = -UsualShRange;
    if (header.sh_high == 0) header.sh_high = UsualShRange;
    if (header.level > 2) throw_malformed_ksplat(fmt::format("claims compression level {}", header.level));
    return header;
}

Section parse_section(Bytes bytes) {
    const std::byte* source = bytes.data();
    Section section;
    section.count = load_scalar<std::uint32_t>(source);
    section.max_count = load_scalar<std::uint32_t>(source + 4);
    section.bucket_size = load_scalar<std::uint32_t>(source + 8);
    section.buckets = load_scalar<std::uint32_t>(source + 12);
    section.block = static_cast<double>(load_scalar<float>(source + 16));
    section.bucket_bytes = load_scalar<std::uint16_t>(source + 20);
    section.range = load_scalar<std::uint32_t>(source + 24);
    if (section.range == 0) section.range = 32767;
    section.full_buckets = load_scalar<std::uint32_t>(source + 32);
    section.partial_buckets = load_scalar<std::uint32_t>(source + 36);
    section.degree = load_scalar<std::uint16_t>(source + 40);
    if (section.degree > 2) throw_malformed_ksplat(fmt::format("claims SH degree {}", section.degree));
    if (section.count > section.max_count)
        throw_malformed_ksplat("has a section with more splats than it says it may");
    return section;
}

/// Bucket number of each splat: full buckets first, then the partial ones with their stated lengths.
class BucketWalk {
public:
    BucketWalk(const Section& section, Bytes lengths) : section_(section), lengths_(lengths) {}

    std::uint64_t bucket_of(std::uint64_t row) {
        const std::uint64_t in_full = section_.full_buckets * section_.bucket_size;
        if (row < in_full) return row / section_.bucket_size;
        while (partial_ < section_.partial_buckets && row >= in_full + passed_ + length(partial_))
            passed_ += length(partial_++);
        return section_.full_buckets + partial_;
    }

private:
    std::uint64_t length(std::uint64_t partial) const {
        return load_scalar<std::uint32_t>(lengths_.data() + partial * 4);
    }
    const Section& section_;
    Bytes lengths_;
    std::uint64_t partial_ = 0, passed_ = 0;
};

/// A value of the section's SH storage at `source`.
float load_sh(const Header& header, const std::byte* source, std::size_t index) {
    if (header.level == 0) return load_scalar<float>(source + 4 * index);
    if (header.level == 1) return half_to_float(load_scalar<std::uint16_t>(source + 2 * index));
    const auto code = static_cast<float>(std::to_integer<int>(source[index]));
    return header.sh_low + (header.sh_high - header.sh_low) * code / 255;
}

/// Coefficients of a row. The file is band-major, then channel-major: rrr ggg bbb of band 1, then rrrrr ggggg
/// bbbbb of band 2.
void read_sh(const Header& header, const std::byte* source, int degree, float* sh) {
    std::size_t index = 0, first = 1;
    for (int band = 1; band <= degree; ++band) {
        const auto size = static_cast<std::size_t>(2 * band + 1);
        for (std::size_t channel = 0; channel < 3; ++channel)
            for (std::size_t k = 0; k < size; ++k)
                sh[(first + k) * 3 + channel] = load_sh(header, source, index++);
        first += size;
    }
}

void read_row(const Header& header, const Section& section, const std::byte* source, const std::byte* centre,
              GaussianData& data, std::size_t row) {
    std::array<float, 3> scale{};
    const auto value = [&](std::size_t at_float, std::size_t at_half, std::size_t i) {
        return header.level == 0 ? load_scalar<float>(source + at_float + 4 * i)
                                 : half_to_float(load_scalar<std::uint16_t>(source + at_half + 2 * i));
    };
    for (std::size_t i = 0; i < 3; ++i) {
        if (header.level == 0) {
            data.position[row * 3 + i] = load_scalar<float>(source + 4 * i);
        } else {
            const double code = load_scalar<std::uint16_t>(source + 2 * i);
            const double origin =
                centre != nullptr ? static_cast<double>(load_scalar<float>(centre + 4 * i)) : 0;
            data.position[row * 3 + i] =
                static_cast<float>((code - section.range) * (section.block / 2 / section.range) + origin);
        }
        scale[i] = value(12, 6, i);
        const float log_scale = std::log(scale[i]);
        data.log_scale[row * 3 + i] = log_scale < FlattestLogScale ? FlattestLogScale : log_scale;
    }
    for (std::size_t i = 0; i < 4; ++i) data.rotation[row * 4 + i] = value(24, 12, i);
    const std::byte* colour = source + (header.level == 0 ? 40 : 20);
    float* sh = data.sh.data() + row * data.sh_stride();
    for (std::size_t i = 0; i < 3; ++i)
        sh[i] = static_cast<float>(sh_from_colour(std::to_integer<int>(colour[i]) / 255.0));
    data.opacity_logit[row] = byte_logits()[std::to_integer<unsigned>(colour[3])];
    read_sh(header, colour + 4, section.degree, sh);
}

void read_section(const Header& header, const Section& section, ByteReader& reader, GaussianData& data) {
    const std::uint64_t row_bytes = section.row_bytes(header.level);
    const Bytes lengths = reader.take(section.partial_buckets * 4);
    const Bytes centres = reader.take(saturating_product(section.bucket_bytes, section.buckets));
    const Bytes rows = reader.take(saturating_product(section.max_count, row_bytes));
    BucketWalk walk(section, lengths);
    const std::size_t first = data.size();
    data.resize(first + static_cast<std::size_t>(section.count));
    for (std::uint64_t row = 0; row < section.count; ++row) {
        const std::byte* centre = nullptr;
        if (header.level > 0 && section.bucket_bytes >= 12) {
            const std::uint64_t bucket = walk.bucket_of(row);
            if (bucket < section.buckets) centre = centres.data() + bucket * section.bucket_bytes;
        }
        read_row(header, section, rows.data() + row * row_bytes, centre, data,
                 first + static_cast<std::size_t>(row));
    }
}

Scene parse_ksplat(Bytes bytes) {
    const Header header = parse_header(bytes);
    ByteReader reader(bytes, "the .ksplat file");
    reader.skip(HeaderBytes);
    const Bytes headers = reader.take(saturating_product(header.max_sections, SectionHeaderBytes));
    std::vector<Section> sections;
    GaussianData data;
    for (std::size_t i = 0; i < header.max_sections;
         ++i) {  // unused ones are zero; some writers leave `sections` 0
        sections.push_back(parse_section(headers.subspan(i * SectionHeaderBytes, SectionHeaderBytes)));
        data.sh_degree = std::max(data.sh_degree, sections.back().degree);
    }
    std::uint64_t count = 0;
    for (const Section& section : sections) count += section.count;
    check_claim({splat_bytes(count, data.sh_degree), bytes.size()},
                fmt::format("the .ksplat file's {} splats", count));
    for (const Section& section : sections) read_section(header, section, reader, data);
    if (data.size() == 0) throw_malformed_ksplat("holds no splats");
    Scene scene;
    scene.info.format = "ksplat";
    scene.gaussians = GaussianSet(std::move(data));
    return scene;
}

}  // namespace

SceneFormat ksplat_format() {
    return {.name = "ksplat",
            .title = ".ksplat",
            .extensions = {".ksplat"},
            .mime = {.type = "model/x-ksplat", .comment = "Gaussian splats (.ksplat)"},
            .read = parse_ksplat};
}

}  // namespace gse::io
