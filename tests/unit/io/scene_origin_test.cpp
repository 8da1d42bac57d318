// Facts of files that scenes keep: large coordinates, further columns, activated values.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "engine/scene/origin/world_offset.h"
#include "tests/unit/io/io_helpers.h"
#include "tests/unit/io/ply_columns.h"
#include "tests/unit/io/project_helpers.h"

namespace scene_origin_test {

using namespace gse;
using namespace gse::test;

namespace {

constexpr std::size_t Rows = 60;
constexpr double Rounding = 1e-6;  // of a float below 8, twice
const Vec3 Utm{455123, 5410987, 321};

Scene read(const std::string& bytes) { return parse_scene(as_bytes(bytes), "x.ply"); }

/// The columns of these splats, moved to the coordinates of a world in doubles.
std::vector<Column> far_columns(const GaussianData& data, const Vec3& offset, int double_axes = 3) {
    std::vector<Column> columns = columns_of(data);
    for (int axis = 0; axis < 3; ++axis) {
        Column& one = columns[static_cast<std::size_t>(axis)];
        if (axis < double_axes) one.type = "double";
        one.value = [near = one.value, by = offset[axis]](std::size_t row) { return near(row) + by; };
    }
    return columns;
}

/// Largest difference between the columns' positions and the scene's in their world.
double positions_off(const Scene& scene, const std::vector<Column>& columns, int axes = 3) {
    double worst = 0;
    for (std::size_t row = 0; row < scene.gaussians.size(); ++row)
        for (int axis = 0; axis < axes; ++axis) {
            const auto i = static_cast<std::size_t>(axis);
            const double there =
                static_cast<double>(scene.gaussians.position()[row * 3 + i]) + scene.info.offset[axis];
            worst = std::max(worst, std::abs(there - columns[i].value(row)));
        }
    return worst;
}

/// The numbers of column `name`, read with nothing but the header's types.
std::vector<double> column_of(const std::string& bytes, const std::string& name) {
    const std::size_t body = bytes.find("end_header\n") + 11;
    std::size_t stride = 0, offset = 0;
    std::string type;
    for (std::size_t at = 0; (at = bytes.find("property ", at)) < body; at += 9) {
        const std::string line = bytes.substr(at + 9, bytes.find('\n', at) - at - 9);
        const std::string kind = line.substr(0, line.find(' '));
        if (line.substr(line.find(' ') + 1) == name) {
            offset = stride;
            type = kind;
        }
        stride += kind == "double"                    ? 8
                  : kind == "uchar" || kind == "char" ? 1
                  : kind.ends_with("short")           ? 2
                                                      : 4;
    }
    std::vector<double> values;
    for (std::size_t at = body + offset; !type.empty() && at < bytes.size(); at += stride) {
        const auto load = [&](auto value) {
            std::memcpy(&value, bytes.data() + at, sizeof value);
            values.push_back(static_cast<double>(value));
        };
        if (type == "double") load(double{});
        else if (type == "float") load(float{});
        else if (type == "uchar") load(std::uint8_t{});
        else if (type == "short") load(std::int16_t{});
        else load(std::int32_t{});
    }
    return values;
}

}  // namespace

// Large coordinates

DOCTEST_TEST_CASE("UTM coordinates in doubles are kept to the millimetre and written back as doubles") {
    const auto folder = data_folder() / "odd/09_utm_double_ply";
    if (!available(folder)) return;
    const auto truth = nlohmann::json::parse(read_file(folder / "ply10.truth.json"));
    ScratchFolder scratch;
    const auto first = scratch.path() / "a.ply", second = scratch.path() / "b.ply";
    const Scene scene = load_scene(folder / "ply10_utm_double.ply");
    DOCTEST_CHECK(length(scene.info.offset - Utm) < 2);
    save_scene(first, scene);
    double worst = 0;
    for (const char* axis : {"x", "y", "z"}) {
        const auto values = column_of(read_file(first), axis);
        DOCTEST_REQUIRE(values.size() == truth.size());
        for (std::size_t row = 0; row < values.size(); ++row)
            worst = std::max(worst, std::abs(values[row] - truth[row].at(axis).get<double>()));
    }
    DOCTEST_CHECK(worst < Rounding);
    const Scene again = load_scene(first);
    DOCTEST_CHECK(same_bits(again.gaussians, scene.gaussians));
    save_scene(second, again);
    DOCTEST_CHECK(read_file(first) == read_file(second));
}

DOCTEST_TEST_CASE("an offset is taken off doubles in every encoding, and off nothing that is near") {
    const GaussianData data = random_gaussians(Rows, 1, 9);
    for (const Encoding encoding : {Encoding::Ascii, Encoding::Little, Encoding::Big})
        for (const Vec3& offset : {Utm, Vec3{-4e6, 1.25e6, 4.7e6}, Vec3{0, 0, 1500}}) {
            FileShape shape;
            shape.encoding = encoding;
            const auto columns = far_columns(data, offset);
            const Scene scene = read(make_ply(columns, Rows, shape));
            DOCTEST_CHECK(has_offset(scene.info.offset));
            DOCTEST_CHECK(length(scene.info.offset - offset) < 4);
            DOCTEST_CHECK(positions_off(scene, columns) < Rounding);
            DOCTEST_CHECK(!scene.info.warnings.empty());
            const std::string written = written_as("ply", scene);
            DOCTEST_CHECK(written.find("property double x") != std::string::npos);
            DOCTEST_CHECK(positions_off(read(written), columns) < Rounding);
        }
    const auto near = far_columns(data, {3, -2, 500});
    const Scene scene = read(make_ply(near, Rows, {}));
    DOCTEST_CHECK_FALSE(has_offset(scene.info.offset));
    DOCTEST_CHECK(written_as("ply", scene).find("double") == std::string::npos);
    const auto floats = far_columns(data, Utm, 0);  // rounded in the file already
    DOCTEST_CHECK_FALSE(has_offset(read(make_ply(floats, Rows, {})).info.offset));
    DOCTEST_CHECK(has_offset(read(make_ply(far_columns(data, Utm, 1), Rows, {})).info.offset));
}

DOCTEST_TEST_CASE("a far scene that is written and read again is the same bit for bit") {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        GaussianData data =
            random_gaussians(Rows, 0, seed, std::pow(10.0, static_cast<double>(seed % 8) - 4));
        data.position[6] = 0;
        auto columns = far_columns(data, Utm + Vec3{0.1234567, 0.5, -0.499999});
        columns[0].value = [sound = columns[0].value](std::size_t row) {
            return row == 5 ? 0.0 : sound(row);
        };
        const Scene scene = read(make_ply(columns, Rows, {}));
        const std::string written = written_as("ply", scene);
        DOCTEST_CHECK(same_bits(read(written).gaussians, scene.gaussians));
        DOCTEST_CHECK(written_as("ply", read(written)) == written);
    }
}

