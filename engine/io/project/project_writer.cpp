// Packs projects. A member is compressed once per array.
#include <fmt/core.h>

#include <algorithm>
#include <cstring>
#include <optional>
#include <utility>

#include "engine/base/check.h"
#include "engine/base/file.h"
#include "engine/base/log.h"
#include "engine/io/bytes/encoding.h"
#include "engine/io/bytes/fingerprint.h"
#include "engine/io/bytes/zip_archive.h"
#include "engine/io/image/png.h"
#include "engine/io/project/project_description.h"
#include "engine/io/project/project_file.h"
#include "engine/io/project/project_parts.h"

namespace gse {

/// One run of a writer. Collects members and the description.
class ProjectPacker {
public:
    ProjectPacker(ProjectWriter& writer, const std::filesystem::path& path) : writer_(writer), path_(path) {
        ++writer_.saves_;
    }

    std::string pack(const ProjectData& project) {
        const DocumentState& state = project.state;
        description_.program = GSE_VERSION;
        description_.info = state.info;
        description_.views = state.views;
        description_.ui = project.ui;
        description_.jobs = project.jobs;
        description_.unknown = project.unknown;
        description_.active_label = state.active_label;
        description_.current_rows = state.current.size();
        add_scene(state.base, project.source, project.embeds);
        if (description_.base == io::BaseKind::Whole) add_extra(state.extra);
        for (const EditNode& edit : state.stack) add_edit(edit);
        for (const EditVariations& variations : project.variations) add_variations(variations, state.stack);
        for (std::size_t i = 0; i < state.labels.size(); ++i) add_label(state.labels[i], i);
        if (project.thumbnail != nullptr)
            description_.thumbnail = picture("thumbnail.png", project.thumbnail);
        const std::string text = io::write_description(description_);
        std::vector<io::ZipMember> members{{"project.json", text, true}};
        for (const auto& [name, bytes] : members_) members.push_back({name, *bytes, false});
        forget_unused();
        return io::write_zip(members);
    }

private:
    /// Adds the member that `make` gives, or the bytes that this array gave before. `key` is the array's kind
    /// and address.
    template <class Make>
    std::string add(std::string name, const std::string& key, const std::shared_ptr<const void>& of,
                    Make&& make) {
        ProjectWriter::Member& member = writer_.members_[key];
        if (member.bytes == nullptr || member.of.lock() != of)
            member = {of, std::make_shared<const std::string>(make()), 0};
        member.used = writer_.saves_;
        members_.emplace_back(name, member.bytes);
        return name;
    }

    template <class T, class Make>
    std::string add(std::string name, const char* kind, const std::shared_ptr<const T>& of, Make&& make) {
        return add(std::move(name), fmt::format("{} {}", kind, static_cast<const void*>(of.get())), of, make);
    }

    template <class T>
    std::string array(std::string name, const std::shared_ptr<const std::vector<T>>& values) {
        if (values == nullptr) return {};
        return add(std::move(name), "array", values, [&] {
            const std::string_view bytes(reinterpret_cast<const char*>(values->data()),
                                         values->size() * sizeof(T));
            return io::pack_member(bytes, sizeof(T) == 1 ? 1 : 4);
        });
    }

    std::string picture(std::string name, const std::shared_ptr<const Image>& image) {
        const bool drawable = image->width > 0 && image->height > 0 &&
                              (image->channels == 1 || image->channels == 3 || image->channels == 4);
        if (!drawable) return {};
        return add(std::move(name), "png", image, [&] {
            std::vector<std::uint8_t> bytes(image->data.size());
            for (std::size_t i = 0; i < bytes.size(); ++i)
                bytes[i] = io::to_byte(static_cast<double>(image->data[i]) * 255);
            return io::encode_png({image->width, image->height, image->channels, bytes}, {});
        });
    }

    void add_edit(const EditNode& node) {
        GSE_CHECK(node.delta != nullptr);
        io::ProjectDescription::Edit edit;
        edit.node = node;
        edit.delta = add(fmt::format("edits/{}.delta", node.id), "delta", node.delta,
                         [&] { return io::pack_member(io::encode_delta(*node.delta), 4); });
        if (node.thumbnail != nullptr)
            edit.thumbnail = picture(fmt::format("edits/{}.png", node.id), node.thumbnail);
        description_.stack.push_back(std::move(edit));
    }

    /// Variations of an edit that is not on the stack are left out.
    void add_variations(const EditVariations& variations, const std::vector<EditNode>& stack) {
        const auto applied = variations.applied(stack);
        if (!applied) return;
        const auto& of_stack = *std::find_if(
            description_.stack.begin(), description_.stack.end(),
            [&](const io::ProjectDescription::Edit& edit) { return edit.node.id == variations.edit; });
        io::ProjectDescription::VariationsEntry entry{variations.edit, {}, variations.seeds};
        for (std::size_t i = 0; i < variations.nodes.size(); ++i) {
            const EditNode& node = variations.nodes[i];
            io::ProjectDescription::Edit edit{node, of_stack.delta, of_stack.thumbnail};
            const auto name = fmt::format("variations/{}.{}", variations.edit, i);
            if (i != *applied) {
                edit.delta = add(name + ".delta", "delta", node.delta,
                                 [&] { return io::pack_member(io::encode_delta(*node.delta), 4); });
                edit.thumbnail = node.thumbnail != nullptr ? picture(name + ".png", node.thumbnail) : "";
            }
            entry.results.push_back(std::move(edit));
        }
        description_.variations.push_back(std::move(entry));
    }

