// The document gives each part its place, in a world that is turned by half a turn about z.
#include "engine/io/scene/supersplat_project.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "engine/base/error.h"
#include "engine/base/json.h"
#include "engine/base/printable.h"
#include "engine/io/bytes/placed_sets.h"

namespace gse::io {
namespace {

using Json = nlohmann::json;

constexpr const char* Document = "document.json";
constexpr std::uint64_t LargestDocument = std::uint64_t{64} << 20;  // bytes; poses and keys of a film
constexpr std::uint64_t AnyPart = ~std::uint64_t{0};
constexpr const char* DamagedHint = "the file is cut off or damaged; save the project again";
constexpr double SmallestScale = 1e-9;  // smaller or larger by more is damage, and no place has an inverse
const Quat HalfTurn(0, 0, 0, 1);        // about z, as every part is shown there

std::string part_name(std::size_t index) { return fmt::format("splat_{}.ply", index); }

/// Numbers of a setting, or those that it has when nothing is said.
template <std::size_t N>
std::array<double, N> numbers_of(const Json& part, const char* key, std::array<double, N> usual) {
    const auto found = part.find(key);
    if (found == part.end() || found->is_null()) return usual;
    std::array<double, N> numbers{};
    if (!found->is_array() || found->size() != N) numbers.fill(std::nan(""));
    else
        for (std::size_t i = 0; i < N; ++i)
            numbers[i] = found->at(i).is_number() ? found->at(i).get<double>() : std::nan("");
    if (std::any_of(numbers.begin(), numbers.end(), [](double number) { return !std::isfinite(number); }))
        throw Error(ErrorCode::Malformed,
                    fmt::format("the SuperSplat project gives a part a {} that is not {} numbers", key, N),
                    DamagedHint);
    return numbers;
}

/// Place of a part in the frame of its file.
Placement placement_of(const Json& part) {
    const auto position = numbers_of<3>(part, "position", {0, 0, 0});
    const auto rotation = numbers_of<4>(part, "rotation", {0, 0, 1, 0});
    const auto scale = numbers_of<3>(part, "scale", {1, 1, 1});
    const Quat turned(rotation[3], rotation[0], rotation[1], rotation[2]);
    if (!(glm::length(turned) > 0) || std::any_of(scale.begin(), scale.end(), [](double s) {
            return !(s >= SmallestScale && s <= 1 / SmallestScale);
        }))
        throw Error(ErrorCode::Malformed, "the SuperSplat project gives a part no rotation or no size",
                    DamagedHint);
    const Quat back = glm::conjugate(HalfTurn);
    Placement placement;
    placement.rotation = back * glm::normalize(turned);
    placement.scale = {scale[0], scale[1], scale[2]};
    placement.position = rotation_matrix(back) * Vec3{position[0], position[1], position[2]};
    return placement;
}

/// True when the colours of the part are graded in the project.
bool is_graded(const Json& part) {
    const auto differs = [&](const char* key, double usual) {
        const auto found = part.find(key);
        return found != part.end() && found->is_number() && found->get<double>() != usual;
    };
    const std::array<double, 4> white = {1, 1, 1, 1};
    return numbers_of<4>(part, "tintClr", white) != white || differs("temperature", 0) ||
           differs("saturation", 1) || differs("brightness", 0) || differs("blackPoint", 0) ||
           differs("whitePoint", 1) || differs("transparency", 1);
}

Json document_of(const PartFiles& files) {
    const auto bytes = files.read(Document, LargestDocument);
    Json json = parse_json({reinterpret_cast<const char*>(bytes.data()), bytes.size()},
                           "the document of the SuperSplat project", DamagedHint);
    const bool parts = json.is_object() && json.contains("splats") && json["splats"].is_array();
    if (!parts || json["splats"].empty())
        throw Error(ErrorCode::Malformed, "the SuperSplat project holds no splats", DamagedHint);
    for (const Json& part : json["splats"])
        if (!part.is_object())
            throw Error(ErrorCode::Malformed,
                        "the document of the SuperSplat project lists something else "
                        "than parts",
                        DamagedHint);
    return json;
}

bool is_hidden(const Json& part) {
    const auto visible = part.find("visible");
    return visible != part.end() && visible->is_boolean() && !visible->get<bool>();
}

}  // namespace

std::unique_ptr<PartFiles> supersplat_project_in(const PartArchive& files) {
    std::set<std::string> names;
    for (const ZipEntry& entry : files.entries()) names.insert(entry.name);
    for (const std::string& name : names) {
        const std::string folder = name.substr(0, name.rfind('/') + 1);
        if (name == folder + Document && names.contains(folder + part_name(0))) return files.below(folder);
    }
    return nullptr;
}

Scene read_supersplat_project(const PartFiles& files, const Wrapping& wrapping) {
    const Json document = document_of(files);
    const Json& parts = document["splats"];
    const bool all_hidden = std::all_of(parts.begin(), parts.end(), is_hidden);
    JoinedScene joined;
    std::size_t hidden = 0;
    bool graded = false;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        if (!all_hidden && is_hidden(parts[i])) {
            ++hidden;
            continue;
        }
        const Placement placement = placement_of(parts[i]);
        Scene part = read_content(files.read(part_name(i), AnyPart), part_name(i), wrapping);
        if (!placement.identity()) {
            GaussianData data = part.gaussians.to_data();
            place(data, placement);
            part.gaussians = GaussianSet(std::move(data));
        }
        graded = graded || is_graded(parts[i]);
        joined.add(std::move(part));
    }
    if (hidden > 0)
        joined.warn(hidden == 1
                        ? "a hidden part of the SuperSplat project is left out"
                        : fmt::format("{} hidden parts of the SuperSplat project are left out", hidden));
    if (graded)
        joined.warn(
            "the colour settings of the SuperSplat project are not applied: colours are those "
            "of its files");
    return joined.take();
}

}  // namespace gse::io