DOCTEST_TEST_CASE("coordinates of no world are read as before") {
    const GaussianData data = random_gaussians(Rows, 0, 30);
    for (const double far : {1e12, 1e300})
        DOCTEST_CHECK_FALSE(has_offset(read(make_ply(far_columns(data, {far, 0, 0}), Rows, {})).info.offset));
}

DOCTEST_TEST_CASE("positions that are not numbers do not move the offset") {
    const GaussianData data = random_gaussians(Rows, 0, 10);
    auto columns = far_columns(data, Utm);
    columns[0].value = [sound = columns[0].value](std::size_t row) { return row == 3 ? NAN : sound(row); };
    columns[1].value = [sound = columns[1].value](std::size_t row) {
        return row == 4 ? HUGE_VAL : sound(row);
    };
    const Scene scene = read(make_ply(columns, Rows, {}));
    DOCTEST_CHECK(length(scene.info.offset - Utm) < 4);
    DOCTEST_CHECK(std::isnan(scene.gaussians.position()[9]));
    DOCTEST_CHECK(std::isinf(scene.gaussians.position()[13]));
}

DOCTEST_TEST_CASE("a part of a scene keeps the offset of the whole") {
    const GaussianData data = random_gaussians(Rows, 0, 11);
    Scene scene = read(make_ply(far_columns(data, Utm), Rows, {}));
    std::vector<unsigned char> keep(Rows, 0);
    for (std::size_t row = 0; row < Rows; ++row) keep[row] = data.position[row * 3] > 1.5f ? 1 : 0;
    scene.gaussians = scene.gaussians.filtered(keep);
    const Scene part = read(written_as("ply", scene));
    DOCTEST_CHECK(part.info.offset == scene.info.offset);
    DOCTEST_CHECK(largest_difference(part.gaussians.position(), scene.gaussians.position()) < Rounding);
}

