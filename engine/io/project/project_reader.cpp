// Reads projects: description, scene, edits, labels. Everything is checked before it is used.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/log.h"
#include "engine/io/bytes/fingerprint.h"
#include "engine/io/bytes/label_weights.h"
#include "engine/io/bytes/zip_archive.h"
#include "engine/io/image/image_file.h"
#include "engine/io/project/load_scene.h"
#include "engine/io/project/project_description.h"
#include "engine/io/project/project_file.h"
#include "engine/io/project/project_parts.h"
#include "engine/scene/origin/world_offset.h"

namespace gse {
namespace {

constexpr std::uint64_t LargestDescription = std::uint64_t{64} << 20;  // bytes of project.json
constexpr std::uint64_t FreeDescription = std::uint64_t{1} << 20;
constexpr std::uint64_t DescriptionPerFileByte = 100;  // deflated text
constexpr std::uint64_t LargestPicture = std::uint64_t{64} << 20;
constexpr std::size_t LargestPictureSide = 1024;  // thumbnails have about a hundred pixels
constexpr const char* Damaged = "the file is damaged; open an older copy or an autosave";

/// An opened project whose arrays are still packed.
class OpenProject {
public:
    explicit OpenProject(std::span<const std::byte> bytes)
        : zip_(bytes, "the project"), file_bytes_(bytes.size()), budget_(bytes.size()),
          description_(read_description()) {}

    const io::ProjectDescription& description() const { return description_; }
    /// Warnings about the arrays read so far.
    const std::vector<std::string>& warnings() const { return warnings_; }

    std::shared_ptr<const Image> picture(const std::string& name) {
        if (name.empty() || !zip_.has(name)) return nullptr;
        const auto known = pictures_.find(name);
        if (known != pictures_.end()) return known->second;
        return pictures_[name] = read_picture(name);
    }

    std::shared_ptr<const Image> read_picture(const std::string& name) const {
        try {
            const auto bytes = zip_.read(name, LargestPicture);
            const auto size = io_image_size(bytes);
            if (!size) return nullptr;
            return std::make_shared<const Image>(decode_image(bytes));
        } catch (const Error& error) {
            log::debug("the picture {} of the project is left out: {}", name, error.message());
            return nullptr;  // a picture is no reason to lose the work
        }
    }

    /// Base of the document with its columns. `file` is the content of the scene's file, empty when it is not
    /// needed.
    Scene base(const Scene& file) {
        Scene scene;
        scene.info = description_.info;
        scene.gaussians = file.gaussians;
        scene.extra = file.extra;
        if (description_.base == io::BaseKind::Whole) {
            scene.gaussians = GaussianSet(
                io::decode_set(member(description_.base_member, io::AnySize, "the scene"), "the scene"));
            scene.extra = {};
        } else if (description_.base == io::BaseKind::Kept) {
            const std::size_t rows = file.gaussians.size();
            if (rows != description_.file_rows) throw_other_scene(rows);
            const auto bits =
                io::decode_bits(member(description_.base_member, (rows + 7) / 8, "the list of kept splats"),
                                rows, "the list of kept splats");
            scene.gaussians = file.gaussians.filtered(bits);
            scene.extra = filtered(file.extra, bits);
        }
        check_base(scene.gaussians);
        if (description_.base == io::BaseKind::Whole)
            for (const auto& entry : description_.extra) scene.extra.push_back(read_column(entry));
        return scene;
    }

    DocumentState state(const Scene& scene) {
        std::vector<EditNode> stack;
        for (const auto& edit : description_.stack) stack.push_back(read_edit(edit));
        DocumentState state = with_stack(initial_state(scene, description_.views), std::move(stack));
        if (state.current.size() != description_.current_rows)
            throw Error(ErrorCode::Malformed,
                        fmt::format("the edits of the project give {} splats where {} are due",
                                    state.current.size(), description_.current_rows),
                        Damaged);
        for (const auto& entry : description_.labels)
            state.labels.push_back(read_label(entry, state.current.size()));
        state.active_label = description_.active_label;
        return state;
    }

