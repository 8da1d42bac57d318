// Names of the protocols of image servers.
#include "engine/remote/api/server_kind.h"

#include <array>
#include <utility>

#include <fmt/format.h>

#include "engine/base/error.h"
#include "engine/base/printable.h"

namespace gse::remote {
namespace {

constexpr std::array<std::pair<ServerKind, std::string_view>, 4> Names = {{{ServerKind::Webui, "webui"},
                                                                           {ServerKind::OpenAi, "openai"},
                                                                           {ServerKind::SdCpp, "sdcpp"},
                                                                           {ServerKind::Comfy, "comfy"}}};

}  // namespace

std::string_view server_kind_name(ServerKind kind) {
    for (const auto& [known, name] : Names)
        if (known == kind) return name;
    return {};
}

ServerKind server_kind_of(std::string_view name) {
    for (const auto& [kind, known] : Names)
        if (known == name) return kind;
    throw Error(ErrorCode::InvalidArgument,
                fmt::format("\"{}\" is no protocol of image servers", printable(name)),
                "name one of webui, openai, sdcpp, comfy");
}

}  // namespace gse::remote