DOCTEST_TEST_CASE("formats of floats hold the positions less the offset; compressed PLY says it") {
    ScratchFolder scratch;
    const GaussianData data = random_gaussians(Rows, 0, 12);
    const Scene scene = read(make_ply(far_columns(data, Utm), Rows, {}));
    for (const char* name : {"a.compressed.ply", "a.spz", "a.splat"}) {
        save_scene(scratch.path() / name, scene);
        const Scene back = load_scene(scratch.path() / name);
        DOCTEST_CAPTURE(name);
        for (const float value : back.gaussians.position()) DOCTEST_CHECK(std::abs(value) < 8);
        DOCTEST_CHECK(has_offset(back.info.offset) == std::string(name).ends_with(".ply"));
    }
    DOCTEST_CHECK(load_scene(scratch.path() / "a.compressed.ply").info.offset == scene.info.offset);
}

DOCTEST_TEST_CASE("cameras and paths of the world look at the moved scene as before") {
    const View view = random_view(3);
    const Vec3 point{0.3, -0.2, 0.7};
    const auto there = moved(std::vector<View>{view}, Utm);
    DOCTEST_CHECK(length(there[0].camera.to_camera(point + Utm) - view.camera.to_camera(point)) < Rounding);
    DOCTEST_CHECK(length(there[0].camera.centre() - view.camera.centre() - Utm) < Rounding);
    const auto back = moved(there, -Utm);
    DOCTEST_CHECK(length(back[0].camera.translation - view.camera.translation) < Rounding);
    const auto keys = moved(std::vector<CameraKey>{{1.5, view.camera, Easing::In}}, Utm);
    DOCTEST_CHECK(keys[0].camera == there[0].camera);
    DOCTEST_CHECK(keys[0].time == 1.5);
}

DOCTEST_TEST_CASE("a project keeps the offset, and its edits where a file is opened with another one") {
    ScratchFolder scratch;
    const auto path = scratch.path() / "far.ply";
    const GaussianData data = random_gaussians(Rows, 0, 13);
    const auto columns = far_columns(data, Utm);
    write_file(path, make_ply(columns, Rows, {}));
    const Scene scene = load_scene(path);
    ProjectData project;
    project.source = scene_source(path, scene.gaussians);
    project.state = initial_state(scene, {random_view(1)});
    save_project(scratch.path() / "a.gsep", project);
    const Scene shown = load_scene(scratch.path() / "a.gsep");
    DOCTEST_CHECK(shown.info.offset == scene.info.offset);
    DOCTEST_CHECK(positions_off(shown, columns) < Rounding);
    DOCTEST_CHECK(load_project(scratch.path() / "a.gsep").state.views[0].camera == random_view(1).camera);
    project.state.info.offset = scene.info.offset + Vec3{1, -2, 4};  // as another version may choose it
    save_project(scratch.path() / "b.gsep", project);
    const Scene other = load_scene(scratch.path() / "b.gsep");
    DOCTEST_CHECK(other.info.offset == project.state.info.offset);
    DOCTEST_CHECK(positions_off(other, columns) < Rounding);
    DOCTEST_CHECK(written_as("ply", other).find("property double y") != std::string::npos);
}

// Further columns

