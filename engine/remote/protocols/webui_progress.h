// Progress of one drawing of a WebUI server, with the picture in the making.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "engine/remote/protocols/server_link.h"
#include "engine/remote/protocols/webui_request.h"

namespace gse::remote {

/// Body of POST /internal/progress. `known_preview`: number of the newest preview that came, -1 = none;
/// `previews`: newer ones are wanted.
nlohmann::json webui_task_body(const std::string& task, int known_preview = -1, bool previews = false);

/// Looks at one drawing while it is waited for. A fault of a preview changes nothing but that no more are
/// asked for. Refers to all it is given.
class WebuiProgress {
public:
    /// `task`: number of the drawing, where the product has them.
    WebuiProgress(ServerLink& link, WebuiProduct product, const std::string& task, const RedrawOrder& order);
    /// Asks once; reports the progress and shows the preview, if they are told. Throws Error (Cancelled)
    /// only.
    void look(const JobControl& job);

private:
    HttpRequest question() const;
    void show_preview(const nlohmann::json& answer);

    ServerLink& link_;
    const RedrawOrder& order_;
    const std::string& task_;
    const bool has_tasks_;
    bool previews_;           // are wanted
    int known_preview_ = -1;  // number of the newest; -1 = none came
};

}  // namespace gse::remote
