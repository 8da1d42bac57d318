// Connection: address and password, detection, the class of the protocol.
#include "engine/remote/protocols/connect.h"

#include "engine/base/error.h"
#include "engine/remote/http/credentials.h"
#include "engine/remote/protocols/comfy_server.h"
#include "engine/remote/protocols/detection.h"
#include "engine/remote/protocols/openai_server.h"
#include "engine/remote/protocols/sdcpp_server.h"
#include "engine/remote/protocols/server_link.h"
#include "engine/remote/protocols/webui_server.h"

namespace gse::remote {
namespace {

std::optional<Credential> credential_for(const TypedUrl& typed) {
    if (!typed.user.name.empty() || !typed.user.password.empty()) {
        check_secret_may_go(typed.url);
        return Credential{{}, typed.user};
    }
    return find_credential(typed.url);
}

std::unique_ptr<ImageServer> server_of(const DetectedServer& found, std::unique_ptr<ServerLink> link,
                                       const ServerAddress& address) {
    switch (found.kind) {
        case ServerKind::SdCpp: return std::make_unique<SdCppServer>(std::move(link), address);
        case ServerKind::Webui: return std::make_unique<WebuiServer>(std::move(link), found.product, address);
        case ServerKind::OpenAi: return std::make_unique<OpenAiServer>(std::move(link), address);
        case ServerKind::Comfy: return std::make_unique<ComfyServer>(std::move(link), address);
    }
    throw Error(ErrorCode::InvalidArgument, "this protocol is not known");
}

}  // namespace

std::unique_ptr<ImageServer> connect(const ServerAddress& address, const JobControl& job) {
    const auto typed = parse_server_url(address.url);
    auto link = std::make_unique<ServerLink>(typed.url, credential_for(typed), address);
    const auto found = detect_server(*link, address.kind, job);
    auto server = server_of(found, std::move(link), address);
    server->probe(job);
    return server;
}

std::string keep_credentials(const std::string& url) {
    const auto typed = parse_server_url(url);
    if (!typed.user.name.empty() || !typed.user.password.empty()) {
        check_secret_may_go(typed.url);
        keep_credential(typed.url, typed.user);
    }
    return typed.url.at("");
}

void forget_credentials(const std::string& url) { forget_credential(parse_server_url(url).url); }

}  // namespace gse::remote