namespace {

/// Columns of every kind that no attribute takes.
std::vector<Column> further_columns() {
    return {{"object_id", "int", [](std::size_t row) { return 70'000'001.0 + static_cast<double>(row); }},
            {"intensity", "uchar", [](std::size_t row) { return static_cast<double>(row * 4 % 256); }},
            {"time", "double", [](std::size_t row) { return 1.7e9 + 1e-3 * static_cast<double>(row); }},
            {"scalar_density", "float", [](std::size_t row) { return 0.1f * static_cast<float>(row); }},
            {"class", "short", [](std::size_t row) { return -3.0 + static_cast<double>(row); }}};
}

Scene scene_with_columns(const GaussianData& data, const FileShape& shape = {}) {
    std::vector<Column> columns = columns_of(data);
    const auto further = further_columns();
    columns.insert(columns.begin() + 4, further.begin(), further.end());
    return read(make_ply(columns, data.size(), shape));
}

/// Checks written columns: row i holds what row sources[i] of the file held, 0 for -1.
void check_columns(const std::string& written, const std::vector<int>& sources) {
    for (const Column& column : further_columns()) {
        DOCTEST_CAPTURE(column.name);
        DOCTEST_CHECK(written.find("property " + column.type + " " + column.name + "\n") !=
                      std::string::npos);
        const auto values = column_of(written, column.name);
        DOCTEST_REQUIRE(values.size() == sources.size());
        bool same = true;
        for (std::size_t row = 0; row < values.size(); ++row)
            same =
                same && values[row] ==
                            (sources[row] < 0 ? 0.0 : column.value(static_cast<std::size_t>(sources[row])));
        DOCTEST_CHECK(same);
    }
}

std::vector<int> all_rows(std::size_t count) {
    std::vector<int> rows(count);
    for (std::size_t row = 0; row < count; ++row) rows[row] = static_cast<int>(row);
    return rows;
}

}  // namespace

DOCTEST_TEST_CASE("columns that no attribute takes go from PLY to PLY in their own type") {
    ScratchFolder scratch;
    const GaussianData data = random_gaussians(Rows, 1, 15);
    for (const Encoding encoding : {Encoding::Ascii, Encoding::Little, Encoding::Big})
        for (const bool list_inside : {false, true}) {
            FileShape shape;
            shape.encoding = encoding;
            shape.list_inside = list_inside;
            const Scene scene = scene_with_columns(data, shape);
            const std::string written = written_as("ply", scene);
            check_columns(written, all_rows(Rows));
            DOCTEST_CHECK(same_bits(read(written).gaussians, GaussianSet(data)));
            DOCTEST_CHECK(written_as("ply", read(written)) == written);
            DOCTEST_CHECK(scene.info.lists.size() == (list_inside ? 1u : 0u));
        }
    write_file(scratch.path() / "a.ply", written_as("ply", scene_with_columns(data)));
    check_columns(written_as("ply", load_scene(scratch.path() / "a.ply")), all_rows(Rows));  // read in pieces
}

DOCTEST_TEST_CASE("normals are kept where they are not zero") {
    const GaussianData data = random_gaussians(Rows, 0, 16);
    for (const double size : {0.0, 1.0}) {
        std::vector<Column> columns = columns_of(data);
        for (const char* name : {"nx", "ny", "nz"})
            columns.push_back(
                {name, "float", [size](std::size_t row) { return size * static_cast<double>(row); }});
        const Scene scene = read(make_ply(columns, Rows, {}));
        DOCTEST_CHECK(scene.extra.size() == (size > 0 ? 3u : 0u));
        DOCTEST_CHECK(column_of(written_as("ply", scene), "ny")[7] == size * 7);
    }
}

DOCTEST_TEST_CASE(
    "colours and prefixed fields beside the attributes are kept, those taken as attributes are not") {
    const GaussianData data = random_gaussians(Rows, 1, 17);
    std::vector<Column> columns = columns_of(data);
    for (Column& one : columns)
        if (one.name.size() > 1) one.name.insert(0, "scalar_");
    columns.push_back({"scalar_filter_3D", "float", [](std::size_t) { return 0.01; }});
    columns.push_back({"red", "uchar", [](std::size_t row) { return static_cast<double>(row); }});
    columns.push_back(
        {"scalar_Classification", "float", [](std::size_t row) { return static_cast<double>(row); }});
    const Scene scene = read(make_ply(columns, Rows, {}));
    DOCTEST_CHECK(names_of(scene.extra) == std::vector<std::string>{"red", "scalar_Classification"});
}

DOCTEST_TEST_CASE("a label column of numbers that are no label stays, unless a label is written") {
    const GaussianData data = random_gaussians(Rows, 0, 26);
    std::vector<Column> columns = columns_of(data);
    columns.push_back({"label", "uchar", [](std::size_t row) { return static_cast<double>(row % 7); }});
    const Scene scene = read(make_ply(columns, Rows, {}));
    DOCTEST_CHECK(column_of(written_as("ply", scene), "label")[13] == 6);
    SaveOptions options;
    options.from_label = &scene.labels.labels.at(0);
    const std::string labelled = written_as("ply", scene, options);
    DOCTEST_CHECK(column_of(labelled, "label")[13] == 1);
    DOCTEST_CHECK(read(labelled).extra.empty());
}

