// The words of a caption.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace gse::training {

/// Words and commas, in order, as the tokenizer splits a caption.
inline std::vector<std::string> split_caption(const std::string& text) {
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

}  // namespace gse::training
