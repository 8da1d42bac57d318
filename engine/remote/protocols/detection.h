// Finds out what a server is, by questions that change nothing there.
#pragma once

#include <optional>

#include "engine/remote/protocols/server_link.h"
#include "engine/remote/protocols/webui_request.h"

namespace gse::remote {

/// Protocol of a server, and for the WebUI protocol the program that speaks it.
struct DetectedServer {
    ServerKind kind = ServerKind::Webui;
    WebuiProduct product = WebuiProduct::Other;  // for ServerKind::Webui
};

/// Asks about the protocols in turn, or about the programs of the one that is `stated`. Throws Error
/// (Foreign) where nobody answers, or none of the protocols is spoken.
DetectedServer detect_server(ServerLink& link, std::optional<ServerKind> stated, const JobControl& job);

}  // namespace gse::remote
