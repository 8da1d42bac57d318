// LoRA files against kohya's merge script, diffusers with PEFT, and LyCORIS: merged weights, outputs,
// gradients, refusals.
#include <algorithm>
#include <cmath>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "engine/base/error.h"
#include "engine/neural/diffusion/text_encoder.h"
#include "engine/neural/diffusion/unet.h"
#include "engine/neural/weights/key_map.h"
#include "engine/neural/weights/lora.h"
#include "tests/golden/neural/golden_case.h"
#include "tests/golden/neural/tolerances.h"

namespace {

using namespace gse;
using namespace gse::neural;
using namespace gse::test;

// The tolerances of the case's README, and the wave its checksums are taken with: sum over k of W[k] cos(0.37
// (k + 1)).
constexpr double MergedTolerance = 1e-6;
constexpr double MergedOutputTolerance = 3e-5;
constexpr double ChecksumTolerance = 1e-4;
constexpr double ChecksumFrequency = 0.37;

/// The networks the case starts from, and their inputs.
struct LoraCase {
    GoldenCase golden{"lora"}, unet_case{"unet_sd1"}, text_case{"clip_text_sd1"};
    bool present() const { return golden.present && unet_case.present && text_case.present; }

    UNet unet() const {
        UNet network(UNetConfig::from_json(unet_case.json("config.json"), unet_case.folder));
        load_weights(*network, unet_case.tensors("diffusion_pytorch_model.safetensors"), unet_plan());
        return network;
    }
    ClipTextEncoder text() const {
        ClipTextEncoder network(
            TextEncoderConfig::from_json(text_case.json("config.json"), text_case.folder));
        load_weights(*network, text_case.tensors("model.safetensors"), text_encoder_plan());
        return network;
    }
    torch::Tensor run(const UNet& network) const {
        const auto io = unet_case.tensors();
        return network->forward(io.tensor("sample"), io.tensor("t0"), io.tensor("encoder_hidden_states"));
    }
    torch::Tensor run(const ClipTextEncoder& network) const {
        return network->forward(text_case.tensors().tensor("input_ids").narrow(0, 0, 2)).last_hidden;
    }
    LoraWeights read(const std::string& name) const {
        return read_lora(golden.folder / (name + ".safetensors"));
    }
};

struct Merged {
    UNet unet{nullptr};
    ClipTextEncoder text{nullptr};