    /// Variations of edits of that stack. Those that cannot be read are left out, with a warning: they are
    /// no reason to lose the work.
    std::vector<EditVariations> variations(const std::vector<EditNode>& stack) {
        std::vector<EditVariations> all;
        for (const auto& entry : description_.variations) try {
                all.push_back(read_variations(entry, stack));
            } catch (const Error& error) {
                warnings_.push_back(
                    fmt::format("the variations of edit {} cannot be read and are left out", entry.edit));
                log::debug("variations of edit {}: {}", entry.edit, error.message());
            }
        std::erase_if(all, [&](const EditVariations& one) { return !one.applied(stack); });
        return all;
    }

private:
    EditVariations read_variations(const io::ProjectDescription::VariationsEntry& entry,
                                   const std::vector<EditNode>& stack) {
        EditVariations variations{entry.edit, {}, entry.seeds};
        for (const auto& result : entry.results) {
            std::shared_ptr<const SceneDelta> of_stack;
            for (std::size_t i = 0; i < stack.size(); ++i)
                if (stack[i].id == entry.edit && description_.stack[i].delta == result.delta)
                    of_stack = stack[i].delta;
            variations.nodes.push_back(of_stack ? result.node : read_edit(result));
            if (!of_stack) continue;
            variations.nodes.back().delta = of_stack;
            variations.nodes.back().thumbnail = picture(result.thumbnail);
        }
        return variations;
    }

