// Sizes that masks are measured in, whatever a picture's own size is.
#pragma once

namespace gse::edit {

constexpr int ClusterGrid = 64;  // clustering happens on maps of this width (METHOD.md, Masks in a view)
constexpr double ReferenceSide = 512;  // pictures for which lengths in pixels are stated

}  // namespace gse::edit
