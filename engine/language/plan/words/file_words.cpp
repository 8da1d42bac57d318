// Letters of a name in runs; the lexicon says which of them name things.
#include "engine/language/plan/words/file_words.h"

#include <algorithm>
#include <cctype>
#include <iterator>

#include "engine/language/plan/words/lexicon.h"

namespace gse::language::plan {
namespace {

/// Words that say how a file was made, not what it shows.
constexpr std::string_view FileWords[] = {
    "a",      "clean",    "cleaned", "cloud",  "compressed", "copy",      "draft",  "edited",
    "export", "exported", "file",    "final",  "gaussian",   "gaussians", "gs",     "gsplat",
    "lod",    "merged",   "mesh",    "model",  "my",         "new",       "object", "old",
    "our",    "output",   "point",   "points", "raw",        "scan",      "scene",  "sh",
    "splat",  "splats",   "test",    "the",    "thing",      "v",         "ver",    "version"};

bool in_file_word(char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte >= 0x80 || std::isalpha(byte) != 0 || c == '\'';
}

bool is_capital_letter(char c) { return std::isupper(static_cast<unsigned char>(c)) != 0; }

/// True where a capital begins a word: behind a small letter, and before one behind other capitals.
bool begins_word(std::string_view name, std::size_t at) {
    if (at == 0 || !is_capital_letter(name[at])) return false;
    const bool last_capital =
        at + 1 < name.size() && in_file_word(name[at + 1]) && !is_capital_letter(name[at + 1]);
    return !is_capital_letter(name[at - 1]) || last_capital;
}

bool is_plain_name(std::string_view name) {
    return std::all_of(name.begin(), name.end(),
                       [](char c) { return c == ' ' || (in_file_word(c) && !is_capital_letter(c)); });
}

}  // namespace

std::vector<std::string> words_of_file_name(std::string_view name) {
    std::vector<std::string> words;
    bool goes_on = false;
    for (std::size_t at = 0; at < name.size(); ++at) {
        if (!in_file_word(name[at])) {
            goes_on = false;
            continue;
        }
        if (!goes_on || begins_word(name, at)) words.emplace_back();
        words.back() += static_cast<char>(std::tolower(static_cast<unsigned char>(name[at])));
        goes_on = true;
    }
    return words;
}

std::string thing_of_file_name(std::string_view name) {
    if (is_plain_name(name)) return {};
    auto words = words_of_file_name(name);
    if (words.empty()) return {};
    const std::string last = words.back();
    std::erase_if(words, [](const std::string& word) {
        return std::find(std::begin(FileWords), std::end(FileWords), word) != std::end(FileWords);
    });
    const auto thing = std::find_if(words.rbegin(), words.rend(), [](const std::string& word) {
        return (kinds_of(word_of(word).singular) & Concrete) != 0;
    });
    if (thing != words.rend()) return *thing;
    return words.empty() ? last : words.back();
}

}  // namespace gse::language::plan
