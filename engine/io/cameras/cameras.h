// Camera files: COLMAP (binary and text), transforms.json (Blender, nerfstudio) and the cameras.json of 3DGS
// training.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "engine/scene/scene.h"

namespace gse {

/// Reads the cameras of a COLMAP folder (the folder itself, its sparse/0 or sparse, or one of its files), a
/// transforms*.json or a cameras.json. Throws Error. Cameras with lens distortion come back with `distorted`
/// set. `scene` = where the splats are, when that is known: nerfstudio writes beside them how it turned and
/// scaled the world.
std::vector<View> load_cameras(const std::filesystem::path& path, const std::filesystem::path& scene = {});

/// Looks beside a scene file (and up to three folders above, as in an Inria output folder) for cameras.
/// Returns the path that load_cameras takes, or nothing.
std::optional<std::filesystem::path> find_cameras(const std::filesystem::path& scene_path);

/// True for a file or folder that holds cameras and no scene: to be loaded for a scene that is open.
bool only_cameras(const std::filesystem::path& path);

/// How well cameras and splats belong together: the share of splat centres [N,3] inside the picture, averaged
/// over some of the views. Cameras in another world (another tool's axes or scale) give close to zero.
double visible_share(const std::vector<View>& views, std::span<const float> position);

/// Writes an Inria cameras.json: camera centre, camera-to-world rotation and focal lengths. The format has no
/// principal point; it is taken as the image centre when read back.
void save_cameras_json(const std::filesystem::path& path, const std::vector<View>& views);

/// Writes a nerfstudio transforms.json: camera-to-world matrices in OpenGL axes (right, up, back) and every
/// frame's own focal lengths, principal point and size, in the world of the splats. Distorted cameras are
/// written as pinholes, with a warning.
void save_transforms_json(const std::filesystem::path& path, const std::vector<View>& views);

/// Either of them, told by the name: "transforms..." is nerfstudio's, any other .json the one of 3DGS.
/// Atomic. Throws Error (InvalidArgument for another ending or no views, Unwritable).
void save_cameras(const std::filesystem::path& path, const std::vector<View>& views);
/// Whether save_cameras() would write nerfstudio's form.
bool names_transforms(const std::filesystem::path& path);

/// Readers on memory. The two COLMAP files go together; `images` and `cameras` are both binary or both text.
std::vector<View> parse_colmap_binary(std::span<const std::byte> cameras, std::span<const std::byte> images);
std::vector<View> parse_colmap_text(std::string_view cameras, std::string_view images);
/// `folder` is where image files are looked for when the file leaves the image size out (Blender); may be
/// empty. nerfstudio's dataparser_transforms.json is looked for in `scene_folder`, then there.
std::vector<View> parse_transforms_json(std::string_view text, const std::filesystem::path& folder,
                                        const std::filesystem::path& scene_folder = {});
std::vector<View> parse_cameras_json(std::string_view text);

}  // namespace gse
