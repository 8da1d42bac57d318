// Checks of a request before anything is loaded or computed.
#include "engine/edit/request.h"

#include <algorithm>
#include <cctype>

namespace gse::edit {
namespace {

bool contains(const std::vector<std::string>& words, const std::string& word) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

/// One lower-case word; throws when there are several or none.
std::string single_word(const std::string& text, const char* what) {
    const auto words = words_of(text);
    if (words.size() != 1)
        throw Error(ErrorCode::InvalidArgument, std::string("the ") + what + " must be one word, not \"" + text + "\"",
                    "give the one word that matters");
    return words.front();
}

}  // namespace

std::vector<std::string> words_of(const std::string& sentence) {
    std::vector<std::string> words;
    std::string word;
    for (const char letter : sentence + " ") {
        const auto byte = static_cast<unsigned char>(letter);
        const bool part_of_word = std::isalnum(byte) != 0 || byte >= 0x80 || letter == '-' || letter == '\'';
        if (part_of_word) {
            word += static_cast<char>(byte < 0x80 ? std::tolower(byte) : byte);
        } else if (!word.empty()) {
            words.push_back(std::move(word));
            word.clear();
        }
    }
    return words;
}

EditRequest validated(EditRequest request) {
    const auto words = words_of(request.prompt);
    if (words.empty())
        throw Error(ErrorCode::InvalidArgument, "the edit has no prompt", "describe the scene after the edit with --prompt");
    if (request.mode != "auto" && request.mode != "modify" && request.mode != "add")
        throw Error(ErrorCode::InvalidArgument, "\"" + request.mode + "\" is not an edit mode", "use auto, modify or add");
    if (!request.source.empty()) request.source = single_word(request.source, "source");
    if (request.target.empty()) {
        if (request.source.empty())
            throw Error(ErrorCode::InvalidArgument, "neither a source nor a target word is given",
                        "name what the edit is about with --source, and what is new with --target");
        request.target = request.source;
    }
    request.target = single_word(request.target, "target");
    if (!contains(words, request.target))
        throw Error(ErrorCode::InvalidArgument,
                    "the prompt \"" + request.prompt + "\" does not contain the target word \"" + request.target + "\"",
                    "use the word in the sentence, or choose another target");
    if (request.source.empty()) request.source = request.target;
    return request;
}

EditMode chosen_mode(const EditRequest& request, bool target_exists) {
    if (request.mode == "add") return EditMode::Add;
    if (request.mode == "modify") return EditMode::Modify;
    return target_exists ? EditMode::Modify : EditMode::Add;
}

}  // namespace gse::edit
