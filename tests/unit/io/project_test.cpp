// Project files: everything comes back bit for bit, scenes are found again, damage is one sentence.
#include <fstream>

#include "engine/base/log.h"
#include "engine/io/bytes/zip_archive.h"
#include "engine/io/project/project_description.h"
#include "engine/io/project/project_parts.h"
#include "tests/unit/io/project_helpers.h"

namespace project_test {

using namespace gse;
using namespace gse::test;

namespace {

/// Warnings of these tests are expected.
struct Quiet {
    Quiet() { log::set_level(log::Level::Off); }
    ~Quiet() { log::set_level(log::Level::Info); }
};

std::string text_of(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// The project with its description changed by `change`.
template <class F> std::string with_description(const std::string& project, F&& change) {
    const io::ZipReader zip(as_bytes(project), "the project");
    auto json = nlohmann::json::parse(text_of(zip.read("project.json", 1 << 20)));
    const io::ProjectDescription description = io::parse_description(json.dump());
    std::vector<std::string> names{description.thumbnail, description.base_member};
    for (const auto& edit : description.stack) names.insert(names.end(), {edit.delta, edit.thumbnail});
    for (const auto& label : description.labels)
        names.insert(names.end(),
                     {label.weight, label.manual, label.absent, label.probability, label.coverage});
    change(json);
    const std::string text = json.dump();
    std::vector<std::string> contents;
    std::erase(names, "");
    for (const auto& name : names) contents.push_back(text_of(zip.read(name, 1 << 30)));
    std::vector<io::ZipMember> members{{"project.json", text, true}};
    for (std::size_t i = 0; i < names.size(); ++i) members.push_back({names[i], contents[i], false});
    return io::write_zip(members);
}

}  // namespace

DOCTEST_TEST_CASE("a project comes back bit for bit") {
    const Quiet quiet;
    const ScratchFolder folder;
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
        const auto source = saved_source(folder.path() / "scene \xc3\xa9.ply", 90 + seed * 40, seed);
        const ProjectData project = random_project(source, seed);
        const auto path = folder.path() / "w\xc3\xb6rk.gsep";
        save_project(path, project);
        const ProjectData loaded = load_project(path);
        DOCTEST_CHECK(difference(project.state, loaded.state) == "");
        DOCTEST_CHECK(loaded.ui == project.ui);
        DOCTEST_CHECK(loaded.jobs == project.jobs);
        DOCTEST_CHECK(same_picture(project.thumbnail, loaded.thumbnail));
        DOCTEST_CHECK(loaded.warnings.empty());
        DOCTEST_CHECK(loaded.source.path == source.path);
        // Edits that are off come back on.
        auto stack = loaded.state.stack;
        stack[1].enabled = true;
        DOCTEST_CHECK(difference(with_stack(project.state, stack), with_stack(loaded.state, stack)) == "");
    }
}

DOCTEST_TEST_CASE(
    "a project that holds its scene needs no file of it, one that does not can be told where it is") {
    const Quiet quiet;
    const ScratchFolder folder;
    namespace fs = std::filesystem;
    const auto place = folder.path() / "scenes" / "scene.ply", moved = folder.path() / "moved" / "other.ply";
    ProjectData project = random_project(saved_source(place, 80, 5), 5);
    const auto linked = folder.path() / "linked.gsep", whole = folder.path() / "whole.gsep";
    save_project(linked, project);
    project.embeds = true;
    save_project(whole, project);
    fs::create_directories(moved.parent_path());
    fs::rename(place, moved);
    const ProjectData held = load_project(whole);
    DOCTEST_CHECK(difference(project.state, held.state) == "");
    DOCTEST_CHECK(held.source.path.empty());
    DOCTEST_CHECK(error_of([&] { load_project(linked); }));
    const ProjectData found = load_project(linked, moved);
    DOCTEST_CHECK(difference(project.state, found.state) == "");
    DOCTEST_CHECK(found.source.path == moved);
    const auto other = folder.path() / "third.ply";
    save_scene(other, random_scene(80, 1, 6));  // as many splats, and another scene
    const auto refused = error_of([&] { load_project(linked, other); });
    DOCTEST_REQUIRE(refused);
    DOCTEST_CHECK(refused->code() == ErrorCode::InvalidArgument);
    DOCTEST_CHECK(refused->message().find("scene.ply") != std::string::npos);
    const auto none = error_of([&] { load_project(linked, folder.path() / "none.ply"); });
    DOCTEST_REQUIRE(none);
    DOCTEST_CHECK(none->code() == ErrorCode::NotFound);
}

DOCTEST_TEST_CASE("variations come back, with the one on the stack shared, as long as it is on the stack") {
    const Quiet quiet;
    const ScratchFolder folder;
    const auto source = saved_source(folder.path() / "scene.ply", 120, 3);
    ProjectData project = random_project(source, 3);
    const EditNode& applied = project.state.stack[1];
    EditNode other = random_node(project.state, 77);
    other.id = applied.id;
    other.thumbnail = random_picture(9, 7, 8);
    SceneDelta delta = *other.delta;
    for (std::size_t i = 0; i < delta.added.size(); ++i) delta.added[i] = applied.id << EditIdShift | i;
    other.delta = std::make_shared<const SceneDelta>(delta);
    EditVariations gone{99, {other, other}, {1, 2}};  // of an edit that is not there
    project.variations = {gone, {applied.id, {other, applied}, {7, 8}}};
    const auto path = folder.path() / "work.gsep";
    save_project(path, project);
    const ProjectData loaded = load_project(path);
    DOCTEST_CHECK(difference(project.state, loaded.state) == "");
    DOCTEST_CHECK(loaded.warnings.empty());
    DOCTEST_REQUIRE(loaded.variations.size() == 1);
    const auto& variations = loaded.variations[0];
    DOCTEST_CHECK(variations.edit == applied.id);
    DOCTEST_CHECK(variations.seeds == std::vector<std::uint64_t>{7, 8});
    DOCTEST_CHECK(variations.applied(loaded.state.stack) == 1);
    DOCTEST_REQUIRE(variations.nodes.size() == 2);
    DOCTEST_CHECK(same_edit(variations.nodes[0], other));
    DOCTEST_CHECK(same_delta(*variations.nodes[1].delta, *applied.delta));
    // Saved by a program that knows nothing of them: their names are kept, their arrays are not.
    const std::string cut = with_description(ProjectWriter().pack(path, project), [](auto&) {});
    const ProjectData left = parse_project(as_bytes(cut), &source.loaded);
    DOCTEST_CHECK(difference(project.state, left.state) == "");
    DOCTEST_CHECK(left.variations.empty());
    DOCTEST_CHECK(left.warnings.size() == 1);
}

DOCTEST_TEST_CASE("a writer that knows the arrays writes the same bytes as a new one") {
    const ScratchFolder folder;
    ProjectData project = random_project(saved_source(folder.path() / "scene.ply", 200, 1), 1);
    const auto path = folder.path() / "a.gsep";
    ProjectWriter writer;
    DOCTEST_CHECK(writer.pack(path, project) == writer.pack(path, project));
    for (std::uint64_t i = 0; i < 5; ++i) {
        if (i % 2 == 0) project.state.labels[0] = random_label(project.state, i);
        else project.state = with_edit(project.state, random_node(project.state, i));
        const bool same = writer.pack(path, project) == ProjectWriter().pack(path, project);
        DOCTEST_CHECK(same);
    }
}

DOCTEST_TEST_CASE("the scene is found beside a project that moved, and changes are told") {
    const Quiet quiet;
    const ScratchFolder folder;
    namespace fs = std::filesystem;
    const auto source = saved_source(folder.path() / "a" / "scene.ply", 100, 2);
    const ProjectData project = random_project(source, 2);
    save_project(folder.path() / "a" / "work.gsep", project);
    fs::rename(folder.path() / "a", folder.path() / "b");
    const ProjectData moved = load_project(folder.path() / "b" / "work.gsep");
    DOCTEST_CHECK(difference(project.state, moved.state) == "");
    DOCTEST_REQUIRE(moved.warnings.size() == 1);
    DOCTEST_CHECK(moved.warnings[0].find("was found at") != std::string::npos);
    // The scene stays in another folder: its name beside the project is tried as well.
    save_project(folder.path() / "other.gsep", moved);
    fs::create_directories(folder.path() / "c");
    fs::rename(folder.path() / "other.gsep", folder.path() / "c" / "other.gsep");
    fs::rename(folder.path() / "b" / "scene.ply", folder.path() / "c" / "scene.ply");
    DOCTEST_CHECK(difference(project.state, load_project(folder.path() / "c" / "other.gsep").state) == "");
    // Another scene of as many splats: a warning; of fewer: an error.
    const auto place = folder.path() / "c" / "scene.ply";
    save_scene(place, random_scene(100, 1, 77));
    const ProjectData changed = load_project(folder.path() / "c" / "other.gsep");
    DOCTEST_REQUIRE(changed.warnings.size() == 1);
    DOCTEST_CHECK(changed.warnings[0].find("has changed") != std::string::npos);
    save_scene(place, random_scene(60, 1, 77));
    const auto other = error_of([&] { load_project(folder.path() / "c" / "other.gsep"); });
    DOCTEST_REQUIRE(other);
    DOCTEST_CHECK(other->message() == "the scene has 60 splats, the project was made with one of 100");
    fs::remove(place);
    const auto gone = error_of([&] { load_project(folder.path() / "c" / "other.gsep"); });
    DOCTEST_REQUIRE(gone);
    DOCTEST_CHECK(gone->code() == ErrorCode::NotFound);
    DOCTEST_CHECK(gone->hint() == "put \"scene.ply\" beside the project or back to its old place");
    const ProjectSummary summary = read_project_summary(folder.path() / "c" / "other.gsep");
    DOCTEST_CHECK_FALSE(summary.scene_found);
    DOCTEST_CHECK(summary.stack.size() == 3);
}

DOCTEST_TEST_CASE("a repaired base is kept as its rows, any other base as a whole") {
    const Quiet quiet;
    const ScratchFolder folder;
    const auto path = folder.path() / "p.gsep";
    const auto source = saved_source(folder.path() / "scene.ply", 300, 3);
    Scene scene;
    std::vector<unsigned char> keep(300, 1);
    keep[0] = keep[17] = keep[299] = 0;
    scene.gaussians = source.loaded.filtered(keep);
    ProjectData project;
    project.source = source;
    project.state = initial_state(scene, {});
    project.state = with_edit(project.state, random_node(project.state, 1));
    ProjectWriter writer;
    for (int again = 0; again < 2; ++again) {
        writer.save(path, project);
        const ProjectData loaded = load_project(path);
        DOCTEST_CHECK(difference(project.state, loaded.state) == "");
        DOCTEST_CHECK(bits_equal(loaded.source.loaded, source.loaded));
    }
    const auto kept_bytes = std::filesystem::file_size(path);
    // The scene's file is overwritten after it was opened: the project must not depend on it any more.
    save_scene(source.path, random_scene(50, 1, 4));
    writer.save(path, project);
    DOCTEST_CHECK(std::filesystem::file_size(path) > kept_bytes);
    DOCTEST_CHECK(difference(project.state, load_project(path).state) == "");
    // No file at all.
    project.source = {};
    writer.save(path, project);
    std::filesystem::remove(source.path);
    const ProjectData whole = load_project(path);
    DOCTEST_CHECK(difference(project.state, whole.state) == "");
    save_project(path, whole);
    DOCTEST_CHECK(difference(project.state, load_project(path).state) == "");
}

DOCTEST_TEST_CASE(
    "a project is a scene, too: what it shows, its active label first; one that is its own scene is "
    "refused") {
    const Quiet quiet;
    const ScratchFolder folder;
    const auto source = saved_source(folder.path() / "scene.ply", 100, 2);
    const ProjectData project = random_project(source, 2);
    const auto path = folder.path() / "work.gsep";
    save_project(path, project);
    const Scene scene = load_scene(path);
    DOCTEST_CHECK(bits_equal(scene.gaussians, project.state.current));
    const auto& labels = project.state.labels;
    DOCTEST_REQUIRE(scene.labels.labels.size() == labels.size());
    DOCTEST_REQUIRE(project.state.active_label >= 0);
    const auto& active = labels[static_cast<std::size_t>(project.state.active_label)];
    DOCTEST_CHECK(scene.labels.labels.front().name == active.name);
    DOCTEST_CHECK(*scene.labels.labels.front().bits == *active.bits);
    std::filesystem::copy_file(path, folder.path() / "scene.ply",
                               std::filesystem::copy_options::overwrite_existing);
    const auto own = error_of([&] { load_scene(path); });
    DOCTEST_REQUIRE(own);
    DOCTEST_CHECK(own->message().find("refer to each other") != std::string::npos);
}

DOCTEST_TEST_CASE("unknown fields are kept, absent ones have defaults, newer formats are refused") {
    const ScratchFolder folder;
    const ProjectData project = random_project({{}, 0, 0, random_set(80, 1, 5)}, 5);
    const std::string packed = ProjectWriter().pack("x.gsep", project);
    const auto newer = with_description(packed, [](auto& json) {
        json["mood"] = {{"of", "the day"}};
        json["stack"][0]["colour"] = "red";
    });
    const ProjectData loaded = parse_project(as_bytes(newer));
    DOCTEST_CHECK(difference(project.state, loaded.state) == "");
    DOCTEST_CHECK(loaded.unknown["mood"]["of"] == "the day");
    const std::string again = ProjectWriter().pack("x.gsep", loaded);
    DOCTEST_CHECK(parse_project(as_bytes(again)).unknown == loaded.unknown);
    const auto older = with_description(packed, [](auto& json) {
        for (const char* key : {"ui", "jobs", "views", "info", "program", "thumbnail", "active_label"})
            json.erase(key);
        json["stack"][0].erase("recipe");
        json["labels"][0].erase("attention_threshold");
        json["labels"][0].erase("views");
    });
    const ProjectData sparse = parse_project(as_bytes(older));
    DOCTEST_CHECK(bits_equal(sparse.state.current, project.state.current));
    DOCTEST_CHECK(sparse.state.views.empty());
    DOCTEST_CHECK(sparse.state.stack[0].recipe.empty());
    DOCTEST_CHECK(sparse.state.labels[0].attention_threshold == NamedLabel().attention_threshold);
    DOCTEST_CHECK(sparse.state.labels[0].found == nullptr);
    DOCTEST_CHECK(*sparse.state.labels[0].bits == *project.state.labels[0].bits);
    const auto nature_of = [&](const char* key, const nlohmann::json& value) {
        const auto other = with_description(packed, [&](auto& json) {
            auto& views = json["labels"][0]["views"];
            views.erase("nature");
            views[key] = value;
        });
        return parse_project(as_bytes(other)).state.labels[0].found->rule.nature;
    };
    DOCTEST_CHECK(nature_of("figure", true) == ThingNature::Figure);
    DOCTEST_CHECK(nature_of("nature", "plant") == ThingNature::Plant);
    DOCTEST_CHECK(nature_of("nature", "not known yet") == ThingNature::Other);
    const auto future = with_description(packed, [](auto& json) { json["version"] = 2; });
    const auto refused = error_of([&] { parse_project(as_bytes(future)); });
    DOCTEST_REQUIRE(refused);
    DOCTEST_CHECK(refused->code() == ErrorCode::Unsupported);
}

DOCTEST_TEST_CASE("weights of a project's labels that are none are held between 0 and 1, and that is said") {
    const Quiet quiet;
    ProjectData project = random_project({{}, 0, 0, random_set(80, 1, 5)}, 5);
    NamedLabel& label = project.state.labels[0];
    auto weight = *label.weight;
    weight[3] = 2, weight[5] = -0.5f, weight[7] = std::nanf("");
    label.weight = std::make_shared<const std::vector<float>>(weight);
    label.absent = std::make_shared<const AbsentRows>(AbsentRows{{1, 2}, {0.25f, 1e30f}, {0, 0}});
    const std::string packed = ProjectWriter().pack("x.gsep", project);
    const ProjectData loaded = parse_project(as_bytes(packed));
    weight[3] = 1, weight[5] = 0, weight[7] = 0;
    DOCTEST_CHECK(*loaded.state.labels[0].weight == weight);
    DOCTEST_CHECK(loaded.state.labels[0].absent->weight == std::vector<float>{0.25f, 1});
    DOCTEST_REQUIRE(loaded.warnings.size() == 2);
    DOCTEST_CHECK(
        loaded.warnings[0].starts_with("the label \"label 5\" has weights outside of 0 to 1 for 3 splats"));
}

DOCTEST_TEST_CASE("damaged descriptions and members are one sentence each") {
    const ProjectData project = random_project({{}, 0, 0, random_set(80, 1, 6)}, 6);
    const std::string packed = ProjectWriter().pack("x.gsep", project);
    using Json = nlohmann::json;
    const std::vector<std::function<void(Json&)>> damages = {
        [](Json& json) { json["format"] = "other"; },
        [](Json& json) { json.erase("version"); },
        [](Json& json) { json["scene"] = 3; },
        [](Json& json) { json["scene"]["base"] = "cloud"; },
        [](Json& json) { json["scene"]["fingerprint"] = "xyz"; },
        [](Json& json) { json["scene"]["base_member"] = "nowhere"; },
        [](Json& json) { json["scene"]["base_splats"] = 81; },
        [](Json& json) { json["rows"] = 1; },
        [](Json& json) { json["stack"][1]["id"] = json["stack"][0]["id"]; },
        [](Json& json) { json["stack"][1]["id"] = 0; },
        [](Json& json) { json["stack"][1]["id"] = -4; },
        [](Json& json) { json["stack"][0]["delta"] = json["stack"][2]["delta"]; },
        [](Json& json) { json["stack"][0]["delta"] = json["labels"][0]["weight"]; },
        [](Json& json) { json["labels"][0]["weight"] = json["labels"][0]["manual"]; },
        [](Json& json) { json["labels"][0]["threshold"] = "nan"; },
        [](Json& json) { json["labels"][0]["views"] = 3; },
        [](Json& json) { json["labels"][0]["views"].erase("coverage"); },
        [](Json& json) { json["labels"][0]["views"]["coverage"] = json["labels"][0]["weight"]; },
        [](Json& json) { json["labels"][0]["views"]["up"] = std::vector<double>(3, 0.0); },
        [](Json& json) { json["active_label"] = 2; },
        [](Json& json) {
            json["views"][0]["lens"] = {1, 2, 3};
        },
        [](Json& json) {
            json["views"][0]["size"] = {1e9, 3};
        },
        [](Json& json) { json["views"][0]["rotation"][3] = "x"; },
        // Cameras that no camera reader takes, either.
        [](Json& json) { json["views"][0] = Json::object(); },
        [](Json& json) { json["views"][0].erase("size"); },
        [](Json& json) { json["views"][0].erase("lens"); },
        [](Json& json) { json["views"][1]["size"][0] = 0; },
        [](Json& json) { json["views"][1]["lens"][0] = 0; },
        [](Json& json) { json["views"][1]["lens"][1] = -500; },
        [](Json& json) { json["views"][1]["rotation"] = std::vector<double>(9, 0.0); },
        [](Json& json) { json["views"][1]["rotation"][0] = 7; },
        [](Json& json) { json["ui"] = Json::array(); },
        [](Json& json) {
            Json deep = 1;
            for (int i = 0; i < 300; ++i) deep = Json::array({deep});
            json["ui"] = {{"deep", deep}};
        },
    };
    for (std::size_t i = 0; i < damages.size(); ++i) {
        DOCTEST_CAPTURE(i);
        const auto error = error_of([&] { parse_project(as_bytes(with_description(packed, damages[i]))); });
        DOCTEST_REQUIRE(error);
        DOCTEST_CHECK_FALSE(error->message().empty());
        if (error->message().starts_with("the camera \"views["))
            DOCTEST_CHECK(error->hint().find("an older copy or an autosave") != std::string::npos);
    }
}

DOCTEST_TEST_CASE("a project cut off or changed anywhere gives an error or what was saved, nothing else") {
    const Quiet quiet;
    ProjectData project = random_project({{}, 0, 0, random_set(40, 1, 7)}, 7);
    const std::string packed = ProjectWriter().pack("x.gsep", project);
    std::size_t refused = 0, tries = 0;
    for (std::size_t size = 0; size < packed.size(); size += 1 + packed.size() / 200, ++tries)
        refused += error_of([&] { parse_project(as_bytes(packed.substr(0, size))); }) ? 1 : 0;
    DOCTEST_CHECK(refused == tries);
    Random random(11);
    for (int i = 0; i < 400; ++i) {
        std::string damaged = packed;
        const auto at = random.below(damaged.size());
        damaged[at] = static_cast<char>(damaged[at] ^ (1 << random.below(8)));
        std::string what;
        const auto error =
            error_of([&] { what = difference(project.state, parse_project(as_bytes(damaged)).state); });
        // A bit of an optional part (a picture, a name in the directory, a time) may pass; the rows may not.
        if (!error) DOCTEST_CHECK((what.empty() || what.starts_with("edit")));
    }
}

DOCTEST_TEST_CASE("members that lie about their size are refused before memory is taken") {
    io::UnpackBudget budget(1000);
    std::string member = io::pack_member(std::string(1000, 'x'), 1);
    DOCTEST_CHECK(io::unpack_member(as_bytes(member), io::AnySize, budget, "it").size() == 1000);
    DOCTEST_CHECK(error_of([&] { io::unpack_member(as_bytes(member), 999, budget, "it"); }));
    for (const std::uint64_t size :
         {~std::uint64_t{0}, std::uint64_t{1} << 40, std::uint64_t{1001}, std::uint64_t{2000000}}) {
        std::memcpy(member.data() + 8, &size, sizeof size);
        DOCTEST_CHECK(error_of([&] { io::unpack_member(as_bytes(member), io::AnySize, budget, "it"); }));
    }
    // Sizes that the file can justify, but only once.
    io::UnpackBudget small(1000);
    small.spend(200u << 20, "it");
    DOCTEST_CHECK(error_of([&] { small.spend(200u << 20, "it"); }));
    io::UnpackBudget labels(1000);
    for (int i = 0; i < 4; ++i) labels.spend_known(100u << 20, "it");
    DOCTEST_CHECK(error_of([&] { labels.spend_known(200u << 20, "it"); }));
    // Counts inside a delta.
    SceneDelta delta;
    delta.removed = {3, 9};
    const std::string good = io::encode_delta(delta);
    DOCTEST_CHECK(io::decode_delta(as_bytes(good), 1, "it").removed == delta.removed);
    for (const std::size_t offset : {0, 8, 16, 24, 28}) {
        std::string bad = good;
        std::memset(bad.data() + offset, 0xff, offset < 24 ? 8 : 4);
        DOCTEST_CHECK(error_of([&] { io::decode_delta(as_bytes(bad), 1, "it"); }));
    }
    delta.removed = {9, 3};
    DOCTEST_CHECK(error_of([&] { io::decode_delta(as_bytes(io::encode_delta(delta)), 1, "it"); }));
    delta.removed.clear();
    delta.added = {(2ull << 32) | 0};
    delta.added_rows = gse::test::random_data(1, 0, 1);
    DOCTEST_CHECK(error_of([&] { io::decode_delta(as_bytes(io::encode_delta(delta)), 1, "it"); }));
}

DOCTEST_TEST_CASE("what is no project is told apart") {
    const ScratchFolder folder;
    write_file(folder.path() / "text.txt", "hello");
    write_file(folder.path() / "bad.gsep", "hello");
    DOCTEST_CHECK_FALSE(is_project_file(folder.path() / "text.txt"));
    DOCTEST_CHECK_FALSE(is_project_file(folder.path() / "none.gsep"));
    const auto error = error_of([&] { load_project(folder.path() / "bad.gsep"); });
    DOCTEST_REQUIRE(error);
    DOCTEST_CHECK(error->path() == folder.path() / "bad.gsep");
    save_project(folder.path() / "renamed.zip", random_project({{}, 0, 0, random_set(10, 0, 1)}, 1));
    DOCTEST_CHECK(is_project_file(folder.path() / "renamed.zip"));
}

}  // namespace project_test
