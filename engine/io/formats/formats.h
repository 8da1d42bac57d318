// The scene formats behind one shape: detect = "is it mine?", parse = read it or say what is broken.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "engine/base/file.h"
#include "engine/io/formats/save_options.h"

namespace gse::io {

using Bytes = std::span<const std::byte>;

/// One readable format. `detect` looks at the first bytes and the (lower-case) file name and never throws;
/// `parse` throws Error when the content is this format and broken.
struct SceneReader {
    const char* name;
    bool (*detect)(Bytes bytes, std::string_view name);
    Scene (*parse)(Bytes bytes);
};

/// All readers, most specific first.
std::span<const SceneReader> scene_readers();

bool detect_ply(Bytes bytes, std::string_view name);
Scene parse_gaussian_ply(Bytes bytes);
/// The same without ever holding the whole file: nothing where it is no such file, or one that only
/// parse_gaussian_ply can read or refuse.
std::optional<Scene> load_gaussian_ply(const InputFile& file);

bool detect_compressed_ply(Bytes bytes, std::string_view name);
Scene parse_compressed_ply(Bytes bytes);

bool detect_splat(Bytes bytes, std::string_view name);
Scene parse_splat(Bytes bytes);

bool detect_spz(Bytes bytes, std::string_view name);
Scene parse_spz(Bytes bytes);

bool detect_sog(Bytes bytes, std::string_view name);
/// A .sog archive: a zip of meta.json and WebP textures.
Scene parse_sog(Bytes bytes);
/// The same unpacked: `meta` is the meta.json, its files lie beside it.
Scene load_sog_folder(const std::filesystem::path& meta);
/// A streamed SOG: the finest level of a lod-meta.json.
Scene load_sog_levels(const std::filesystem::path& lod_meta);

bool detect_ksplat(Bytes bytes, std::string_view name);
Scene parse_ksplat(Bytes bytes);

/// Writers to memory; the caller writes the bytes atomically. Quantised formats drop unusable rows with a
/// warning.
std::string write_gaussian_ply(const Scene& scene, const SaveOptions& options);
/// The same a piece at a time, for what nobody wants to hold as a whole; throws before the first piece or not
/// at all.
void write_gaussian_ply(const Scene& scene, const SaveOptions& options,
                        const std::function<void(std::string_view piece)>& take);
/// `order`, when wanted: row order[i] of the usable rows became row i.
std::string write_compressed_ply(const Scene& scene, std::vector<std::uint32_t>* order = nullptr);
std::string write_splat(const Scene& scene);
/// SOG version 2 as an archive; `order` as above. Throws Error (InvalidArgument) without a splat or with more
/// than the textures have room for.
std::string write_sog(const Scene& scene, std::vector<std::uint32_t>* order = nullptr);
/// `version` 2, 3 or 4. Throws Error (InvalidArgument) for another.
std::string write_spz(const Scene& scene, int version = 3);
/// Throws what write_spz would.
void check_spz_version(int version);

}  // namespace gse::io
