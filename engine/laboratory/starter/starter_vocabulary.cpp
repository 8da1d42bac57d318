// Byte-pair merges that make every word of a small vocabulary one token of CLIP's tokenizer.
#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "engine/laboratory/starter/starter_data.h"

namespace gse::training {
namespace {

/// UTF-8 of a code point below 0x800.
std::string utf8(unsigned code) {
    if (code < 0x80) return std::string(1, static_cast<char>(code));
    return {static_cast<char>(0xC0 | (code >> 6)), static_cast<char>(0x80 | (code & 0x3F))};
}

/// The printable symbol of every byte, in CLIP's id order (openai/CLIP simple_tokenizer: printable bytes
/// first).
std::vector<std::string> symbols_of_bytes() {
    std::vector<std::string> symbols;
    const auto printable = [](unsigned byte) {
        return (byte >= '!' && byte <= '~') || (byte >= 0xA1 && byte <= 0xAC) ||
               (byte >= 0xAE && byte <= 0xFF);
    };
    for (unsigned byte = 0; byte < 256; ++byte)
        if (printable(byte)) symbols.push_back(utf8(byte));
    unsigned next = 256;
    for (unsigned byte = 0; byte < 256; ++byte)
        if (!printable(byte)) symbols.push_back(utf8(next++));
    return symbols;
}

using Pieces = std::vector<std::string>;

std::map<std::pair<std::string, std::string>, int> count_pairs(const std::vector<Pieces>& words) {
    std::map<std::pair<std::string, std::string>, int> counts;
    for (const auto& pieces : words)
        for (std::size_t i = 0; i + 1 < pieces.size(); ++i) ++counts[{pieces[i], pieces[i + 1]}];
    return counts;
}

void merge_pair(Pieces& pieces, const std::pair<std::string, std::string>& pair) {
    Pieces merged;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        if (i + 1 < pieces.size() && pieces[i] == pair.first && pieces[i + 1] == pair.second) {
            merged.push_back(pieces[i] + pieces[i + 1]);
            ++i;
        } else {
            merged.push_back(pieces[i]);
        }
    }
    pieces = std::move(merged);
}

}  // namespace

StarterVocabulary build_vocabulary(const std::vector<std::string>& words) {
    std::vector<std::string> tokens = symbols_of_bytes();
    for (std::size_t i = 0; i < 256; ++i) tokens.push_back(tokens[i] + "</w>");
    std::vector<Pieces> pending;
    for (const auto& word : words) {
        Pieces pieces;
        for (const char letter : word) pieces.emplace_back(1, letter);
        if (pieces.size() < 2) continue;  // a one-letter word is a token already
        pieces.back() += "</w>";
        pending.push_back(std::move(pieces));
    }
    StarterVocabulary result;
    result.merges_txt = "#version: 0.2\n";
    for (;;) {
        const auto counts = count_pairs(pending);
        if (counts.empty()) break;
        const auto best = std::max_element(counts.begin(), counts.end(),
                                           [](const auto& a, const auto& b) { return a.second < b.second; });
        result.merges_txt += best->first.first + " " + best->first.second + "\n";
        const std::string token = best->first.first + best->first.second;
        if (std::find(tokens.begin(), tokens.end(), token) == tokens.end()) tokens.push_back(token);
        for (auto& pieces : pending) merge_pair(pieces, best->first);
    }
    tokens.emplace_back("<|startoftext|>");
    tokens.emplace_back("<|endoftext|>");
    nlohmann::ordered_json json = nlohmann::ordered_json::object();
    for (std::size_t id = 0; id < tokens.size(); ++id) json[tokens[id]] = id;
    result.vocab_json = json.dump();
    result.size = static_cast<int>(tokens.size());
    result.bos = result.size - 2;
    result.eos = result.size - 1;
    return result;
}

}  // namespace gse::training
