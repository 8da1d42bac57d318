// PEFT's configuration of an adapter, diffusers' copy of it in a file's metadata, and kohya's metadata.
#include "engine/neural/api/lora_alpha.h"

#include <fmt/format.h>
#include <unicode/regex.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/json.h"
#include "engine/neural/api/config.h"

namespace gse::neural {
namespace {

namespace fs = std::filesystem;

constexpr const char* ConfigName = "adapter_config.json";
constexpr std::size_t MostPatterns = 10'000;  // a model has hundreds of layers
constexpr const char* AdapterKey = "lora_adapter_metadata";
constexpr const char* WrongFile = "download the LoRA again, with all files of its folder";

/// One key of PEFT's "rank_pattern" or "alpha_pattern": the end of a layer's name, or a regular expression
/// for it.
class LayerPattern {
public:
    LayerPattern(std::string key, double value) : key_(std::move(key)), value_(value) {
        constexpr std::string_view operators = "\\^$*+?()[]{}|";
        if (key_.find_first_of(operators) == std::string::npos) return;
        UErrorCode status = U_ZERO_ERROR;
        const auto expression = icu::UnicodeString::fromUTF8("(.*\\.)?(" + key_ + ")$");
        pattern_.reset(icu::RegexPattern::compile(expression, 0, status));
        if (U_FAILURE(status)) pattern_ = nullptr;  // as it stands, then
    }
    double value() const { return value_; }
    bool matches(const std::string& layer) const {
        const bool ends = layer.ends_with(key_) &&
                          (layer.size() == key_.size() || layer[layer.size() - key_.size() - 1] == '.');
        if (ends || !pattern_) return ends;
        // Steps of the matcher: an expression of a file may have no end otherwise.
        constexpr std::int32_t most_steps = 10;
        UErrorCode status = U_ZERO_ERROR;
        const auto name = icu::UnicodeString::fromUTF8(layer);
        const std::unique_ptr<icu::RegexMatcher> matcher(pattern_->matcher(name, status));
        if (U_FAILURE(status)) return false;
        matcher->setTimeLimit(most_steps, status);
        return matcher->lookingAt(status) && U_SUCCESS(status);
    }

private:
    std::string key_;
    double value_;
    std::unique_ptr<icu::RegexPattern> pattern_;  // null where the key is plain text
};

/// LoraConfig of PEFT, as far as the strength depends on it.
struct AdapterConfig {
    std::optional<double> alpha, rank;
    bool rank_stabilised = false;
    std::vector<LayerPattern> alphas, ranks;

    static std::optional<double> first_match(const std::vector<LayerPattern>& patterns,
                                             const std::string& layer) {
        for (const auto& pattern : patterns)
            if (pattern.matches(layer)) return pattern.value();
        return std::nullopt;
    }
    /// Alpha that divided by the rank gives PEFT's scale.
    double by_rank(double stated, std::int64_t rank_of_layer) const {
        return rank_stabilised ? stated * std::sqrt(static_cast<double>(rank_of_layer)) : stated;
    }
};

std::optional<double> number_in(const std::string& text) {
    double value = 0;
    const char* end = text.data() + text.size();
    const auto read = std::from_chars(text.data(), end, value);
    return read.ec == std::errc() && read.ptr == end && std::isfinite(value) ? std::optional(value)
                                                                             : std::nullopt;
}

/// Reads one object of keys that begin with `prefix`.
class AdapterReader {
public:
    AdapterReader(const Json& json, std::string prefix, std::string name, const fs::path& path)
        : json_(json), prefix_(std::move(prefix)), name_(std::move(name)), path_(path) {}

    AdapterConfig read() const {
        AdapterConfig config;
        config.alpha = number("lora_alpha");
        config.rank = number("r");
        if (const auto* stabilised = find("use_rslora"))
            config.rank_stabilised = stabilised->is_boolean() && stabilised->get<bool>();
        config.alphas = patterns("alpha_pattern");
        config.ranks = patterns("rank_pattern");
        return config;
    }

private:
    const Json* find(const char* key) const {
        const auto found = json_.find(prefix_ + key);
        return found == json_.end() || found->is_null() ? nullptr : &*found;
    }
    double value_of(const std::string& key, const Json& json) const {
        const auto value = json.is_number()   ? std::optional(json.get<double>())
                           : json.is_string() ? number_in(json.get<std::string>())
                                              : std::nullopt;
        if (!value || !std::isfinite(*value))
            throw Error(ErrorCode::Malformed,
                        fmt::format("\"{}\" in the LoRA's {} is not a number", key, name_), WrongFile, path_);
        return *value;
    }
    std::optional<double> number(const char* key) const {
        const auto* json = find(key);
        return json != nullptr ? std::optional(value_of(key, *json)) : std::nullopt;
    }
    std::vector<LayerPattern> patterns(const char* key) const {
        std::vector<LayerPattern> result;
        const auto* json = find(key);
        if (json == nullptr) return result;
        if (!json->is_object() || json->size() > MostPatterns)
            throw Error(ErrorCode::Malformed,
                        fmt::format("\"{}\" in the LoRA's {} is not a list of layers", key, name_), WrongFile,
                        path_);
        for (const auto& [layer, value] : json->items()) result.emplace_back(layer, value_of(layer, value));
        return result;
    }

