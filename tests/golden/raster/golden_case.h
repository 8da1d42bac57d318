// One rasterizer golden: a tiny reader of .safetensors files (F64, F32, I32, I64, BOOL) and the case it
// holds.
#pragma once

#include <algorithm>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "engine/base/file.h"
#include "engine/raster/plain.h"
#include "engine/scene/gaussian_set.h"
#include "tests/test_paths.h"

namespace gse::test {

/// The cases of the set, whatever they are called; none (after a [skip] line) when the set is not there.
inline std::vector<std::string> golden_names() {
    std::vector<std::string> names;
    if (!available(raster_goldens_folder())) return names;
    for (const auto& item : std::filesystem::directory_iterator(raster_goldens_folder()))
        if (item.path().extension() == ".safetensors") names.push_back(item.path().stem().string());
    if (names.empty()) throw std::runtime_error("no case in " + raster_goldens_folder().string());
    std::sort(names.begin(), names.end());
    return names;
}

/// All tensors of a file as doubles, whatever they were.
class Tensors {
public:
    explicit Tensors(const std::filesystem::path& path) : bytes_(read_file(path)) {
        std::uint64_t header = 0;
        std::memcpy(&header, bytes_.data(), 8);
        const auto json = nlohmann::json::parse(bytes_.substr(8, header));
        for (const auto& [name, entry] : json.items())
            if (name != "__metadata__") values_[name] = decode(entry, 8 + header);
    }
    const std::vector<double>& operator[](const std::string& name) const { return values_.at(name); }
    double number(const std::string& name) const { return values_.at(name).at(0); }

private:
    std::vector<double> decode(const nlohmann::json& entry, std::size_t base) const {
        const std::size_t begin = base + entry["data_offsets"][0].get<std::size_t>();
        const std::size_t end = base + entry["data_offsets"][1].get<std::size_t>();
        const std::string type = entry["dtype"];
        if (type == "F64") return widen<double>(begin, end);
        if (type == "F32") return widen<float>(begin, end);
        if (type == "I64") return widen<std::int64_t>(begin, end);
        if (type == "I32") return widen<std::int32_t>(begin, end);
        if (type == "BOOL") return widen<std::uint8_t>(begin, end);
        throw std::runtime_error("a golden has the type " + type);
    }
    template <class T> std::vector<double> widen(std::size_t begin, std::size_t end) const {
        std::vector<T> raw((end - begin) / sizeof(T));
        std::memcpy(raw.data(), bytes_.data() + begin, end - begin);
        return {raw.begin(), raw.end()};
    }

    std::string bytes_;
    std::map<std::string, std::vector<double>> values_;
};

/// Inputs, settings and reference results of a golden.
struct GoldenCase {
    explicit GoldenCase(const std::string& name)
        : tensors(raster_goldens_folder() / (name + ".safetensors")) {
        const auto& view = tensors["viewmat"];
        const auto& k = tensors["K"];
        camera.width = static_cast<int>(tensors.number("width"));
        camera.height = static_cast<int>(tensors.number("height"));
        camera.fx = k[0];
        camera.cx = k[2];
        camera.fy = k[4];
        camera.cy = k[5];
        camera.rotation = Mat3::from_rows(
            {view[0], view[1], view[2], view[4], view[5], view[6], view[8], view[9], view[10]});
        camera.translation = {view[3], view[7], view[11]};
        settings.near_plane = static_cast<float>(tensors.number("near_plane"));
        settings.far_plane = static_cast<float>(tensors.number("far_plane"));
        settings.blur_px2 = static_cast<float>(tensors.number("eps2d"));
        for (std::size_t c = 0; c < 3; ++c)
            settings.background[c] = static_cast<float>(tensors["background"][c]);
        data.sh_degree = static_cast<int>(tensors.number("sh_degree"));
        data.position = narrow("means");
        data.log_scale = narrow("log_scales");
        data.rotation = narrow("quats");
        data.opacity_logit = narrow("logit_opacities");
        data.sh = narrow("sh");
        wide = {data.size(),           data.sh_degree,   tensors["means"],
                tensors["log_scales"], tensors["quats"], tensors["logit_opacities"],
                tensors["sh"]};
    }
    raster::plain::View view() const {
        const auto& b = tensors["background"];
        return {camera, settings, tensors.number("eps2d"), {b[0], b[1], b[2]}, eye()};
    }
    /// Inverse of the view matrix applied to the origin; its rotation is rounded to float, so not exactly
    /// orthogonal.
    Vec3 eye() const {
        const Mat3& r = camera.rotation;
        const Vec3 a = r.row(0), b = r.row(1), c = r.row(2);
        const Vec3& t = camera.translation;
        return (cross(b, c) * t.x + cross(c, a) * t.y + cross(a, b) * t.z) / -dot(a, cross(b, c));
    }
    std::vector<float> narrow(const std::string& name) const {
        return {tensors[name].begin(), tensors[name].end()};
    }

    Tensors tensors;
    Camera camera;
    raster::Settings settings;
    GaussianData data;
    raster::plain::Inputs wide;
};

/// Norm of the difference over the norm of the expectation.
template <class A> double relative_l2(const A& found, const std::vector<double>& expected) {
    double difference = 0, size = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
        const double d = static_cast<double>(found[i]) - expected[i];
        difference += d * d;
        size += expected[i] * expected[i];
    }
    return found.size() == expected.size() ? std::sqrt(difference / std::max(size, 1e-300)) : INFINITY;
}

/// Largest absolute difference over the pixels that no float version may decide differently.
template <class A>
double clear_pixel_error(const A& found, const std::vector<double>& expected,
                         const std::vector<double>& ambiguous) {
    if (found.size() != expected.size()) return INFINITY;
    const std::size_t channels = expected.size() / ambiguous.size();
    double worst = 0;
    for (std::size_t i = 0; i < expected.size(); ++i)
        if (ambiguous[i / channels] == 0)
            worst = std::max(worst, std::abs(static_cast<double>(found[i]) - expected[i]));
    return worst;
}

}  // namespace gse::test
