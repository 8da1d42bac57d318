// Images of a COLMAP model, gathered by its two readers.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "engine/base/error.h"
#include "engine/io/cameras/camera_models.h"
#include "engine/io/cameras/cameras.h"
#include "engine/io/cameras/left_out.h"

namespace gse::io {

/// Cameras of a model by their numbers; an error in place of those that cannot be used.
using ColmapCameras = std::map<std::uint32_t, std::variant<Intrinsics, Error>>;

class ColmapViews {
public:
    explicit ColmapViews(const ColmapCameras& cameras) : cameras_(cameras) {}

    /// `pose` is the quaternion (w, x, y, z) and the translation, world to camera.
    void add(std::string_view name, const std::array<double, 7>& pose, std::uint32_t camera);
    /// `label` as it is to be shown. The message of `why` is the reason alone.
    void leave_out(std::string label, const Error& why) { left_out_.add(std::move(label), why); }
    /// Views by name, since COLMAP's own order is that of a hash table. Throws Error where none is left.
    CameraList finish();

private:
    const ColmapCameras& cameras_;
    std::vector<View> views_;
    LeftOut left_out_;
    NameList panoramas_;
};

}  // namespace gse::io
