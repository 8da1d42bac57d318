// Noun phrases of a sentence, put into orders.
#include "engine/pipeline/models/server_instruction.h"

#include <fmt/format.h>

#include "engine/language/lexicon.h"
#include "engine/language/words.h"

namespace gse::pipeline {
namespace {

/// The noun phrase of a thing with its article, as the sentence has it ("a golden hat"); empty where it names
/// no such thing.
std::string phrase_of(const language::Sentence& sentence, const std::string& thing) {
    for (const auto& phrase : sentence.noun_phrases({thing})) {
        if (phrase.head != thing) continue;
        auto words = phrase.attributes;
        words.push_back(thing);
        const auto text = language::joined(words);
        const auto at = sentence.position_of(text);
        const bool article = at > 0 && at < sentence.words().size() &&
                             language::is_a(sentence.words()[at - 1], language::Article);
        return article ? sentence.words()[at - 1] + " " + text : text;
    }
    return {};
}

bool holds_words(const std::string& phrase, const std::string& words) {
    return (" " + phrase + " ").find(" " + words + " ") != std::string::npos;
}

/// New state of the source in words: its own noun phrase where that brings the news, the whole sentence where
/// that begins with it, else the news alone.
std::string changed(const language::EditSentence& sentence) {
    const auto own = phrase_of(sentence.sentence(), sentence.source());
    if (holds_words(own, sentence.target())) return own;
    const auto phrases = sentence.sentence().noun_phrases({sentence.source()});
    const bool leads = !phrases.empty() && phrases.front().head == sentence.source();
    return leads || sentence.target().empty() ? sentence.prompt() : sentence.target();
}

}  // namespace

std::string server_instruction(const edit::CheckedRequest& request, edit::EditMode mode) {
    if (!request.instruction.empty()) return request.instruction;
    const auto& sentence = request.sentence();
    const auto& source = sentence.source();
    if (request.whole_scene() || source.empty())
        return fmt::format("make the picture show {}", sentence.prompt());
    const auto& news = language::new_thing(sentence, mode);
    const auto phrase = phrase_of(sentence.sentence(), news);
    const auto& named = phrase.empty() ? news : phrase;
    if (mode == edit::EditMode::Add)
        return source == sentence.target() ? "add " + named : fmt::format("add {} to the {}", named, source);
    if (mode == edit::EditMode::Replace && !named.empty())
        return fmt::format("replace the {} with {}", source, named);
    return fmt::format("turn the {} into {}", source, changed(sentence));
}

}  // namespace gse::pipeline
