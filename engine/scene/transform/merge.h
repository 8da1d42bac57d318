// A scene put into another: its rows behind those that are there, labelled by its name.
#pragma once

#include <cstdint>
#include <string>

#include "engine/scene/document.h"
#include "engine/scene/scene.h"
#include "engine/scene/transform/affine.h"

namespace gse {

/// Both scenes in the world of `host`, with the rows of `guest` under the map behind its own. Facts, offset
/// and up are the host's. A new label with that name, numbered where it is taken, marks the guest; labels of
/// the host stay, those of the guest do not come along. Columns of the host's file get zeros for new rows.
/// Warnings of both come along. Throws OutOfMemory.
Scene merged(const Scene& host, const Scene& guest, const Affine& placement, const std::string& name);

/// Edit that adds the rows of `guest` under the map to a document. with_edit() with `beside` labels them.
EditNode merge_of(const DocumentState& state, const Scene& guest, const Affine& placement,
                  const std::string& name, std::uint64_t id);

}  // namespace gse
