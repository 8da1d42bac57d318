// Surface of a scene that a view shows, for what is put in front of it.
#pragma once

#include "engine/math/camera.h"
#include "engine/scene/scene.h"
#include "engine/scene/transform/seen_place.h"

namespace gse::pipeline {

/// Camera from which the window shows a scene at first.
Camera first_view(const Scene& scene, int width, int height);

/// Depths of a small picture of the splats. Pixels that are rather empty than covered show nothing.
SeenSurface shown_surface(const GaussianSet& set, const Camera& camera, bool antialiased);

/// Share of the rows, or of some of a large set, in the picture with no surface in front of them.
double seen_share(const SeenSurface& surface, const GaussianSet& set);

/// True where most of what was put into a scene is seen from some side of it.
bool is_seen_from_around(const Scene& scene, const GaussianSet& put_in);

}  // namespace gse::pipeline