    io::ProjectDescription read_description() const {
        if (!zip_.has("project.json"))
            throw Error(ErrorCode::Malformed, "this is not a project of GSEditPro",
                        "open a .gsep file or a scene");
        const auto bytes =
            zip_.read("project.json",
                      std::min(LargestDescription, FreeDescription + DescriptionPerFileByte * file_bytes_));
        return io::parse_description({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    }

    static std::optional<ImageSize> io_image_size(std::span<const std::byte> bytes) {
        const auto size = image_size(bytes);
        const auto fits = [](int side) {
            return side > 0 && static_cast<std::size_t>(side) <= LargestPictureSide;
        };
        return size && fits(size->width) && fits(size->height) ? size : std::nullopt;
    }

    std::vector<std::byte> member(const std::string& name, std::uint64_t expected, const std::string& what) {
        // Members are packed already and stored as they are.
        return io::unpack_member(zip_.read(name, file_bytes_), expected, budget_, what);
    }

    [[noreturn]] void throw_other_scene(std::size_t splats) const {
        throw Error(ErrorCode::Malformed,
                    fmt::format("the scene has {} splats, the project was made with one of {}", splats,
                                description_.file_rows),
                    "put the scene back that the project was made with, beside the project");
    }

    void check_base(const GaussianSet& base) const {
        if (base.size() == description_.base_rows) return;
        if (description_.base == io::BaseKind::File) throw_other_scene(base.size());
        throw Error(ErrorCode::Malformed, "the scene inside the project has the wrong number of splats",
                    Damaged);
    }

    ExtraColumn read_column(const io::ProjectDescription::ExtraEntry& entry) {
        const std::string what = fmt::format("the column \"{}\"", entry.name);
        const std::uint64_t bytes = description_.base_rows * column_type_size(entry.type);
        return {entry.name, entry.type,
                std::make_shared<const std::vector<std::byte>>(member(entry.member, bytes, what))};
    }

    EditNode read_edit(const io::ProjectDescription::Edit& edit) {
        EditNode node = edit.node;
        const std::string what = fmt::format("edit {}", node.id);
        node.delta = std::make_shared<const SceneDelta>(
            io::decode_delta(member(edit.delta, io::AnySize, what), node.id, what));
        node.thumbnail = picture(edit.thumbnail);
        return node;
    }

    template <class T>
    std::vector<T> read_array(const std::string& name, std::size_t count, const std::string& what) {
        const auto bytes = member(name, std::uint64_t{count} * sizeof(T), what);
        std::vector<T> values(count);
        std::copy_n(bytes.data(), bytes.size(), reinterpret_cast<std::byte*>(values.data()));
        return values;
    }

    void hold_weights(std::vector<float>& weights, const std::string& what) {
        if (const std::size_t held = io::hold_weights(weights))
            warnings_.push_back(io::held_weights_text(held, what));
    }

    std::shared_ptr<const std::vector<float>> read_weights(const std::string& name, std::size_t count,
                                                           const std::string& what) {
        if (name.empty()) return nullptr;
        std::vector<float> weights = read_array<float>(name, count, what);
        hold_weights(weights, what);
        return std::make_shared<const std::vector<float>>(std::move(weights));
    }

    NamedLabel read_label(const io::ProjectDescription::LabelEntry& entry, std::size_t count) {
        NamedLabel label = entry.label;
        const std::string what = fmt::format("the label \"{}\"", label.name);
        label.weight = read_weights(entry.weight, count, what);
        if (!entry.manual.empty())
            label.manual = std::make_shared<const std::vector<std::int8_t>>(
                read_array<std::int8_t>(entry.manual, count, what));
        budget_.spend_known(2 * count, what);  // its bits, and the choice by hand where the file has neither
        if (label.weight == nullptr && label.manual == nullptr)
            label.manual = std::make_shared<const std::vector<std::int8_t>>(count, std::int8_t{0});
        if (!entry.absent.empty()) {
            AbsentRows absent = io::decode_absent(member(entry.absent, io::AnySize, what), what);
            hold_weights(absent.weight, what);
            label.absent = std::make_shared<const AbsentRows>(std::move(absent));
        }
        label.found = read_found(entry, count, what);
        return with_bits(std::move(label));
    }

    std::shared_ptr<const FoundField> read_found(const io::ProjectDescription::LabelEntry& entry,
                                                 std::size_t count, const std::string& what) {
        if (entry.probability.empty()) return nullptr;
        FoundField found;
        found.rule = entry.rule;
        found.field.probability = read_array<float>(entry.probability, count, what);
        hold_weights(found.field.probability, what);
        found.field.coverage = read_array<double>(entry.coverage, count, what);
        for (double& pixels : found.field.coverage)
            if (!(pixels >= 0 && std::isfinite(pixels))) pixels = 0;
        return std::make_shared<const FoundField>(std::move(found));
    }

    io::ZipReader zip_;
    std::uint64_t file_bytes_;
    io::UnpackBudget budget_;
    std::map<std::string, std::shared_ptr<const Image>> pictures_;  // edits may share them
    std::vector<std::string> warnings_;
    io::ProjectDescription description_;
};

/// Possible places of a project's scene, best first.
std::vector<std::filesystem::path> scene_candidates(const io::ProjectDescription& description,
                                                    const std::filesystem::path& project) {
    std::error_code failure;
    const auto folder = std::filesystem::absolute(project, failure).parent_path();
    std::vector<std::filesystem::path> candidates;
    const auto add = [&](const std::filesystem::path& path) {
        const auto normal = path.lexically_normal();
        if (std::find(candidates.begin(), candidates.end(), normal) == candidates.end())
            candidates.push_back(normal);
    };
    if (!description.scene_relative.empty()) add(folder / description.scene_relative);
    if (!description.scene_path.empty()) {
        const std::filesystem::path absolute(description.scene_path);
        add(absolute);
        if (absolute.has_filename()) add(folder / absolute.filename());
    }
    return candidates;
}

struct FoundScene {
    std::filesystem::path path;
    io::Fingerprint fingerprint;
    bool same = false;
};

std::optional<FoundScene> find_scene(const io::ProjectDescription& description,
                                     const std::filesystem::path& project) {
    std::optional<FoundScene> first;
    for (const auto& candidate : scene_candidates(description, project)) {
        const auto print = io::fingerprint(candidate);
        if (!print) continue;
        const bool same =
            print->bytes == description.scene_bytes && print->value == description.scene_fingerprint;
        if (same) return FoundScene{candidate, *print, true};
        if (!first) first = FoundScene{candidate, *print, false};
    }
    return first;
}

FoundScene require_scene(const io::ProjectDescription& description, const std::filesystem::path& project) {
    if (auto found = find_scene(description, project)) return *found;
    throw Error(ErrorCode::NotFound, "the scene of the project is not there any more",
                fmt::format("put \"{}\" beside the project or back to its old place",
                            std::filesystem::path(description.scene_path).filename().string()),
                description.scene_path);
}

/// The scene that somebody says is the project's.
FoundScene same_scene(const io::ProjectDescription& description, const std::filesystem::path& scene) {
    const auto print = io::fingerprint(scene);
    if (!print) throw Error(ErrorCode::NotFound, "there is no scene", "check the name", scene);
    if (print->bytes == description.scene_bytes && print->value == description.scene_fingerprint)
        return {scene.lexically_normal(), *print, true};
    throw Error(
        ErrorCode::InvalidArgument,
        fmt::format("this is not the scene that the project was made with, \"{}\" of {} bytes",
                    std::filesystem::path(description.scene_path).filename().string(),
                    description.scene_bytes),
        "choose that one; a changed scene is taken when it lies beside the project under its old name",
        scene);
}

void warn(ProjectData& project, std::string sentence) {
    log::warning("{}", sentence);
    project.warnings.push_back(std::move(sentence));
}

void warn_of_differences(const io::ProjectDescription& description, const FoundScene& found,
                         ProjectData& project) {
    if (!found.same)
        warn(project,
             fmt::format(
                 "{} has changed since the project was saved; the edits are laid over what it holds now",
                 found.path.string()));
    else if (found.path.string() != description.scene_path)
        warn(project, fmt::format("the scene was found at {} instead of {}", found.path.string(),
                                  description.scene_path));
}

/// `file` is the scene of the project's file, empty when the project holds its scene itself.
ProjectData finish(OpenProject& open, ProjectData project, Scene file) {
    const io::ProjectDescription& description = open.description();
    // Its edits are of a scene with the offset that it had then.
    file.gaussians = moved(file.gaussians, file.info.offset - description.info.offset);
    project.source.loaded = file.gaussians;
    const Scene base = open.base(file);
    project.state = open.state(base);
    project.variations = open.variations(project.state.stack);
    for (const std::string& warning : open.warnings()) warn(project, warning);
    if (project.source.loaded.empty()) project.source.loaded = base.gaussians;
    project.thumbnail = open.picture(description.thumbnail);
    project.ui = description.ui;
    project.jobs = description.jobs;
    project.unknown = description.unknown;
    return project;
}

}  // namespace

SceneSource scene_source(const std::filesystem::path& path, GaussianSet loaded) {
    SceneSource source;
    source.loaded = std::move(loaded);
    if (path.empty()) return source;
    const auto print = io::fingerprint(path);
    if (!print)
        throw Error(ErrorCode::Unreadable, "the scene cannot be read", "check that it is still there", path);
    std::error_code failure;
    source.path = std::filesystem::absolute(path, failure).lexically_normal();
    source.bytes = print->bytes;
    source.fingerprint = print->value;
    return source;
}

ProjectData load_project(const std::filesystem::path& path, const std::filesystem::path& scene_path) {
    return with_path(path, [&] {
        const FileBytes file(path);
        OpenProject open(file.bytes());
        const io::ProjectDescription& description = open.description();
        ProjectData project;
        Scene scene;
        if (description.base != io::BaseKind::Whole) {
            const FoundScene found =
                scene_path.empty() ? require_scene(description, path) : same_scene(description, scene_path);
            const bool is_file = !is_project_file(found.path);  // another project knows it itself
            scene = load_scene(found.path, {.activated = description.info.activated && is_file});
            project.source = {found.path, found.fingerprint.bytes, found.fingerprint.value, {}};
            warn_of_differences(description, found, project);
        }
        return finish(open, std::move(project), std::move(scene));
    });
}

ProjectData parse_project(std::span<const std::byte> bytes, const GaussianSet* base) {
    OpenProject open(bytes);
    Scene file;
    if (open.description().base != io::BaseKind::Whole) {
        if (base == nullptr)
            throw Error(ErrorCode::NotFound, "the project refers to a scene that was not given",
                        "open it from its file");
        file.gaussians = *base;
        file.info.offset = open.description().info.offset;
    }
    return finish(open, {}, std::move(file));
}

ProjectSummary read_project_summary(const std::filesystem::path& path) {
    return with_path(path, [&] {
        const FileBytes file(path);
        OpenProject open(file.bytes());
        const io::ProjectDescription& description = open.description();
        ProjectSummary summary;
        summary.program = description.program;
        summary.scene = description.scene_path;
        const auto found = find_scene(description, path);
        if (found) summary.scene = found->path;
        summary.scene_found = found.has_value() || description.base == io::BaseKind::Whole;
        summary.splats = description.current_rows;
        summary.info = description.info;
        for (const auto& edit : description.stack) summary.stack.push_back(edit.node);
        for (const auto& entry : description.labels) summary.labels.push_back(entry.label);
        summary.active_label = description.active_label;
        summary.views = description.views;
        summary.ui = description.ui;
        summary.jobs = description.jobs;
        summary.thumbnail = open.picture(description.thumbnail);
        return summary;
    });
}

bool is_project_file(const std::filesystem::path& path) {
    std::error_code failure;
    if (!std::filesystem::is_regular_file(path, failure)) return false;
    if (path.extension() == ".gsep") return true;
    try {
        if (read_start(path, 2) != "PK") return false;
        const FileBytes file(path);
        return io::ZipReader(file.bytes(), "the file").has("project.json");
    } catch (const Error&) { return false; }
}

}  // namespace gse
