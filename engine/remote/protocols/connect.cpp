// Connection: address and password, detection, the class of the protocol.
#include "engine/remote/protocols/connect.h"

#include <fmt/format.h>

#include "engine/base/error.h"
#include "engine/base/printable.h"
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

// Waits on this machine, where who listens answers at once.
constexpr Milliseconds NearConnect{1'000}, NearLook{2'000};

/// Program that listens on a port of this machine; none where nothing does.
std::optional<FoundServer> found_at(int port, const JobControl& job) {
    ServerAddress address;
    address.url = fmt::format("http://127.0.0.1:{}", port);
    address.times.connect = NearConnect;
    address.times.look = address.times.answer = NearLook;
    auto link = std::make_unique<ServerLink>(parse_server_url(address.url).url, std::nullopt, address);
    if (!link->is_listening(job)) return std::nullopt;
    FoundServer found{address.url};
    try {
        const auto what = detect_server(*link, std::nullopt, job);
        const auto facts = server_of(what, std::move(link), address)->probe(job);
        found.product = printable(facts.product);
        found.model = printable(facts.model);
    } catch (const Error& error) {
        if (error.code() == ErrorCode::Cancelled) throw;
        found.problem =
            fmt::format("{}{}{}", printable(error.message()), error.hint().empty() ? "" : "; ", error.hint());
    }
    return found;
}

}  // namespace

std::vector<FoundServer> find_here(std::span<const int> ports, const JobControl& job) {
    std::vector<FoundServer> servers;
    for (std::size_t i = 0; i < ports.size(); ++i) {
        job.report("looking for image servers on this machine", static_cast<int>(i),
                   static_cast<int>(ports.size()));
        if (auto found = found_at(ports[i], job)) servers.push_back(std::move(*found));
    }
    return servers;
}

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
