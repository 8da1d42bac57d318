// Detection. The places that hand out a server's own passwords (cmd-flags, sysinfo) are never asked.
#include "engine/remote/protocols/detection.h"

#include <fmt/format.h>

#include "engine/base/json.h"
#include "engine/remote/protocols/server_error.h"

namespace gse::remote {
namespace {

bool is_koboldcpp(ServerLink& link, const JobControl& job) {
    const auto json = link.look("/api/extra/version", job);
    return json && text_of(*json, "result") == "KoboldCpp";
}

bool is_sd_server(ServerLink& link, const JobControl& job) {
    const auto json = link.look("/sdcpp/v1/capabilities", job);
    return json && json->is_object();
}

bool is_comfy(ServerLink& link, const JobControl& job) {
    const auto json = link.look("/system_stats", job);
    return json && !text_of(value_of(*json, "system"), "comfyui_version").empty();
}

bool has_list(ServerLink& link, const char* place, const JobControl& job) {
    const auto json = link.look(place, job);
    return json && json->is_array();
}

bool has_object(ServerLink& link, const char* place, const JobControl& job) {
    const auto json = link.look(place, job);
    return json && json->is_object() && !json->empty();
}

/// The program behind the WebUI protocol; none where it is not spoken.
std::optional<WebuiProduct> webui_product(ServerLink& link, const JobControl& job) {
    if (has_object(link, "/sdapi/v1/version", job)) return WebuiProduct::SdNext;
    if (has_list(link, "/sdapi/v1/sd-modules", job)) return WebuiProduct::Forge;
    if (has_list(link, "/sdapi/v1/sd-vae", job)) return WebuiProduct::A1111;
    if (has_object(link, "/sdapi/v1/options", job)) return WebuiProduct::Other;
    return std::nullopt;
}

bool speaks_openai(ServerLink& link, const JobControl& job) {
    const auto json = link.look("/v1/models", job);
    return json && value_of(*json, "data").is_array();
}

/// Error for a server that speaks none of the protocols: names the programs that are known for it.
Error unknown_server(ServerLink& link, const JobControl& job) {
    const auto name = link.url().nickname();
    if (has_object(link, "/api/v1/app/version", job))
        return {ErrorCode::Foreign, fmt::format("{} is InvokeAI, which speaks no protocol known here", name),
                "use ComfyUI, A1111, Forge, SD.Next, koboldcpp or sd-server"};
    const auto missing = link.ask_any_status(link.get("/sdapi/v1/options"), {}, job);
    if (missing.status == 404 && missing.body.find("detail") != std::string::npos)
        return {ErrorCode::Foreign, fmt::format("{} is a WebUI without its interface for programs", name),
                "start it with --api"};
    return {ErrorCode::Foreign, fmt::format("{} speaks no protocol of image servers", name),
            "look at the address and its port; A1111 and Forge must be started with --api"};
}

DetectedServer detect_webui(ServerLink& link, const JobControl& job) {
    if (is_sd_server(link, job)) return {ServerKind::Webui, WebuiProduct::SdServer};
    if (is_koboldcpp(link, job)) return {ServerKind::Webui, WebuiProduct::KoboldCpp};
    if (const auto product = webui_product(link, job)) return {ServerKind::Webui, *product};
    throw unknown_server(link, job);
}

}  // namespace

DetectedServer detect_server(ServerLink& link, std::optional<ServerKind> stated, const JobControl& job) {
    if (stated == ServerKind::Webui) return detect_webui(link, job);
    if (stated) return {*stated};
    if (is_sd_server(link, job)) return {ServerKind::SdCpp};
    if (is_koboldcpp(link, job)) return {ServerKind::Webui, WebuiProduct::KoboldCpp};
    if (is_comfy(link, job)) return {ServerKind::Comfy};
    if (const auto product = webui_product(link, job)) return {ServerKind::Webui, *product};
    if (speaks_openai(link, job)) return {ServerKind::OpenAi};
    throw unknown_server(link, job);
}

}  // namespace gse::remote
