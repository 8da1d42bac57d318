// Shapes drawn over the viewport as areas of its picture.
#pragma once

#include "engine/scene/label_ops.h"
#include "ui/model/command.h"

namespace gse::app {

inline ScreenArea screen_area(const ui::ScreenRegion& region) {
    return {region.polygon, region.circles, region.radius_px};
}

}  // namespace gse::app
