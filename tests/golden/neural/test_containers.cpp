// Safetensors files, tokenizer and the key names of the real-size models.
#include <fstream>
#include <functional>
#include <numeric>

#include "engine/base/error.h"
#include "engine/neural/api/tokenizer.h"
#include "engine/neural/diffusion/text_encoder.h"
#include "engine/neural/diffusion/unet.h"
#include "engine/neural/diffusion/vae.h"
#include "engine/neural/weights/key_map.h"
#include "tests/golden/neural/golden_case.h"

namespace {

using namespace gse;
using namespace gse::neural;
using namespace gse::test;

std::vector<double> values_of(const torch::Tensor& tensor) {
    const auto flat = tensor.to(torch::kFloat64).reshape(-1).contiguous();
    return {flat.data_ptr<double>(), flat.data_ptr<double>() + flat.numel()};
}

void check_expected(const SafetensorsFile& file, const Json& expected) {
    DOCTEST_CHECK(file.entries().size() == expected.size());
    for (const auto& [name, what] : expected.items()) {
        DOCTEST_REQUIRE_MESSAGE(file.contains(name), name);
        const auto tensor = file.tensor(name);
        const auto shape = what["shape"].get<std::vector<std::int64_t>>();
        DOCTEST_CHECK(std::vector<std::int64_t>(tensor.sizes().begin(), tensor.sizes().end()) == shape);
        if (tensor.scalar_type() == torch::kInt64)
            DOCTEST_CHECK(std::vector<std::int64_t>(tensor.data_ptr<std::int64_t>(),
                                                    tensor.data_ptr<std::int64_t>() + tensor.numel()) ==
                          what["values"].get<std::vector<std::int64_t>>());
        else DOCTEST_CHECK(values_of(tensor) == what["values"].get<std::vector<double>>());
    }
}

std::vector<std::int64_t> ids_of(const std::vector<Token>& tokens, const Tokenizer& tokenizer) {
    std::vector<std::int64_t> ids = {tokenizer.bos()};
    for (const auto& token : tokens) ids.push_back(token.id);
    ids.push_back(tokenizer.eos());
    return ids;
}

void check_tokenizer_case(const Tokenizer& tokenizer, const Json& item, std::int64_t max_length) {
    const auto text = item["text"].get<std::string>();
    const auto full = ids_of(tokenizer.tokenize(text), tokenizer);
    const auto primary = item["full_ids"].get<std::vector<std::int64_t>>();
    bool known = full == primary;
    if (!item["all_references_agree"].get<bool>())
        for (const auto& [key, ids] : item.items())
            known = known || (key.starts_with("full_ids") && ids.get<std::vector<std::int64_t>>() == full);
    DOCTEST_CHECK_MESSAGE(known, text);
    if (full != primary) return;
    DOCTEST_CHECK_MESSAGE(
        tokenizer.encode(text, max_length).ids == item["ids"].get<std::vector<std::int64_t>>(), text);
}

/// "key<TAB>AxBxC" per line.
KeyShapes read_manifest(const std::filesystem::path& path) {
    KeyShapes shapes;
    std::ifstream stream(path);
    for (std::string line; std::getline(stream, line);) {
        const auto tab = line.find('\t');
        if (tab == std::string::npos) continue;
        std::vector<std::int64_t> shape;
        std::size_t at = tab + 1;
        while (at < line.size() && std::isdigit(static_cast<unsigned char>(line[at]))) {
            std::size_t used = 0;
            shape.push_back(std::stoll(line.substr(at), &used));
            at += used + 1;
        }
        shapes.emplace(line.substr(0, tab), shape);
    }
    return shapes;
}

std::int64_t parameter_count(const torch::nn::Module& module) {
    std::int64_t count = 0;
    for (const auto& parameter : module.parameters()) count += parameter.numel();
    return count;
}

const WeightOptions Described{torch::kMeta, torch::kFloat32, false};  // names and shapes only

struct RealModels {
    UNet unet;
    AutoencoderKl vae;
    ClipTextEncoder text;
};

RealModels describe(const GoldenCase& golden, const std::string& name) {
    const auto config = [&](const char* part) { return golden.folder / (name + part); };
    return {
        UNet(UNetConfig::from_json(read_json_file(config("_unet_config.json")), golden.folder), Described),
        AutoencoderKl(VaeConfig::from_json(golden.json("vae_config.json"), golden.folder), Described),
        ClipTextEncoder(
            TextEncoderConfig::from_json(read_json_file(config("_text_encoder_config.json")), golden.folder),
            Described)};
}

std::int64_t parameter_count(const KeyShapes& shapes) {
    std::int64_t count = 0;
    for (const auto& [key, shape] : shapes)
        count += std::accumulate(shape.begin(), shape.end(), std::int64_t{1}, std::multiplies<>());
    return count;
}

void check_manifests(const std::string& name, SingleFileText layout) {
    const GoldenCase golden("manifests");
    if (!golden.present) return;
    const auto models = describe(golden, name);
    const auto check = [&](const torch::nn::Module& module, const std::string& file, const LoadPlan& plan) {
        const auto shapes = read_manifest(golden.folder / file);
        DOCTEST_REQUIRE(!shapes.empty());
        DOCTEST_CHECK_NOTHROW(check_weights(module, shapes, plan, file));
        return shapes;
    };
    const auto unet = check(*models.unet, name + "_unet_diffusers.tsv", unet_plan());
    DOCTEST_CHECK(parameter_count(*models.unet) == parameter_count(unet));
    check(*models.text, name + "_text_encoder_transformers.tsv", text_encoder_plan());
    check(*models.vae, "vae_diffusers_new_names.tsv", vae_plan(false));
    check(*models.vae, "vae_diffusers_legacy_names.tsv", vae_plan(true));
    const std::string single = name + "_single_file.tsv";
    const std::array plans{single_file_unet_plan(models.unet->config()),
                           single_file_vae_plan(models.vae->config()),
                           single_file_text_plan(models.text->config(), layout)};
    std::set<std::string> used;
    for (const auto& part :
         {check_weights(*models.unet, read_manifest(golden.folder / single), plans[0], single),
          check_weights(*models.vae, read_manifest(golden.folder / single), plans[1], single),
          check_weights(*models.text, read_manifest(golden.folder / single), plans[2], single)})
        used.insert(part.begin(), part.end());
    for (const auto& [key, shape] : read_manifest(golden.folder / single)) {
        const bool ignored =
            std::all_of(plans.begin(), plans.end(), [&](const LoadPlan& plan) { return plan.ignore(key); });
        DOCTEST_CHECK_MESSAGE(used.contains(key) != ignored, key);
    }
}

}  // namespace

