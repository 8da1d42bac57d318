// Words of captions to token ids.
#include "engine/laboratory/starter/starter_words.h"

#include <nlohmann/json.hpp>
#include <string_view>

#include "engine/base/error.h"
#include "engine/base/json.h"

namespace gse::training {

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

}  // namespace gse::training
