// Names and weights of a server's LoRAs.
#include "engine/remote/api/server_lora.h"

#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "engine/base/error.h"
#include "engine/base/printable.h"

namespace gse::remote {
namespace {

constexpr double MostWeight = 10;
constexpr std::size_t LongestName = 512;

}  // namespace

std::string_view lora_names_name(LoraNames names) {
    switch (names) {
        case LoraNames::None: return "none";
        case LoraNames::Listed: return "listed";
        case LoraNames::Any: return "any";
    }
    return {};
}

ServerLora parse_server_lora(std::string_view text) {
    ServerLora lora{std::string(text), 1};
    const auto colon = text.rfind(':');
    if (colon != std::string_view::npos) {
        double weight = 0;
        const char* end = text.data() + text.size();
        const auto read = std::from_chars(text.data() + colon + 1, end, weight);
        if (read.ec == std::errc() && read.ptr == end) lora = {std::string(text.substr(0, colon)), weight};
    }
    if (lora.name.empty() || lora.name.size() > LongestName ||
        lora.name.find_first_of("<>:\n") != std::string::npos)
        throw Error(ErrorCode::InvalidArgument,
                    fmt::format("\"{}\" names no LoRA of a server", printable(text.substr(0, 80))),
                    "write it as NAME or NAME:0.8");
    if (!(std::abs(lora.weight) <= MostWeight))
        throw Error(
            ErrorCode::InvalidArgument,
            fmt::format("the LoRA's weight {} is outside -{}..{}", lora.weight, MostWeight, MostWeight),
            "1 is as it was trained, 0 is without it");
    return lora;
}

std::vector<ServerLora> parse_server_loras(const std::vector<std::string>& texts) {
    std::vector<ServerLora> loras;
    for (const auto& text : texts) loras.push_back(parse_server_lora(text));
    return loras;
}

}  // namespace gse::remote
