// Place where somebody who points at a thing of the truth clicks.
#pragma once

#include <optional>
#include <string>

#include "engine/laboratory/eval/real/real_figures.h"

namespace gse::bench {

/// Place for --at: the pixel within what is seen of the rows `thing` [N] that lies farthest from its outline.
/// The picture is the one of the task's box, else one from the scene's front, about the true up axis. None
/// where nothing of the thing is seen.
std::optional<std::string> truth_click(pipeline::Painter& painter, const RealScene& scene,
                                       const RealTask& task, const Scene& splats, const Rows& thing);

}  // namespace gse::bench
