// A tokenizer in one file says what the same tokenizer in two files says.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/neural/api/prompt_reader.h"
#include "engine/neural/api/tokenizer.h"
#include "tests/test_paths.h"

namespace tokenizer_json_test {
namespace {

using namespace gse;
using namespace gse::neural;
namespace fs = std::filesystem;
using TokenizerJson = nlohmann::ordered_json;

/// tokenizer.json as transformers' CLIPTokenizerFast writes it, from vocab.json and merges.txt.
TokenizerJson single_file(const fs::path& folder, bool pairs) {
    TokenizerJson merges = TokenizerJson::array();
    std::istringstream lines(read_file(folder / "merges.txt"));
    for (std::string line; std::getline(lines, line);) {
        if (line.empty() || line.starts_with("#version")) continue;
        const auto blank = line.find(' ');
        if (pairs) merges.push_back({line.substr(0, blank), line.substr(blank + 1)});
        else merges.push_back(line);
    }
    const auto vocabulary = nlohmann::json::parse(read_file(folder / "vocab.json"));
    TokenizerJson added = TokenizerJson::array();
    for (const char* token : {"<|startoftext|>", "<|endoftext|>"})
        added.push_back({{"id", vocabulary.at(token)}, {"content", token}, {"special", true}});
    TokenizerJson json{{"version", "1.0"}, {"truncation", nullptr}, {"padding", nullptr}};
    json["added_tokens"] = std::move(added);
    json["model"] = {{"type", "BPE"},
                     {"unk_token", "<|endoftext|>"},
                     {"continuing_subword_prefix", ""},
                     {"end_of_word_suffix", "</w>"}};
    json["model"]["vocab"] = vocabulary;
    json["model"]["merges"] = std::move(merges);
    return json;
}

const std::vector<std::string>& prompts() {
    static const std::vector<std::string> prompts{"a photo of a bear",
                                                  "A Golden BEAR, wearing a blue hat!",
                                                  "naïve café 2024",
                                                  "don't o'clock",
                                                  "<|startoftext|> inside <|endoftext|>",
                                                  "日本語 mixed",
                                                  "",
                                                  "supercalifragilistic !!! 😀"};
    return prompts;
}

void check_alike(const fs::path& two_files, bool pairs) {
    const test::ScratchFolder scratch;
    write_file(scratch.path() / "tokenizer.json", single_file(two_files, pairs).dump());
    const Tokenizer expected(two_files), found(scratch.path());
    DOCTEST_CHECK(found.vocabulary_size() == expected.vocabulary_size());
    DOCTEST_CHECK(found.bos() == expected.bos());
    DOCTEST_CHECK(found.eos() == expected.eos());
    for (const auto& prompt : prompts())
        DOCTEST_CHECK_MESSAGE(found.encode(prompt, 77).ids == expected.encode(prompt, 77).ids, prompt);
}

void refused(const TokenizerJson& json, ErrorCode code) {
    const test::ScratchFolder scratch;
    write_file(scratch.path() / "tokenizer.json", json.dump());
    try {
        const Tokenizer tokenizer(scratch.path());
        DOCTEST_FAIL_CHECK("it was read");
    } catch (const Error& error) {
        DOCTEST_CHECK((error.code() == code));
        DOCTEST_CHECK(error.path().filename() == "tokenizer.json");
    }
}

}  // namespace

DOCTEST_TEST_CASE("tokenizer.json: the bundled vocabulary in one file, merges as texts and as pairs") {
    for (const bool pairs : {false, true})
        check_alike(test::source_folder() / "assets/models/starter/tokenizer", pairs);
}

DOCTEST_TEST_CASE("tokenizer.json: CLIP's vocabulary in one file") {
    const auto folder = test::goldens_folder() / "tokenizer";
    if (!test::available(folder / "vocab.json")) return;
    for (const bool pairs : {false, true}) check_alike(folder, pairs);
}

DOCTEST_TEST_CASE("tokenizer.json: padding, length and added tokens") {
    const test::ScratchFolder scratch;
    auto json = single_file(test::source_folder() / "assets/models/starter/tokenizer", false);
    const auto next = json["model"]["vocab"].size();
    json["padding"] = {{"pad_token", "!"}};
    json["truncation"] = {{"max_length", 20}};
    json["added_tokens"].push_back({{"id", next}, {"content", "<thing>"}});
    write_file(scratch.path() / "tokenizer.json", json.dump());
    const Tokenizer tokenizer(scratch.path());
    DOCTEST_CHECK(tokenizer.max_length() == 20);
    DOCTEST_CHECK(tokenizer.pad() == json["model"]["vocab"]["!"].get<std::int64_t>());
    DOCTEST_CHECK(tokenizer.encode("a<thing>").ids[2] == static_cast<std::int64_t>(next));
    DOCTEST_CHECK(tokenizer.vocabulary_size() == static_cast<std::int64_t>(next) + 1);
    // Files that state more come after it.
    write_file(scratch.path() / "tokenizer_config.json",
               R"({"pad_token": "<|endoftext|>", "model_max_length": 30})");
    const Tokenizer stated(scratch.path());
    DOCTEST_CHECK(stated.pad() == stated.eos());
    DOCTEST_CHECK(stated.max_length() == 30);
}

DOCTEST_TEST_CASE("tokenizer.json: what is broken, or not CLIP's, is refused") {
    const auto json = single_file(test::source_folder() / "assets/models/starter/tokenizer", false);
    const auto changed = [&](auto change) {
        auto other = json;
        change(other);
        return other;
    };
    refused(TokenizerJson::array(), ErrorCode::Malformed);
    refused(changed([](auto& j) { j["model"].erase("vocab"); }), ErrorCode::Malformed);
    refused(changed([](auto& j) { j["model"]["merges"] = 3; }), ErrorCode::Malformed);
    refused(changed([](auto& j) { j["model"]["merges"][0] = {"a", "b", "c"}; }), ErrorCode::Malformed);
    refused(changed([](auto& j) { j["model"]["merges"][0] = "one"; }), ErrorCode::Malformed);
    refused(changed([](auto& j) { j["model"]["vocab"]["a"] = -1; }), ErrorCode::Malformed);
    refused(changed([](auto& j) {
                j["model"]["vocab"].erase("<|endoftext|>");
                j["added_tokens"].clear();
            }),
            ErrorCode::Malformed);
    refused(changed([](auto& j) { j["model"]["type"] = "WordPiece"; }), ErrorCode::Unsupported);
    refused(changed([](auto& j) { j["model"]["end_of_word_suffix"] = nullptr; }), ErrorCode::Unsupported);
}

DOCTEST_TEST_CASE("tokenizer.json: sentences are measured for a checkpoint with one beside it") {
    const test::ScratchFolder scratch;
    write_file(scratch.path() / "tokenizer/tokenizer.json",
               single_file(test::source_folder() / "assets/models/starter/tokenizer", true).dump());
    const PromptReader reader(scratch.path() / "model.safetensors");
    DOCTEST_CHECK(reader.words_read({"a", "red", "bear"}) == 3);
}

}  // namespace tokenizer_json_test
