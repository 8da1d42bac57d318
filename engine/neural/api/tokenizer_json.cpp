// Vocabulary, merges and added tokens out of one JSON file.
#include "engine/neural/api/tokenizer_json.h"

#include <fmt/format.h>

#include <limits>
#include <optional>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/json.h"

namespace gse::neural {
namespace {

namespace fs = std::filesystem;
using PlainJson = nlohmann::json;  // an ordered object looks each of 49408 names up one by one

class TablesReader {
public:
    explicit TablesReader(const fs::path& path) : path_(path), json_(try_parse_json(read_file(path))) {
        if (!json_.is_object()) malformed("the tokenizer is not a JSON object");
    }

    TokenizerTables read() const {
        TokenizerTables tables;
        const auto& model = object("model");
        check_kind(model);
        if (!model.contains("vocab") || !model["vocab"].is_object())
            malformed("the tokenizer has no vocabulary");
        for (const auto& [token, id] : model["vocab"].items())
            tables.vocabulary.emplace(token, id_in(token, id));
        read_merges(model, tables.merges);
        tables.unknown = text(model, "unk_token");
        read_added(tables.added);
        tables.padding = text(object("padding"), "pad_token");
        if (const auto& truncation = object("truncation");
            truncation.contains("max_length") && truncation["max_length"].is_number_unsigned())
            tables.max_length = number(truncation["max_length"]).value_or(0);
        return tables;
    }

private:
    [[noreturn]] void malformed(const std::string& what) const {
        throw Error(ErrorCode::Malformed, what, "download tokenizer.json again", path_);
    }
    /// The object under the key; an empty one where it is absent or null.
    const PlainJson& object(const char* key) const {
        static const PlainJson none = PlainJson::object();
        const auto found = json_.find(key);
        return found != json_.end() && found->is_object() ? *found : none;
    }
    static std::string text(const PlainJson& json, const char* key) {
        const auto found = json.find(key);
        return found != json.end() && found->is_string() ? found->get<std::string>() : std::string();
    }
    static std::optional<std::int64_t> number(const PlainJson& json) {
        if (!json.is_number_unsigned() ||
            json.get<std::uint64_t>() > std::uint64_t{std::numeric_limits<std::int32_t>::max()})
            return std::nullopt;
        return json.get<std::int64_t>();
    }
    std::int64_t id_in(const std::string& token, const PlainJson& json) const {
        const auto id = number(json);
        if (!id) malformed(fmt::format("the vocabulary's token \"{}\" has no valid number", token));
        return *id;
    }

    /// CLIP's words end in "</w>"; other byte-pair tokenizers begin theirs with a mark.
    void check_kind(const PlainJson& model) const {
        const auto type = text(model, "type");
        if ((type.empty() || type == "BPE") && text(model, "end_of_word_suffix") == "</w>") return;
        throw Error(ErrorCode::Unsupported, "this tokenizer is not of CLIP's kind",
                    "use the tokenizer that came with the Stable Diffusion model", path_);
    }

    void read_merges(const PlainJson& model, std::vector<std::string>& merges) const {
        const auto found = model.find("merges");
        if (found == model.end() || !found->is_array()) malformed("the tokenizer has no merges");
        for (const auto& merge : *found) {
            const bool pair =
                merge.is_array() && merge.size() == 2 && merge[0].is_string() && merge[1].is_string();
            if (!pair && !merge.is_string())
                malformed(fmt::format("merge {} of the tokenizer is not two symbols", merges.size() + 1));
            merges.push_back(pair ? merge[0].get<std::string>() + " " + merge[1].get<std::string>()
                                  : merge.get<std::string>());
        }
    }

    void read_added(std::map<std::string, std::int64_t>& added) const {
        const auto found = json_.find("added_tokens");
        if (found == json_.end() || !found->is_array()) return;
        for (const auto& token : *found)
            if (token.is_object() && token.contains("id"))
                if (const auto content = text(token, "content"); !content.empty())
                    added[content] = id_in(content, token["id"]);
    }

    const fs::path& path_;
    const PlainJson json_;
};

}  // namespace

TokenizerTables read_tokenizer_json(const fs::path& path) { return TablesReader(path).read(); }

bool has_tokenizer(const fs::path& folder) {
    std::error_code ignored;
    return fs::exists(folder / "merges.txt", ignored) || fs::exists(folder / "tokenizer.json", ignored);
}

}  // namespace gse::neural
