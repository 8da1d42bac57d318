// A finished edit as a project of the editor: the scene with the edit on its stack, and the labels.
#pragma once

#include <nlohmann/json.hpp>

#include "app/engine_names.h"
#include "engine/io/project/project_file.h"
#include "engine/pipeline/run/edit_job.h"

namespace gse::app {

/// Project of a job that has run, with its report (edit_output.h): the window's state after Apply. The
/// scene's file is read again for its fingerprint. Throws Error.
ProjectData project_of(EditJob& job, const nlohmann::ordered_json& report);

/// The project with another edit on its stack, of a job on the scene that it shows. An empty project becomes
/// project_of(). A job on a project file goes on with the edits of that project.
ProjectData project_with(const ProjectData& earlier, EditJob& job, const nlohmann::ordered_json& report);

}  // namespace gse::app
