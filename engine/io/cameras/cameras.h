// Camera files: COLMAP (binary and text), transforms.json (Blender, nerfstudio) and the cameras.json of 3DGS
// training.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/scene/scene.h"

namespace gse {

/// Cameras of a file or folder, and what was odd about them, one sentence each.
struct CameraList {
    std::vector<View> views;
    std::vector<std::string> notes;
};

/// Reads cameras. `path` is a COLMAP model (its folder, one of its files, or a folder above it in any usual
/// layout), a transforms*.json or a cameras.json. Names count in any case. Single cameras that cannot be used
/// are left out, with a note. Throws Error, also where none is left. Cameras with lens distortion come back
/// with `distorted` set. `scene` is the place of the splats, if known: nerfstudio writes beside them how it
/// turned and scaled the world.
///
/// A folder's cameras.json comes before its COLMAP model, and that before transforms.json, then
/// transforms_train.json. The order of COLMAP layouts is in camera_folders.cpp; a note says which one of
/// several was taken.
CameraList read_cameras(const std::filesystem::path& path, const std::filesystem::path& scene = {});

/// The views of read_cameras(). The notes go to the log, as warnings.
std::vector<View> load_cameras(const std::filesystem::path& path, const std::filesystem::path& scene = {});

/// Looks for cameras beside a scene file and up to three folders above (as in an Inria output folder).
/// Returns the path that read_cameras takes, or nothing: NAME.cameras.json of the scene, or a folder.
std::optional<std::filesystem::path> find_cameras(const std::filesystem::path& scene_path);

/// True for a file or folder that holds cameras and no scene. They are to be loaded for an open scene.
bool only_cameras(const std::filesystem::path& path);

/// Agreement of cameras and splats: the share of splat centres [N,3] inside the picture, averaged over some
/// of the views. Cameras in another world (another tool's axes or scale) give close to zero.
double visible_share(const std::vector<View>& views, std::span<const float> position);

/// Writes an Inria cameras.json: camera centre, camera-to-world rotation and focal lengths. The format has no
/// principal point; the image centre is read back.
void save_cameras_json(const std::filesystem::path& path, const std::vector<View>& views);

/// Writes a nerfstudio transforms.json, in the world of the splats. It has camera-to-world matrices in OpenGL
/// axes (right, up, back), and every frame's focal lengths, principal point and size. Distorted cameras are
/// written as pinholes, with a warning.
void save_transforms_json(const std::filesystem::path& path, const std::vector<View>& views);

/// Writes either of them. A name "transforms..." gives nerfstudio's, any other .json that of 3DGS. Atomic.
/// Throws Error (InvalidArgument for another ending or no views, Unwritable).
void save_cameras(const std::filesystem::path& path, const std::vector<View>& views);
/// True when save_cameras() would write nerfstudio's form.
bool names_transforms(const std::filesystem::path& path);

/// Readers on memory. The two COLMAP files go together; both are binary or both are text.
CameraList parse_colmap_binary(std::span<const std::byte> cameras, std::span<const std::byte> images);
CameraList parse_colmap_text(std::string_view cameras, std::string_view images);
/// Reader on memory. `folder` holds the image files, for files that leave the image size out (Blender); may
/// be empty. nerfstudio's dataparser_transforms.json is looked for in `scene_folder`, then in `folder`.
CameraList parse_transforms_json(std::string_view text, const std::filesystem::path& folder,
                                 const std::filesystem::path& scene_folder = {});
CameraList parse_cameras_json(std::string_view text);

}  // namespace gse
