// News of an image server at work: previews, and the time that its pictures took.
#pragma once

#include <string>

#include "engine/base/shared_queue.h"
#include "engine/remote/api/server_settings.h"
#include "engine/remote/api/server_url.h"
#include "engine/remote/views/agreement.h"
#include "engine/remote/views/picture_source.h"

namespace gse::app {

/// Word of a server at work, on its way from the thread that waits for it to the window.
struct ServerNews {
    remote::ServerSettings settings;  // that it draws with
    remote::Agreement agreement = remote::Agreement::None;
    std::string model;  // that it has loaded; empty = not told
    remote::DrawingNews drawing;
};

/// Stage of a job that asks a server what it is.
inline std::string asking_text(const remote::ServerSettings& settings) {
    return "asking " + remote::parse_server_url(settings.url).url.nickname() + " what it is";
}

using ServerRoad = SharedQueue<ServerNews>;

}  // namespace gse::app