    void add_label(const NamedLabel& label, std::size_t index) {
        io::ProjectDescription::LabelEntry entry;
        entry.label.name = label.name;
        entry.label.threshold = label.threshold;
        entry.label.attention_threshold = label.attention_threshold;
        entry.label.found_for = label.found_for;
        entry.label.excluded_views = label.excluded_views;
        entry.label.looked_from = label.looked_from;
        entry.weight = array(fmt::format("labels/{}.weight", index), label.weight);
        entry.manual = array(fmt::format("labels/{}.manual", index), label.manual);
        if (label.absent != nullptr)
            entry.absent = add(fmt::format("labels/{}.absent", index), "absent", label.absent,
                               [&] { return io::pack_member(io::encode_absent(*label.absent), 1); });
        if (label.found != nullptr) {
            const auto& field = label.found->field;
            entry.probability =
                array<float>(fmt::format("labels/{}.probability", index), {label.found, &field.probability});
            entry.coverage =
                array<double>(fmt::format("labels/{}.coverage", index), {label.found, &field.coverage});
            entry.rule = label.found->rule;
        }
        description_.labels.push_back(std::move(entry));
    }

    void add_scene(const GaussianSet& base, const SceneSource& source, bool embeds) {
        description_.base_rows = base.size();
        description_.file_rows = source.loaded.size();
        description_.scene_bytes = source.bytes;
        description_.scene_fingerprint = source.fingerprint;
        if (!source.path.empty()) {
            description_.scene_path = source.path.string();
            std::error_code failure;
            const auto folder = std::filesystem::absolute(path_, failure).parent_path().lexically_normal();
            description_.scene_relative = source.path.lexically_relative(folder).string();
        }
        const bool on_disk = !embeds && !source.path.empty() && still_there(source);
        if (on_disk && base.shares_all_with(source.loaded)) return;
        description_.base_member = on_disk ? add_kept_rows(base, source.loaded) : "";
        if (!description_.base_member.empty()) return;
        description_.base = io::BaseKind::Whole;
        description_.base_member = add("base.set", key_of("whole", base), base.buffers().position,
                                       [&] { return io::pack_member(io::encode_set(base), 4); });
    }

    void add_extra(const ExtraColumns& columns) {
        for (std::size_t i = 0; i < columns.size(); ++i) {
            const auto& values = columns[i].values;
            const auto element = static_cast<std::uint32_t>(column_type_size(columns[i].type) == 4 ? 4 : 1);
            const auto pack = [&] {
                return io::pack_member({reinterpret_cast<const char*>(values->data()), values->size()},
                                       element);
            };
            description_.extra.push_back({columns[i].name, columns[i].type,
                                          add(fmt::format("columns/{}", i), "column", values, pack)});
        }
    }

    bool still_there(const SceneSource& source) const {
        const auto now = io::fingerprint(source.path);
        if (now && now->bytes == source.bytes && now->value == source.fingerprint) return true;
        if (std::exchange(writer_.warned_of_, source.path) != source.path)  // once, not with every autosave
            log::warning(
                "{} is gone or has changed since it was opened, the project keeps its own copy of the scene",
                source.path.string());
        return false;
    }

    static std::string key_of(const char* kind, const GaussianSet& set) {
        const GaussianBuffers b = set.buffers();
        return fmt::format(
            "{} {} {} {} {} {}", kind, static_cast<const void*>(b.position.get()),
            static_cast<const void*>(b.log_scale.get()), static_cast<const void*>(b.rotation.get()),
            static_cast<const void*>(b.opacity_logit.get()), static_cast<const void*>(b.sh.get()));
    }

    /// The base as rows of the file, if it is some of them in their order. Nothing otherwise.
    std::string add_kept_rows(const GaussianSet& base, const GaussianSet& loaded) {
        const std::string key = key_of("kept", base) + key_of("of", loaded);
        const auto known = writer_.members_.find(key);
        std::optional<std::vector<std::uint8_t>> kept;
        if (known == writer_.members_.end() || known->second.of.expired()) {
            kept = kept_rows(base, loaded);
            if (!kept) return {};
        }
        description_.base = io::BaseKind::Kept;
        return add("base.kept", key, base.buffers().position,
                   [&] { return io::pack_member(io::encode_bits(*kept), 1); });
    }

    static std::optional<std::vector<std::uint8_t>> kept_rows(const GaussianSet& base,
                                                              const GaussianSet& loaded) {
        if (base.sh_degree() != loaded.sh_degree() || base.size() > loaded.size()) return std::nullopt;
        const GaussianSpans all = loaded.spans(), some = base.spans();
        std::vector<std::uint8_t> kept(all.size, 0);
        std::size_t next = 0;
        for (std::size_t row = 0; row < all.size && next < some.size; ++row)
            if (same_row(all, row, some, next)) {
                kept[row] = 1;
                ++next;
            }
        if (next < some.size) return std::nullopt;
        return kept;
    }

    void forget_unused() {
        std::erase_if(writer_.members_,
                      [&](const auto& entry) { return entry.second.used != writer_.saves_; });
    }

    ProjectWriter& writer_;
    const std::filesystem::path& path_;
    io::ProjectDescription description_;
    std::vector<std::pair<std::string, std::shared_ptr<const std::string>>> members_;
};

std::string ProjectWriter::pack(const std::filesystem::path& path, const ProjectData& project) {
    const std::lock_guard lock(mutex_);
    return ProjectPacker(*this, path).pack(project);
}

void ProjectWriter::save(const std::filesystem::path& path, const ProjectData& project) {
    write_file(path, pack(path, project));
    remove_stale_temporaries(path.has_parent_path() ? path.parent_path() : std::filesystem::path("."));
}

void save_project(const std::filesystem::path& path, const ProjectData& project) {
    ProjectWriter().save(path, project);
}

}  // namespace gse