DOCTEST_TEST_CASE("safetensors_container: valid files read exactly") {
    const GoldenCase golden("safetensors_container");
    if (!golden.present) return;
    const auto expected = golden.json("expected.json");
    check_expected(golden.tensors("mixed_unaligned.safetensors"), expected);
    DOCTEST_CHECK(golden.tensors("no_tensors.safetensors").entries().empty());
    for (const char* name : {"header_not_padded.safetensors", "pretty_header.safetensors"}) {
        const auto file = golden.tensors(name);
        DOCTEST_CHECK(!file.entries().empty());
        Json part = Json::object();
        for (const auto& [key, entry] : file.entries()) {
            DOCTEST_REQUIRE_MESSAGE(expected.contains(key), key);
            part[key] = expected[key];
        }
        check_expected(file, part);
    }
}

DOCTEST_TEST_CASE("safetensors_container: malformed files are refused with one sentence") {
    const GoldenCase golden("safetensors_container");
    if (!golden.present) return;
    for (const auto& item : golden.json("malformed.json")) {
        const auto name = item["file"].get<std::string>();
        try {
            golden.tensors(name);
            DOCTEST_FAIL_CHECK("accepted: ", name);
        } catch (const Error& error) {
            DOCTEST_CHECK(error.message().find('\n') == std::string::npos);
            DOCTEST_CHECK(error.path() == golden.folder / name);
        }
    }
}

DOCTEST_TEST_CASE("tokenizer: the primary reference, all prompts") {
    const GoldenCase golden("tokenizer");
    if (!golden.present) return;
    const auto cases = golden.json("cases.json");
    const Tokenizer tokenizer(golden.folder);
    DOCTEST_CHECK(tokenizer.bos() == cases["bos"].get<std::int64_t>());
    DOCTEST_CHECK(tokenizer.eos() == cases["eos"].get<std::int64_t>());
    DOCTEST_CHECK(tokenizer.pad() == cases["pad_sd1"].get<std::int64_t>());
    const auto max_length = cases["max_length"].get<std::int64_t>();
    for (const auto& item : cases["cases"]) check_tokenizer_case(tokenizer, item, max_length);
    const auto io = golden.tensors();
    const auto vocabulary = nlohmann::json::parse(read_file(golden.folder / "vocab.json"));
    for (const auto& [name, pad] : {std::pair("ids_sd1", "pad_sd1"), std::pair("ids_sd2", "pad_sd2")}) {
        std::string pad_token;
        for (const auto& [token, id] : vocabulary.items())
            if (id.get<std::int64_t>() == cases[pad].get<std::int64_t>()) pad_token = token;
        const Tokenizer padded(golden.folder, pad_token);
        const auto expected = io.tensor(name);
        for (std::int64_t row = 0; row < expected.size(0); ++row) {
            const auto text = cases["cases"][static_cast<std::size_t>(row)]["text"].get<std::string>();
            const auto ids = padded.encode(text, max_length).ids;
            DOCTEST_CHECK_MESSAGE(torch::equal(torch::tensor(ids, torch::kInt64), expected[row]), text);
        }
    }
}

DOCTEST_TEST_CASE("tokenizer: vocabulary from the merges alone, added tokens") {
    const GoldenCase golden("tokenizer");
    if (!golden.present) return;
    const ScratchFolder scratch;
    std::filesystem::copy_file(golden.folder / "merges.txt", scratch.path() / "merges.txt");
    const Tokenizer derived(scratch.path());
    const Tokenizer full(golden.folder);
    DOCTEST_CHECK(derived.vocabulary_size() == full.vocabulary_size());
    const auto cases = golden.json("cases.json");
    const auto max_length = cases["max_length"].get<std::int64_t>();
    for (const auto& item : cases["cases"]) {
        const auto text = item["text"].get<std::string>();
        DOCTEST_CHECK(derived.encode(text, max_length).ids == full.encode(text, max_length).ids);
    }
    for (const char* name : {"vocab.json", "tokenizer_config.json", "special_tokens_map.json"})
        std::filesystem::copy_file(golden.folder / name, scratch.path() / name);
    const auto added = golden.json("added_tokens_cases.json");
    write_file(scratch.path() / "added_tokens.json", added["added_tokens.json"].dump());
    const Tokenizer extended(scratch.path());
    for (const auto& item : added["cases"])
        DOCTEST_CHECK(extended.encode(item["text"].get<std::string>(), max_length).ids ==
                      item["ids"].get<std::vector<std::int64_t>>());
}

DOCTEST_TEST_CASE("manifests: names and shapes of Stable Diffusion 1.5 in all layouts") {
    check_manifests("sd15", SingleFileText::Transformers);
}

DOCTEST_TEST_CASE("manifests: names and shapes of Stable Diffusion 2.1 in all layouts") {
    check_manifests("sd21", SingleFileText::OpenClip);
}