    explicit Merged(const LoraCase& lora) : unet(lora.unet()), text(lora.text()) {}
    void merge(const LoraWeights& weights, double strength) {
        merge_lora(*unet, weights.unet, strength);
        merge_lora(*text, weights.text, strength);
    }
    /// "unet.down_blocks...weight", "text_encoder.text_model...weight" ("te." in io.safetensors).
    torch::Tensor weight(const std::string& name) const {
        const auto dot = name.find('.');
        const torch::nn::Module& network =
            name.starts_with("unet.") ? static_cast<const torch::nn::Module&>(*unet) : *text;
        const auto parameters = network.named_parameters();
        const auto* found = parameters.find(name.substr(dot + 1));
        DOCTEST_REQUIRE_MESSAGE(found != nullptr, name);
        return found->detach();
    }
};

/// One line of checks.tsv.
struct CheckedWeight {
    std::string weight;
    std::int64_t rank = 0;
    double scale = 0;
    std::map<std::string, double> sums;  // by strength as the header writes it
};

/// checks.tsv by file.
std::map<std::string, std::vector<CheckedWeight>> read_checks(const std::filesystem::path& path) {
    std::ifstream table(path);
    std::string line, word;
    std::getline(table, line);
    std::vector<std::string> columns;
    for (std::istringstream header(line); std::getline(header, word, '\t');) columns.push_back(word);
    std::map<std::string, std::vector<CheckedWeight>> checks;
    constexpr std::string_view sum = "dot_s";
    while (std::getline(table, line)) {
        std::istringstream cells(line);
        std::string file;
        CheckedWeight check;
        for (const auto& column : columns) {
            std::getline(cells, word, '\t');
            if (column == "file") file = word;
            else if (column == "weight") check.weight = word;
            else if (column == "rank") check.rank = std::stoll(word);
            else if (column == "scale") check.scale = std::stod(word);
            else if (column.starts_with(sum)) check.sums[column.substr(sum.size())] = std::stod(word);
        }
        checks[file].push_back(std::move(check));
    }
    DOCTEST_REQUIRE(!checks.empty());
    return checks;
}

double checksum(const torch::Tensor& weight) {
    const auto flat = weight.to(torch::kFloat64).reshape({-1});
    const auto wave = ((torch::arange(flat.numel(), torch::kFloat64) + 1) * ChecksumFrequency).cos();
    return (flat * wave).sum().item<double>();
}

std::string flat(std::string name) {
    std::replace(name.begin(), name.end(), '.', '_');
    return name;
}

const LoraFactor* factor_for(const LoraWeights& weights, const std::string& weight) {
    constexpr std::string_view ending = ".weight";
    const auto layer = weight.substr(weight.find('.') + 1, weight.rfind(ending) - weight.find('.') - 1);
    for (const auto& factor : weight.starts_with("unet.") ? weights.unet : weights.text)
        if (factor.layer == flat(layer)) return &factor;
    return nullptr;
}

void check_untouched(const Merged& merged, const Merged& base, const std::vector<CheckedWeight>& touched) {
    std::set<std::string> names;
    for (const auto& check : touched) names.insert(check.weight);
    const auto compare = [&](const torch::nn::Module& now, const torch::nn::Module& before,
                             const std::string& prefix) {
        const auto old = before.named_parameters();
        for (const auto& item : now.named_parameters())
            if (!names.contains(prefix + item.key()))
                DOCTEST_CHECK_MESSAGE(torch::equal(item.value(), old[item.key()]), item.key());
    };
    compare(*merged.unet, *base.unet, "unet.");
    compare(*merged.text, *base.text, "text_encoder.");
}

/// Checks one merge against io.safetensors: outputs, and some weights.
void check_outputs(Margins& margins, const LoraCase& lora, const Merged& merged, const SafetensorsFile& io,
                   const std::string& stem) {
    const torch::NoGradGuard no_grad;
    DOCTEST_REQUIRE(io.contains(stem + ".unet"));
    margins.near(stem + ".unet", lora.run(merged.unet), io.tensor(stem + ".unet"), MergedOutputTolerance);
    if (io.contains(stem + ".te"))
        margins.near(stem + ".te", lora.run(merged.text), io.tensor(stem + ".te"), MergedOutputTolerance);
    for (const auto& [name, entry] : io.entries())
        if (name.starts_with(stem + ".W."))
            margins.near(name, merged.weight(name.substr(stem.size() + 3) + ".weight"), io.tensor(name),
                         MergedTolerance);
}

void check_file(Margins& margins, const LoraCase& lora, const std::string& file,
                const std::vector<CheckedWeight>& checks) {
    const auto weights = lora.read(file);
    DOCTEST_CHECK(weights.unet.size() + weights.text.size() == checks.size());
    const auto io = lora.golden.tensors();
    const Merged base(lora);
    for (const auto& [strength, unused] : checks.front().sums) {
        Merged merged(lora);
        merged.merge(weights, std::stod(strength));
        for (const auto& check : checks) {
            const auto* factor = factor_for(weights, check.weight);
            DOCTEST_REQUIRE_MESSAGE(factor != nullptr, check.weight);
            DOCTEST_CHECK(factor->rank() == check.rank);
            DOCTEST_CHECK(std::abs(factor->scale() - check.scale) <= 1e-6 * std::abs(check.scale));
            const double error = std::abs(checksum(merged.weight(check.weight)) - check.sums.at(strength));
            DOCTEST_CHECK_MESSAGE(error <= ChecksumTolerance, file, " ", strength, " ", check.weight, ": ",
                                  error);
        }
        check_untouched(merged, base, checks);
        check_outputs(margins, lora, merged, io, file + ".s" + strength);
    }
}

/// The sentence of the refusal, or about what is left out; empty when the whole file is used.
std::string refusal(const LoraCase& lora, const Merged& base, const std::string& file) {
    try {
        auto weights = read_lora(lora.golden.folder / file);
        fit_lora(weights, *base.unet, *base.text);
        if (!weights.notes().empty()) return weights.notes().front();
    } catch (const Error& error) {
        DOCTEST_CHECK_MESSAGE(!error.hint().empty(), file);
        DOCTEST_CHECK_MESSAGE(error.path().filename() == file, file);
        return error.message();
    }
    return {};
}

bool names_one_of(std::string message, const Json& words) {
    const auto lower = [](std::string text) {
        std::transform(text.begin(), text.end(), text.begin(),
                       [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
        return text;
    };
    message = lower(std::move(message));
    return words.empty() || std::any_of(words.begin(), words.end(), [&](const Json& word) {
               return message.find(lower(word.get<std::string>())) != std::string::npos;
           });
}

}  // namespace

DOCTEST_TEST_CASE("lora: merged weights and outputs of every kind of file, at every strength") {
    const LoraCase lora;
    if (!lora.present()) return;
    Margins margins("lora");
    const auto io = lora.golden.tensors();
    const Merged base(lora);
    {
        const torch::NoGradGuard no_grad;
        margins.near("base.unet", lora.run(base.unet), io.tensor("base.unet"), MergedOutputTolerance);
        margins.near("base.te", lora.run(base.text), io.tensor("base.te"), MergedOutputTolerance);
    }
    for (const auto& [file, checks] : read_checks(lora.golden.folder / "checks.tsv"))
        check_file(margins, lora, file, checks);
}

DOCTEST_TEST_CASE("lora: two files at once, in any order") {
    const LoraCase lora;
    if (!lora.present()) return;
    Margins margins("lora stack");
    const auto io = lora.golden.tensors();
    static const std::regex pattern(R"((stack\.(\w+)_([0-9.]+)\+(\w+)_([0-9.]+))\.unet)");
    std::smatch found;
    std::size_t compared = 0;
    for (const auto& [name, entry] : io.entries()) {
        if (!std::regex_match(name, found, pattern)) continue;
        const auto first = lora.read(found[2]), second = lora.read(found[4]);
        Merged forward(lora), backward(lora);
        forward.merge(first, std::stod(found[3]));
        forward.merge(second, std::stod(found[5]));
        backward.merge(second, std::stod(found[5]));
        backward.merge(first, std::stod(found[3]));
        check_outputs(margins, lora, forward, io, found[1]);
        check_outputs(margins, lora, backward, io, found[1]);
        ++compared;
    }
    DOCTEST_CHECK(compared > 0);
}

DOCTEST_TEST_CASE("lora: gradients of the factors") {
    const LoraCase lora;
    if (!lora.present()) return;
    Margins margins("lora gradients");
    const auto io = lora.golden.tensors();
    auto weights = lora.read("diffusers_peft");  // the file the case says
    UNet unet = lora.unet();
    unet->eval();
    for (auto& parameter : unet->parameters()) parameter.set_requires_grad(false);
    std::map<std::string, LoraFactor*> factors;
    for (auto& factor : weights.unet) {
        factor.down.set_requires_grad(true);
        factor.up.set_requires_grad(true);
        factors[factor.layer] = &factor;
    }
    for (auto& target : lora_targets(*unet))
        if (const auto found = factors.find(target.layer); found != factors.end())
            target.linear->weight = target.linear->weight + found->second->change_of(target.linear->weight);
    const auto loss = (lora.run(unet) * lora.unet_case.tensors().tensor("G")).sum();
    loss.backward();
    margins.near_relative("loss", loss, io.tensor("grad.loss"), GradientTolerance);
    static const std::regex pattern(R"(grad\.(.+)\.lora_(A|B)\.weight)");
    std::smatch found;
    std::size_t compared = 0;
    for (const auto& [name, entry] : io.entries()) {
        if (!std::regex_match(name, found, pattern)) continue;
        const auto factor = factors.find(flat(found[1]));
        DOCTEST_REQUIRE_MESSAGE(factor != factors.end(), name);
        margins.near_relative(name, (found[2] == "A" ? factor->second->down : factor->second->up).grad(),
                              io.tensor(name), GradientTolerance);
        ++compared;
    }
    DOCTEST_CHECK(compared > 0);
}

DOCTEST_TEST_CASE("lora: malformed files are refused by name, odd ones read") {
    const LoraCase lora;
    if (!lora.present()) return;
    Margins margins("lora odd files");
    const auto io = lora.golden.tensors();
    const Merged base(lora);
    for (const auto& stated : lora.golden.json("malformed.json")) {
        const auto file = stated.at("file").get<std::string>(),
                   expected = stated.at("expect").get<std::string>();
        const auto message = refusal(lora, base, file);
        DOCTEST_CAPTURE(file);
        DOCTEST_CAPTURE(message);
        if (expected == "ok") DOCTEST_CHECK(message.empty());
        if (expected == "error" || expected == "error_or_warning") DOCTEST_CHECK(!message.empty());
        if (!message.empty()) DOCTEST_CHECK(names_one_of(message, stated.at("message_must_name_one_of")));
        if (!message.empty()) continue;
        Merged merged(lora);
        const auto weights = read_lora(lora.golden.folder / file);
        merged.merge(weights, 1);
        const auto stem = file.substr(0, file.rfind('.')) + ".s1.0.W.";
        for (const auto& [name, entry] : io.entries())
            if (name.starts_with(stem))
                margins.near(name, merged.weight(name.substr(stem.size()) + ".weight"), io.tensor(name),
                             MergedTolerance);
        for (const auto& factor :
             weights.unet) {  // all of it or nothing: also where two ways of naming are mixed
            const bool nothing = factor.alpha == 0;
            bool same = true;
            for (const auto& item : merged.unet->named_parameters())
                if (flat(item.key()) == factor.layer + "_weight")
                    same = torch::equal(item.value(), base.unet->named_parameters()[item.key()]);
            DOCTEST_CHECK_MESSAGE(same == nothing, factor.layer);
        }
    }
}
