// Entry to the plug-in that speaks to image servers, in plain types: the program loads it on first use.
#pragma once

#include <array>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/remote/api/image_server.h"
#include "engine/remote/api/server_kind.h"
#include "engine/remote/api/server_lora.h"
#include "engine/remote/api/server_option.h"

namespace gse::remote {

using Milliseconds = std::chrono::milliseconds;

/// Waiting times towards a server. Tests shorten them.
struct ServerTimes {
    Milliseconds connect{5'000};      // until a connection stands
    Milliseconds look{5'000};         // first byte, while it is found out what the server speaks
    Milliseconds answer{10'000};      // first byte of a question that needs no drawing
    Milliseconds drawing{1'800'000};  // first byte of an answer that is drawn meanwhile
    Milliseconds silence{60'000};     // between two bytes
    Milliseconds body{600'000};       // from the first byte of a body to its last
    Milliseconds poll{250};           // between two looks at a job: in its first 10 s
    Milliseconds slow_poll{1'000};    // and later
    Milliseconds first_retry{1'000};  // doubles with each retry
    Milliseconds longest_retry{16'000};
    Milliseconds busy{300'000};  // in all, while a server says that it is busy
    Milliseconds away{60'000};   // in all, while nobody answers
};

/// A server as the artist named it.
struct ServerAddress {
    std::string url;
    std::optional<ServerKind> kind = {};     // none = found out
    std::string model = {};                  // to draw with; empty = the one that is loaded
    std::filesystem::path workflow = {};     // ComfyUI: a file in API format; empty = a bundled one that fits
    std::filesystem::path ca_file = {};      // certificates to trust beside the system's; empty = none
    std::vector<ServerOption> options = {};  // of every request, beside what an order holds
    std::vector<ServerLora> loras = {};      // of the server, to draw with
    bool allow_paid_nodes = false;           // ComfyUI: nodes that send pictures on and cost money
    ServerTimes times = {};
};

/// Ports on which programs for pictures listen unless they are told otherwise: WebUI, ComfyUI, sd-server,
/// koboldcpp, vLLM-Omni.
inline constexpr std::array<int, 5> UsualPorts{7860, 8188, 1234, 5001, 8000};

/// Program that answers on a port of this machine.
struct FoundServer {
    std::string url;
    std::string product = {};  // "sd-server"; for people. Empty where `problem` is not
    std::string model = {};    // empty = not told
    std::string problem = {};  // why it cannot be used, with a remedy; empty = it can
};

/// Image servers over HTTP.
class RemoteApi {
public:
    virtual ~RemoteApi() = default;
    /// Finds out which protocol the server speaks, unless it is stated, and whether it is there. Sends no
    /// picture. Throws Error as ImageServer::probe(), and (InvalidArgument) for an address that is refused.
    virtual std::unique_ptr<ImageServer> connect(const ServerAddress& address, const JobControl& job) = 0;
    /// Asks these ports of the loopback what listens there, by GET alone and without passwords. Ports where
    /// nothing listens are left out. Throws Error (Cancelled).
    virtual std::vector<FoundServer> find_here(std::span<const int> ports, const JobControl& job) = 0;
    /// Keeps user name and password of an address in the user's file of credentials, and gives the address
    /// without them. Throws Error (InvalidArgument, Unwritable).
    virtual std::string keep_credentials(const std::string& url) = 0;
    /// Forgets what the file of credentials has for an address. Throws Error (InvalidArgument, Unwritable).
    virtual void forget_credentials(const std::string& url) = 0;
};

}  // namespace gse::remote
