// Views that a server would draw, as files that an artist can paint over.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "engine/edit/interfaces/interfaces.h"
#include "engine/pipeline/run/edit_job.h"

namespace gse::pipeline {

/// Views of the first round of a located job, at the size that its server is sent. Nothing is sent. Throws
/// Error (InvalidArgument) without a server, and as EditJob::run().
std::vector<edit::EditView> views_to_draw(EditJob& job);

/// Writes NAME.png and NAME_mask.png per view. Gives [{"view", "file", "mask", "share"}]: names, files, and
/// the share of the picture that may change.
nlohmann::ordered_json write_views(const std::filesystem::path& folder,
                                   const std::vector<edit::EditView>& views);

}  // namespace gse::pipeline
