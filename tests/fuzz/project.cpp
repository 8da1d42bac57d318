// Fuzz target: project files, and the parts inside them that the archive's checksums would shield. The first
// byte chooses: 'D' a delta, 'S' a whole set, 'A' absent rows, 'M' a packed member, 'J' the description;
// anything else is a whole file.
#include "engine/io/project/project_description.h"
#include "engine/io/project/project_file.h"
#include "engine/io/project/project_parts.h"
#include "tests/fuzz/fuzz_helpers.h"

namespace {

using namespace gse;

constexpr std::size_t MostRows = 2000;  // of the scene that stands in for the one a project refers to

/// A delta that was accepted applies to any set, and is written back as it came.
void exercise_delta(std::span<const std::byte> bytes) {
    const SceneDelta delta = io::decode_delta(bytes, 1, "the edit");
    const std::string again = io::encode_delta(delta);
    GSE_CHECK(again.size() == bytes.size() && std::memcmp(again.data(), bytes.data(), bytes.size()) == 0);
    GaussianData data;
    data.resize(10);
    const GaussianSet set(std::move(data));
    std::vector<RowId> ids;
    for (RowId id = 0; id < 10; ++id) ids.push_back(id);
    const auto [after, after_ids] = apply_delta(set, ids, delta);
    GSE_CHECK_EQ(after.size(), after_ids.size());
    GSE_CHECK(after.size() >= delta.added.size());
}

/// A view that was accepted is a camera that can be drawn from.
void exercise_description(std::string_view text) {
    const io::ProjectDescription description = io::parse_description(text);
    for (const View& view : description.views)
        GSE_CHECK(view.camera.width > 0 && view.camera.height > 0 && view.camera.fx > 0 &&
                  view.camera.fy > 0);
    const std::string once = io::write_description(description);
    const std::string twice = io::write_description(io::parse_description(once));
    GSE_CHECK(once == twice);
}

void exercise_file(std::span<const std::byte> bytes) {
    GaussianData data;
    data.resize(
        std::min<std::size_t>(MostRows, bytes.empty() ? 0 : std::to_integer<std::size_t>(bytes.back()) + 20));
    const GaussianSet base(std::move(data));
    const ProjectData project = parse_project(bytes, &base);
    const std::string packed = ProjectWriter().pack("x.gsep", project);
    const ProjectData again =
        parse_project({reinterpret_cast<const std::byte*>(packed.data()), packed.size()}, &base);
    GSE_CHECK(fuzz::same_bits(project.state.current.position(), again.state.current.position()));
    GSE_CHECK(*project.state.row_ids == *again.state.row_ids);
}

void exercise_any(std::span<const std::byte> bytes) {
    const auto rest = bytes.empty() ? bytes : bytes.subspan(1);
    io::UnpackBudget budget(rest.size());
    switch (bytes.empty() ? 0 : std::to_integer<int>(bytes[0])) {
        case 'D': return exercise_delta(rest);
        case 'S': return static_cast<void>(GaussianSet(io::decode_set(rest, "the scene")));
        case 'A': return static_cast<void>(io::decode_absent(rest, "the label"));
        case 'M': return static_cast<void>(io::unpack_member(rest, io::AnySize, budget, "the part"));
        case 'J': return exercise_description({reinterpret_cast<const char*>(rest.data()), rest.size()});
        default: return exercise_file(bytes);
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return fuzz::exercise([&] { exercise_any(fuzz::as_bytes(data, size)); });
}