DOCTEST_TEST_CASE("rows that stay keep their columns through edits, new ones get zeros") {
    const GaussianData data = random_gaussians(Rows, 0, 18);
    const Scene scene = scene_with_columns(data);
    DocumentState state = initial_state(scene, {});
    const auto edit = [&](std::uint64_t seed) {
        EditNode node = random_node(state, seed);
        state = with_edit(state, node);
    };
    edit(1);
    edit(2);
    std::vector<int> sources;
    for (const RowId id : *state.row_ids) sources.push_back(id < Rows ? static_cast<int>(id) : -1);
    DOCTEST_REQUIRE(std::find(sources.begin(), sources.end(), -1) != sources.end());
    Scene edited;
    edited.gaussians = state.current;
    edited.extra = current_columns(state);
    check_columns(written_as("ply", edited), sources);
    state = with_stack(state, {});
    edited.gaussians = state.current;
    edited.extra = current_columns(state);
    check_columns(written_as("ply", edited), all_rows(Rows));
}

DOCTEST_TEST_CASE("projects keep the columns, of a file and of a scene that they hold themselves") {
    ScratchFolder scratch;
    const GaussianData data = random_gaussians(Rows, 0, 19);
    const auto path = scratch.path() / "scene.ply";
    write_file(path, written_as("ply", scene_with_columns(data)));
    const Scene scene = load_scene(path);
    for (const int kind : {0, 1, 2}) {  // the file's rows, some of them, a whole scene
        Scene base = scene;
        std::vector<int> sources = all_rows(Rows);
        if (kind == 1) {
            std::vector<unsigned char> keep(Rows, 1);
            keep[3] = keep[44] = 0;
            base.gaussians = scene.gaussians.filtered(keep);
            base.extra = filtered(scene.extra, keep);
            std::erase_if(sources, [&](int row) { return keep[static_cast<std::size_t>(row)] == 0; });
        }
        ProjectData project;
        project.source = kind == 2 ? SceneSource{} : scene_source(path, scene.gaussians);
        project.state = initial_state(base, {});
        save_project(scratch.path() / "a.gsep", project);
        DOCTEST_CAPTURE(kind);
        check_columns(written_as("ply", load_scene(scratch.path() / "a.gsep")), sources);
    }
}

DOCTEST_TEST_CASE("a column of another length is refused, and nothing is written") {
    ScratchFolder scratch;
    Scene scene = scene_with_columns(random_gaussians(Rows, 0, 20));
    scene.gaussians = GaussianSet(random_gaussians(Rows - 1, 0, 20));
    DOCTEST_CHECK(error_of([&] { save_scene(scratch.path() / "a.ply", scene); }).has_value());
    DOCTEST_CHECK(!std::filesystem::exists(scratch.path() / "a.ply"));
}

// Activated values

namespace {

/// A file with sizes and opacities, as they are drawn, in place of their logarithms and logits.
std::string activated_file(const GaussianData& data, bool sizes, bool opacities) {
    std::vector<Column> columns = columns_of(data);
    for (Column& one : columns) {
        const auto raw = one.value;
        if (sizes && one.name.starts_with("scale_"))
            one.value = [raw](std::size_t row) { return std::exp(raw(row)); };
        if (opacities && one.name == "opacity")
            one.value = [raw](std::size_t row) { return sigmoid(raw(row)); };
    }
    return make_ply(columns, data.size(), {});
}

}  // namespace

