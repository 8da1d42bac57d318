// Words of captions to token ids.
#include "engine/neural/api/starter_words.h"

#include <nlohmann/json.hpp>
#include <string_view>

#include "engine/base/error.h"
#include "engine/base/json.h"

namespace gse::neural {

std::vector<std::string> split_caption(const std::string& text) {
    std::vector<std::string> words;
    std::string word;
    for (const char letter : text + " ") {
        if (letter != ' ' && letter != ',') {
            word += letter;
            continue;
        }
        if (!word.empty()) words.push_back(std::move(word));
        word.clear();
        if (letter == ',') words.emplace_back(",");
    }
    return words;
}

WordTable::WordTable(const StarterVocabulary& vocabulary) : bos_(vocabulary.bos), eos_(vocabulary.eos) {
    const auto json = parse_json(vocabulary.vocab_json, "the vocabulary");
    for (const auto& [token, id] : json.items()) {
        constexpr std::string_view end = "</w>";
        if (token.size() > end.size() && token.ends_with(end))
            ids_[token.substr(0, token.size() - end.size())] = id.get<int>();
    }
}

int WordTable::id(const std::string& word) const {
    const auto found = ids_.find(word);
    if (found == ids_.end())
        throw Error(ErrorCode::InvalidArgument, "the caption word \"" + word + "\" is not in the vocabulary");
    return found->second;
}

}  // namespace gse::neural