    const Json& json_;
    const std::string prefix_, name_;
    const fs::path& path_;
};

Json object_in(const std::string& text, const std::string& name, const fs::path& path) {
    auto json = try_parse_json<Json>(text);
    if (!json.is_object())
        throw Error(ErrorCode::Malformed, fmt::format("the LoRA's {} is not a JSON object", name), WrongFile,
                    path);
    return json;
}

/// The part of diffusers' metadata that is about UNet or text encoder.
AdapterConfig metadata_config(const Json& json, bool text, const fs::path& path) {
    const std::string part = text ? "text_encoder" : "unet",
                      name = fmt::format("metadata \"{}\"", AdapterKey);
    if (const auto inner = json.find(part); inner != json.end() && inner->is_object())
        return AdapterReader(*inner, "", name, path).read();
    const bool prefixed = std::any_of(json.items().begin(), json.items().end(), [](const auto& item) {
        return item.key().starts_with("unet.") || item.key().starts_with("text_encoder");
    });
    return AdapterReader(json, prefixed ? part + "." : "", name, path).read();
}

/// Sources of one file, by UNet and text encoder.
struct AlphaSources {
    std::optional<AdapterConfig> beside;  // adapter_config.json
    std::array<AdapterConfig, 2> inside;
    std::array<std::optional<double>, 2> plain;  // of the metadata, without patterns
    std::optional<double> kernels;               // kohya's convolutions of more than one pixel
};

std::optional<double> plain_number(const std::map<std::string, std::string>& metadata,
                                   const std::string& key) {
    const auto found = metadata.find(key);
    return found == metadata.end() ? std::nullopt : number_in(found->second);
}

/// "conv_alpha" of kohya's network arguments. Its own default is 1.
std::optional<double> kernel_alpha(const std::map<std::string, std::string>& metadata) {
    const auto found = metadata.find("ss_network_args");
    if (found == metadata.end()) return std::nullopt;
    const auto json = try_parse_json(found->second);
    if (!json.is_object() || !json.contains("conv_dim") || json["conv_dim"].is_null()) return std::nullopt;
    if (!json.contains("conv_alpha")) return 1.0;
    const auto& alpha = json["conv_alpha"];
    if (alpha.is_number()) return alpha.get<double>();
    return alpha.is_string() ? number_in(alpha.get<std::string>()) : std::nullopt;
}

AlphaSources sources_of(const fs::path& file, const std::map<std::string, std::string>& metadata, bool peft) {
    AlphaSources sources;
    const auto config = file.parent_path() / ConfigName;
    if (std::error_code ignored; peft && fs::exists(config, ignored)) {
        const auto json = read_json_file(config);
        if (!json.is_object())
            throw Error(ErrorCode::Malformed, "the LoRA's configuration is not a JSON object", WrongFile,
                        config);
        sources.beside = AdapterReader(json, "", ConfigName, config).read();
    }
    Json adapter;
    if (const auto found = metadata.find(AdapterKey); found != metadata.end())
        adapter = object_in(found->second, fmt::format("metadata \"{}\"", AdapterKey), file);
    for (const bool text : {false, true}) {
        auto& plain = sources.plain[text ? 1 : 0];
        if (adapter.is_object()) sources.inside[text ? 1 : 0] = metadata_config(adapter, text, file);
        for (const auto& key : {std::string(text ? "text_encoder.lora_alpha" : "unet.lora_alpha"),
                                std::string("lora_alpha"), std::string("ss_network_alpha")})
            if (!plain) plain = plain_number(metadata, key);
    }
    sources.kernels = kernel_alpha(metadata);
    return sources;
}

/// Layer of PEFT whose rank is not the configuration's; null where all agree. Such a configuration is of
/// another adapter.
const LoraLayer* contradicted(const AdapterConfig& config, const std::vector<LoraLayer>& layers) {
    const auto differs = [&](const LoraLayer& layer) {
        auto rank = AdapterConfig::first_match(config.ranks, layer.name);
        if (!rank) rank = config.rank;
        return layer.peft && rank && *rank != static_cast<double>(layer.rank);
    };
    const auto found = std::find_if(layers.begin(), layers.end(), differs);
    return found == layers.end() ? nullptr : &*found;
}

double alpha_of(const AlphaSources& sources, const LoraLayer& layer) {
    std::vector<const AdapterConfig*> configs;
    if (sources.beside && layer.peft) configs.push_back(&*sources.beside);
    configs.push_back(&sources.inside[layer.text ? 1 : 0]);
    for (const auto* config : configs)
        if (const auto alpha = AdapterConfig::first_match(config->alphas, layer.name))
            return config->by_rank(*alpha, layer.rank);
    for (const auto* config : configs)
        if (config->alpha) return config->by_rank(*config->alpha, layer.rank);
    if (layer.kernel && sources.kernels) return *sources.kernels;
    return sources.plain[layer.text ? 1 : 0].value_or(static_cast<double>(layer.rank));
}

}  // namespace

StatedAlphas stated_alphas(const fs::path& file, const std::map<std::string, std::string>& metadata,
                           const std::vector<LoraLayer>& layers) {
    StatedAlphas stated;
    if (layers.empty()) return stated;
    const bool peft = std::any_of(layers.begin(), layers.end(), [](const auto& layer) { return layer.peft; });
    auto sources = sources_of(file, metadata, peft);
    if (sources.beside)
        if (const auto* layer = contradicted(*sources.beside, layers)) {
            stated.note = fmt::format(
                "the {} beside the LoRA \"{}\" is not used: it states another rank than the {} of \"{}\"",
                ConfigName, file.filename().string(), layer->rank, layer->name);
            sources.beside.reset();
        }
    for (const auto& layer : layers) stated.alphas.push_back(alpha_of(sources, layer));
    return stated;
}

}  // namespace gse::neural