DOCTEST_TEST_CASE("activated values are noticed, and read right when it is said") {
    ScratchFolder scratch;
    const auto path = scratch.path() / "a.ply";
    const GaussianData data = random_gaussians(Rows, 0, 21);
    for (const auto& [sizes, opacities] :
         {std::pair{true, true}, std::pair{true, false}, std::pair{false, true}}) {
        write_file(path, activated_file(data, sizes, opacities));
        const Scene noticed = load_scene(path);
        DOCTEST_CHECK(noticed.info.looks_activated);
        DOCTEST_REQUIRE(noticed.info.warnings.size() == 1);
        DOCTEST_CHECK(noticed.info.warnings[0].find("--activated") != std::string::npos);
        const Scene scene = load_scene(path, {.activated = true});
        DOCTEST_CHECK(largest_difference(scene.gaussians.log_scale(), data.log_scale) < 1e-5);
        DOCTEST_CHECK(largest_difference(scene.gaussians.opacity_logit(), data.opacity_logit) < 1e-4);
        DOCTEST_CHECK_FALSE(scene.info.looks_activated);
        DOCTEST_CHECK(scene.info.activated);
        save_scene(scratch.path() / "b.ply", scene);
        DOCTEST_CHECK_FALSE(load_scene(scratch.path() / "b.ply").info.looks_activated);
    }
    write_file(path, activated_file(data, false, false));
    DOCTEST_CHECK_FALSE(load_scene(path).info.looks_activated);
    DOCTEST_CHECK(error_of([&] { load_scene(path, {.activated = true}); }).has_value());
    save_scene(scratch.path() / "a.spz", load_scene(path));
    DOCTEST_CHECK(error_of([&] { load_scene(scratch.path() / "a.spz", {.activated = true}); }).has_value());
}

DOCTEST_TEST_CASE("scenes of large units, or of splats that are all alike, do not look activated") {
    GaussianData data = random_gaussians(Rows, 0, 22);
    for (float& value : data.log_scale) value += 9;  // a world of ten-thousandths
    DOCTEST_CHECK_FALSE(read(make_ply(columns_of(data), Rows, {})).info.looks_activated);
    GaussianData alike = random_gaussians(Rows, 0, 23);
    std::fill(alike.opacity_logit.begin(), alike.opacity_logit.end(), 0.0f);
    DOCTEST_CHECK_FALSE(read(make_ply(columns_of(alike), Rows, {})).info.looks_activated);
    std::fill(alike.log_scale.begin(), alike.log_scale.end(), 0.0f);
    DOCTEST_CHECK_FALSE(read(make_ply(columns_of(alike), Rows, {})).info.looks_activated);
}

DOCTEST_TEST_CASE("a project remembers that its scene was read as activated") {
    ScratchFolder scratch;
    const auto path = scratch.path() / "a.ply";
    const GaussianData data = random_gaussians(Rows, 0, 24);
    write_file(path, activated_file(data, true, true));
    const Scene scene = load_scene(path, {.activated = true});
    ProjectData project;
    project.source = scene_source(path, scene.gaussians);
    project.state = initial_state(scene, {});
    save_project(scratch.path() / "a.gsep", project);
    const Scene again = load_scene(scratch.path() / "a.gsep");
    DOCTEST_CHECK(same_bits(again.gaussians, scene.gaussians));
    DOCTEST_CHECK(error_of([&] { load_scene(scratch.path() / "a.gsep", {.activated = true}); }).has_value());
}

DOCTEST_TEST_CASE("the 3D filter widens activated sizes as it does logarithms") {
    ScratchFolder scratch;
    const GaussianData data = random_gaussians(Rows, 0, 25);
    const auto with_filter = [&](const std::string& bytes) {
        std::string file = bytes;
        const std::size_t stride = 56;
        std::string filtered =
            file.substr(0, file.find("end_header")) + "property float filter_3D\nend_header\n";
        const std::size_t body = file.find("end_header\n") + 11;
        for (std::size_t row = 0; row < Rows; ++row) {
            filtered += file.substr(body + row * stride, stride);
            append_scalar(filtered, 0.02f, false);
        }
        write_file(scratch.path() / "a.ply", filtered);
    };
    with_filter(activated_file(data, false, false));
    const Scene plain = load_scene(scratch.path() / "a.ply");
    with_filter(activated_file(data, true, true));
    const Scene activated = load_scene(scratch.path() / "a.ply", {.activated = true});
    DOCTEST_CHECK(largest_difference(plain.gaussians.log_scale(), activated.gaussians.log_scale()) < 1e-5);
    DOCTEST_CHECK(opacity_difference(plain.gaussians, activated.gaussians) < 1e-5);
}

}  // namespace scene_origin_test
