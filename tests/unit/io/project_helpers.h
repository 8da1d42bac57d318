// Projects for tests: a scene file, random edits, labels and views over it, and comparison bit for bit.
#pragma once

#include <string>

#include "engine/io/project/project_file.h"
#include "tests/unit/io/io_helpers.h"
#include "tests/unit/scene/random_sets.h"

namespace gse::test {

inline std::shared_ptr<const Image> random_picture(int width, int height, std::uint64_t seed) {
    Random random(seed);
    Image image(width, height, 3);
    for (float& value : image.data) value = static_cast<float>(random.below(256)) / 255;
    return std::make_shared<const Image>(std::move(image));
}

inline View random_view(std::uint64_t seed) {
    Random random(seed);
    const Vec3 eye{random.normal(), random.normal(), 5 + random.uniform()};
    return {fmt::format("view {}", seed), Camera::look_at(eye, {0, 0, 0}, {0, -1, 0}, 0.9, 640, 480),
            random.below(2) == 0};
}

inline std::shared_ptr<const FoundField> random_field(std::size_t count, std::uint64_t seed) {
    Random random(seed);
    FoundField found;
    for (std::size_t row = 0; row < count; ++row) {
        found.field.probability.push_back(static_cast<float>(random.uniform(0, 1)));
        found.field.coverage.push_back(random.uniform(0, 30));
    }
    found.rule = {0.3, 1.25, 0.05, {0.1, -0.7, 0.3}, {0, 0.2, 0.9}, ThingNature::Vessel};
    return std::make_shared<const FoundField>(std::move(found));
}

/// A project over `source` with some edits (one switched off), labels that remember absent rows, views and
/// more.
inline ProjectData random_project(const SceneSource& source, std::uint64_t seed) {
    Scene scene;
    scene.gaussians = source.loaded;
    scene.info.up = {0.1, -0.7, 0.3};
    scene.info.format = "ply";
    scene.info.warnings = {"odd \xc3\xa9"};
    ProjectData project;
    project.source = source;
    project.state = initial_state(scene, {random_view(seed), random_view(seed + 1)});
    for (std::uint64_t i = 0; i < 3; ++i) {
        EditNode node = random_node(project.state, seed * 10 + i);
        node.recipe = R"({"seed": 7})";
        node.seconds = 61.25;
        node.psnr_outside_db = i == 0 ? std::numeric_limits<double>::infinity() : 70.1;
        node.changed_outside_label = i;
        if (i == 1) node.thumbnail = random_picture(9, 7, seed);
        project.state = with_edit(project.state, node);
    }
    project.state.labels = {random_label(project.state, seed), random_label(project.state, seed + 1)};
    project.state.labels[0].excluded_views = "3, 17";
    project.state.labels[0].looked_from = "270";
    project.state.labels[0].attention_threshold = 0.3125;  // the other was not found by a search
    project.state.labels[1].weight = nullptr;
    project.state.labels[1] = with_bits(project.state.labels[1]);
    project.state.active_label = 1;
    auto stack = project.state.stack;
    stack[1].enabled = false;
    stack[2].strength = 0.625;
    project.state = with_stack(project.state, std::move(stack));
    project.state.labels[0].found = random_field(project.state.current.size(), seed);
    project.thumbnail = random_picture(16, 12, seed + 5);
    project.ui = {{"mode", 3}, {"panels", {1, 2, 3}}};
    project.jobs = {{"step", 412}};
    return project;
}

inline bool same_delta(const SceneDelta& a, const SceneDelta& b) {
    return a.changed == b.changed && a.removed == b.removed && a.added == b.added &&
           bits_equal(GaussianSet(a.changed_rows), GaussianSet(b.changed_rows)) &&
           bits_equal(GaussianSet(a.added_rows), GaussianSet(b.added_rows));
}

inline bool same_picture(const std::shared_ptr<const Image>& a, const std::shared_ptr<const Image>& b) {
#ifndef GSE_HAVE_OPENCV
    return b == nullptr;  // pictures cannot be read back
#endif
    if (a == nullptr || b == nullptr) return a == b;
    return a->width == b->width && a->height == b->height && a->data == b->data;
}

inline bool same_field(const std::shared_ptr<const FoundField>& a,
                       const std::shared_ptr<const FoundField>& b) {
    if (a == nullptr || b == nullptr) return a == b;
    const auto same_direction = [](const Vec3& one, const Vec3& other) {
        return one.x == other.x && one.y == other.y && one.z == other.z;
    };
    return a->field.probability == b->field.probability && a->field.coverage == b->field.coverage &&
           a->rule.least_coverage == b->rule.least_coverage && a->rule.smoothness == b->rule.smoothness &&
           a->rule.island_share == b->rule.island_share && same_direction(a->rule.up, b->rule.up) &&
           same_direction(a->rule.front, b->rule.front) && a->rule.nature == b->rule.nature;
}

inline bool same_label(const NamedLabel& a, const NamedLabel& b) {
    const bool absent = a.absent == nullptr || b.absent == nullptr
                            ? a.absent == b.absent
                            : a.absent->ids == b.absent->ids && a.absent->weight == b.absent->weight &&
                                  a.absent->manual == b.absent->manual;
    return absent && a.name == b.name && a.threshold == b.threshold &&
           a.attention_threshold == b.attention_threshold && a.excluded_views == b.excluded_views &&
           a.looked_from == b.looked_from && same_array(a.weight, b.weight) &&
           same_array(a.manual, b.manual) && same_array(a.bits, b.bits) && same_field(a.found, b.found);
}

inline bool same_view(const View& a, const View& b) {
    return a.name == b.name && a.distorted == b.distorted && a.camera.width == b.camera.width &&
           a.camera.height == b.camera.height && a.camera.fx == b.camera.fx && a.camera.fy == b.camera.fy &&
           a.camera.cx == b.camera.cx && a.camera.cy == b.camera.cy &&
           a.camera.rotation == b.camera.rotation && a.camera.translation == b.camera.translation;
}

inline bool same_edit(const EditNode& a, const EditNode& b) {
    return a.id == b.id && a.name == b.name && a.recipe == b.recipe && a.enabled == b.enabled &&
           a.strength == b.strength && a.seconds == b.seconds && a.psnr_outside_db == b.psnr_outside_db &&
           a.changed_outside_label == b.changed_outside_label && same_delta(*a.delta, *b.delta) &&
           same_picture(a.thumbnail, b.thumbnail);
}

/// Empty when the states agree bit for bit; else what differs first.
inline std::string difference(const DocumentState& a, const DocumentState& b) {
    if (!bits_equal(a.base, b.base)) return "base";
    if (!bits_equal(a.current, b.current)) return "current";
    if (*a.row_ids != *b.row_ids) return "identities";
    if (a.info.up != b.info.up || a.info.format != b.info.format || a.info.warnings != b.info.warnings)
        return "info";
    if (a.stack.size() != b.stack.size() || a.labels.size() != b.labels.size() ||
        a.views.size() != b.views.size())
        return "counts";
    for (std::size_t i = 0; i < a.stack.size(); ++i)
        if (!same_edit(a.stack[i], b.stack[i])) return fmt::format("edit {}", i);
    for (std::size_t i = 0; i < a.labels.size(); ++i)
        if (!same_label(a.labels[i], b.labels[i])) return fmt::format("label {}", i);
    for (std::size_t i = 0; i < a.views.size(); ++i)
        if (!same_view(a.views[i], b.views[i])) return fmt::format("view {}", i);
    return a.active_label == b.active_label ? "" : "active label";
}

/// Saves a random scene and takes it as a source.
inline SceneSource saved_source(const std::filesystem::path& path, std::size_t count, std::uint64_t seed) {
    save_scene(path, random_scene(count, 1, seed));
    return scene_source(path, load_scene(path).gaussians);
}

}  // namespace gse::test
