// CLIP tokenizer: normalisation with ICU, splitting, byte-pair merging.
#include "engine/neural/api/tokenizer.h"

#include <fmt/format.h>
#include <unicode/locid.h>
#include <unicode/normalizer2.h>
#include <unicode/uchar.h>
#include <unicode/unistr.h>

#include <algorithm>
#include <array>
#include <limits>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/json.h"
#include "engine/neural/api/config.h"
#include "engine/neural/api/tokenizer_json.h"

namespace gse::neural {
namespace {

constexpr const char* StartToken = "<|startoftext|>";
constexpr const char* EndToken = "<|endoftext|>";
constexpr const char* WordEnd = "</w>";
constexpr std::size_t MaxMerges = 49152 - 256 - 2;  // CLIP's vocabulary
constexpr std::int64_t DefaultLength = 77;
constexpr std::int64_t LengthLimit = 4096;  // some configurations say 1e30 for "no limit"

std::string to_utf8(const icu::UnicodeString& text) {
    std::string result;
    text.toUTF8String(result);
    return result;
}

std::string utf8_of(UChar32 code) { return to_utf8(icu::UnicodeString(code)); }

// Printable stand-ins for the 256 bytes, as GPT-2 and CLIP have them: printable ones are themselves, others
// 256, 257...
std::array<std::string, 256> make_byte_symbols() {
    const auto printable = [](int byte) {
        return (byte >= 0x21 && byte <= 0x7e) || (byte >= 0xa1 && byte <= 0xac) ||
               (byte >= 0xae && byte <= 0xff);
    };
    std::array<std::string, 256> symbols;
    int next = 256;
    for (int byte = 0; byte < 256; ++byte)
        symbols[static_cast<std::size_t>(byte)] = utf8_of(printable(byte) ? byte : next++);
    return symbols;
}

const std::array<std::string, 256>& byte_symbols() {
    static const auto symbols = make_byte_symbols();
    return symbols;
}

bool is_letter(UChar32 c) { return (U_GET_GC_MASK(c) & U_GC_L_MASK) != 0; }
bool is_number(UChar32 c) { return (U_GET_GC_MASK(c) & U_GC_N_MASK) != 0; }
bool is_control(UChar32 c) {
    return c != '\t' && c != '\n' && c != '\r' && (U_GET_GC_MASK(c) & U_GC_C_MASK) != 0;
}
bool is_space(UChar32 c) { return u_isUWhiteSpace(c) || (U_GET_GC_MASK(c) & U_GC_Z_MASK) != 0; }

bool is_ideograph(UChar32 c) {
    constexpr std::array<std::pair<UChar32, UChar32>, 8> blocks{{{0x4e00, 0x9fff},
                                                                 {0x3400, 0x4dbf},
                                                                 {0x20000, 0x2a6df},
                                                                 {0x2a700, 0x2b73f},
                                                                 {0x2b740, 0x2b81f},
                                                                 {0x2b820, 0x2ceaf},
                                                                 {0xf900, 0xfaff},
                                                                 {0x2f800, 0x2fa1f}}};
    return std::any_of(blocks.begin(), blocks.end(),
                       [c](const auto& b) { return c >= b.first && c <= b.second; });
}

// Drops control characters, spaces out ideographs, composes, and splits at white space; pieces in lower case.
std::vector<icu::UnicodeString> normalised_pieces(std::string_view text) {
    const auto source =
        icu::UnicodeString::fromUTF8(icu::StringPiece(text.data(), static_cast<int32_t>(text.size())));
    icu::UnicodeString clean;
    for (int32_t i = 0; i < source.length(); i = source.moveIndex32(i, 1)) {
        const UChar32 c = source.char32At(i);
        if (c == 0 || c == 0xfffd || is_control(c)) continue;
        if (is_space(c)) {
            clean.append(static_cast<UChar32>(' '));
        } else if (is_ideograph(c)) {
            clean.append(static_cast<UChar32>(' ')).append(c).append(static_cast<UChar32>(' '));
        } else {
            clean.append(c);
        }
    }
    UErrorCode status = U_ZERO_ERROR;
    const auto* composer = icu::Normalizer2::getNFCInstance(status);
    if (U_SUCCESS(status)) clean = composer->normalize(clean, status);
    std::vector<icu::UnicodeString> pieces;
    icu::UnicodeString piece;
    clean.append(static_cast<UChar32>(' '));
    for (int32_t i = 0; i < clean.length(); i = clean.moveIndex32(i, 1)) {
        const UChar32 c = clean.char32At(i);
        if (!is_space(c)) {
            piece.append(c);
        } else if (!piece.isEmpty()) {
            pieces.push_back(piece.toLower(icu::Locale::getRoot()));
            piece.remove();
        }
    }
    return pieces;
}

// Length of the special token or contraction at `at`, else 0.
int32_t fixed_match(const icu::UnicodeString& text, int32_t at) {
    static const std::array<icu::UnicodeString, 9> fixed{
        icu::UnicodeString(StartToken), icu::UnicodeString(EndToken), icu::UnicodeString("'s"),
        icu::UnicodeString("'t"),       icu::UnicodeString("'re"),    icu::UnicodeString("'ve"),
        icu::UnicodeString("'m"),       icu::UnicodeString("'ll"),    icu::UnicodeString("'d")};
    for (const auto& candidate : fixed)
        if (text.compare(at, candidate.length(), candidate) == 0) return candidate.length();
    return 0;
}

// special tokens | contractions | letters | one digit | other characters, tried in this order at each place.
std::vector<std::string> split_piece(const icu::UnicodeString& piece) {
    std::vector<std::string> words;
    int32_t at = 0;
    while (at < piece.length()) {
        int32_t end = at + fixed_match(piece, at);
        if (end == at) {
            const UChar32 first = piece.char32At(at);
            const auto same_kind = [&](UChar32 c) {
                return is_letter(first) ? is_letter(c) : !is_letter(c) && !is_number(c);
            };
            end = piece.moveIndex32(at, 1);
            if (!is_number(first))
                while (end < piece.length() && same_kind(piece.char32At(end)))
                    end = piece.moveIndex32(end, 1);
        }
        words.push_back(to_utf8(piece.tempSubStringBetween(at, end)));
        at = end;
    }
    return words;
}

std::string content_of(const Json& value) {
    if (value.is_string()) return value.get<std::string>();
    if (value.is_object() && value.contains("content") && value["content"].is_string())
        return value["content"].get<std::string>();
    return {};
}

}  // namespace

Tokenizer::Tokenizer(const std::filesystem::path& folder, const std::string& pad_token) : folder_(folder) {
    const auto single = folder / "tokenizer.json";
    const bool is_single = !std::filesystem::exists(folder / "merges.txt") && std::filesystem::exists(single);
    if (is_single) {
        read_single_file(single);
    } else {
        read_merges(folder / "merges.txt");
        read_vocabulary(folder);
    }
    bos_ = id_of(StartToken);
    eos_ = id_of(EndToken);
    if (bos_ < 0 || eos_ < 0)
        throw Error(ErrorCode::Malformed, "the tokenizer's vocabulary has no start or end token", {},
                    is_single ? single : folder / "vocab.json");
    if (pad_ < 0) pad_ = eos_;
    if (unknown_ < 0) unknown_ = eos_;
    read_added_tokens(folder);
    read_special_tokens(folder);
    if (!pad_token.empty()) set_special_token(pad_token, pad_);
    merge_lines_.clear();
}

void Tokenizer::read_merges(const std::filesystem::path& path) {
    const std::string text = read_file(path);
    std::size_t begin = 0;
    while (begin < text.size() && ranks_.size() < MaxMerges) {
        const auto end = std::min(text.find('\n', begin), text.size());
        std::string line = text.substr(begin, end - begin);
        if (!line.empty() && line.back() == '\r') line.pop_back();
        begin = end + 1;
        if (line.empty() || line.starts_with("#version")) continue;
        add_merge(std::move(line), path);
    }
}

void Tokenizer::add_merge(std::string line, const std::filesystem::path& path) {
    const auto blank = line.find(' ');
    if (blank == std::string::npos || blank == 0 || blank + 1 == line.size() ||
        line.find(' ', blank + 1) != std::string::npos)
        throw Error(ErrorCode::Malformed,
                    fmt::format("merge {} of the tokenizer is not two symbols", ranks_.size() + 1), {}, path);
    ranks_.emplace(line, static_cast<int>(ranks_.size()));
    merge_lines_.push_back(std::move(line));
}

void Tokenizer::read_single_file(const std::filesystem::path& path) {
    auto tables = read_tokenizer_json(path);
    for (auto& line : tables.merges)
        if (ranks_.size() < MaxMerges) add_merge(std::move(line), path);
    vocabulary_ = std::move(tables.vocabulary);
    for (const auto& [token, id] : vocabulary_) vocabulary_size_ = std::max(vocabulary_size_, id + 1);
    for (const auto& [token, id] : tables.added) {
        if (!vocabulary_.contains(token)) added_[token] = id;
        vocabulary_size_ = std::max(vocabulary_size_, id + 1);
    }
    if (!tables.unknown.empty()) set_special_token(tables.unknown, unknown_);
    if (!tables.padding.empty()) set_special_token(tables.padding, pad_);
    if (tables.max_length >= 3 && tables.max_length <= LengthLimit) max_length_ = tables.max_length;
}

void Tokenizer::read_vocabulary(const std::filesystem::path& folder) {
    const auto path = folder / "vocab.json";
    if (std::filesystem::exists(path)) {
        // Not read_json_file: an ordered object looks each of 49408 names up one by one.
        const auto json = try_parse_json(read_file(path));
        if (!json.is_object())
            throw Error(ErrorCode::Malformed, "the tokenizer's vocabulary is not a JSON object", {}, path);
        for (const auto& [token, id] : json.items()) {
            if (!id.is_number_unsigned() ||
                id.get<std::uint64_t>() > std::numeric_limits<std::int32_t>::max())
                throw Error(ErrorCode::Malformed,
                            fmt::format("the vocabulary's token \"{}\" has no valid number", token), {},
                            path);
            vocabulary_.emplace(token, id.get<std::int64_t>());
        }
    } else {
        // openai/CLIP: byte symbols in order of their code (printable first), the same with word end, merges,
        // specials.
        std::vector<std::string> symbols(byte_symbols().begin(), byte_symbols().end());
        std::stable_sort(symbols.begin(), symbols.end(), [](const std::string& a, const std::string& b) {
            return icu::UnicodeString::fromUTF8(a).char32At(0) < icu::UnicodeString::fromUTF8(b).char32At(0);
        });
        const auto add = [&](const std::string& token) {
            vocabulary_.emplace(token, static_cast<std::int64_t>(vocabulary_.size()));
        };
        for (const auto& symbol : symbols) add(symbol);
        for (const auto& symbol : symbols) add(symbol + WordEnd);
        for (auto line : merge_lines_) {
            line.erase(line.find(' '), 1);
            add(line);
        }
        add(StartToken);
        add(EndToken);
    }
    for (const auto& [token, id] : vocabulary_) vocabulary_size_ = std::max(vocabulary_size_, id + 1);
}

void Tokenizer::read_special_tokens(const std::filesystem::path& folder) {
    const auto apply = [&](const Json& json, const char* key, std::int64_t& target) {
        if (json.is_object() && json.contains(key)) set_special_token(content_of(json[key]), target);
    };
    for (const char* name : {"tokenizer_config.json", "special_tokens_map.json"}) {
        if (!std::filesystem::exists(folder / name)) continue;
        const auto json = read_json_file(folder / name);
        apply(json, "bos_token", bos_);
        apply(json, "eos_token", eos_);
        apply(json, "unk_token", unknown_);
        apply(json, "pad_token", pad_);
        if (json.is_object() && json.contains("model_max_length") && json["model_max_length"].is_number()) {
            const double length = json["model_max_length"].get<double>();
            max_length_ =
                length >= 3 && length <= LengthLimit ? static_cast<std::int64_t>(length) : DefaultLength;
        }
    }
}

void Tokenizer::set_special_token(const std::string& token, std::int64_t& target) {
    const auto id = id_of(token);
    if (id < 0) return;
    target = id;
    // The reference matches special tokens anywhere: with padding "!" every "!" is token 0.
    added_[token] = id;
}

void Tokenizer::read_added_tokens(const std::filesystem::path& folder) {
    added_[StartToken] = bos_;
    added_[EndToken] = eos_;
    const auto add = [&](const std::string& token, std::int64_t id) {
        if (!token.empty() && id >= 0) added_[token] = id;
        vocabulary_size_ = std::max(vocabulary_size_, id + 1);
    };
    if (std::filesystem::exists(folder / "added_tokens.json")) {
        const auto json = read_json_file(folder / "added_tokens.json");
        for (const auto& [token, id] : json.items())
            if (id.is_number_integer()) add(token, id.get<std::int64_t>());
    }
    if (!std::filesystem::exists(folder / "tokenizer_config.json")) return;
    const auto json = read_json_file(folder / "tokenizer_config.json");
    if (!json.is_object() || !json.contains("added_tokens_decoder") ||
        !json["added_tokens_decoder"].is_object())
        return;
    for (const auto& [id, value] : json["added_tokens_decoder"].items()) {
        const auto token = content_of(value);
        if (!id.empty() && !vocabulary_.contains(token) &&
            id.find_first_not_of("0123456789") == std::string::npos && id.size() < 10)
            add(token, std::stoll(id));
    }
}

std::int64_t Tokenizer::id_of(const std::string& token) const {
    const auto found = vocabulary_.find(token);
    if (found != vocabulary_.end()) return found->second;
    const auto added = added_.find(token);
    return added == added_.end() ? -1 : added->second;
}

std::vector<Token> Tokenizer::tokenize(std::string_view text) const {
    std::vector<Token> tokens;
    int words = 0;
    std::size_t plain = 0, at = 0;
    while (at < text.size()) {
        const std::pair<const std::string, std::int64_t>* longest = nullptr;
        for (const auto& added : added_)
            if (text.substr(at).starts_with(added.first) &&
                (longest == nullptr || added.first.size() > longest->first.size()))
                longest = &added;
        if (longest == nullptr) {
            ++at;
            continue;
        }
        append_plain(text.substr(plain, at - plain), tokens, words);
        tokens.push_back({longest->second, words++});
        at += longest->first.size();
        plain = at;
    }
    append_plain(text.substr(plain), tokens, words);
    return tokens;
}

void Tokenizer::append_plain(std::string_view text, std::vector<Token>& tokens, int& words) const {
    for (const auto& piece : normalised_pieces(text))
        for (const auto& word : split_piece(piece)) append_word(word, tokens, words);
}

void Tokenizer::append_word(const std::string& word, std::vector<Token>& tokens, int& words) const {
    const int number = words++;
    if (word == StartToken || word == EndToken) {
        tokens.push_back({id_of(word), number});
        return;
    }
    std::vector<std::string> symbols;
    for (const char letter : word) symbols.push_back(byte_symbols()[static_cast<unsigned char>(letter)]);
    symbols.back() += WordEnd;
    while (symbols.size() > 1) {
        int best = std::numeric_limits<int>::max();
        std::string pair;
        for (std::size_t i = 0; i + 1 < symbols.size(); ++i) {
            const auto found = ranks_.find(symbols[i] + ' ' + symbols[i + 1]);
            if (found == ranks_.end() || found->second >= best) continue;
            best = found->second;
            pair = found->first;
        }
        if (pair.empty()) break;
        std::vector<std::string> merged;
        for (std::size_t i = 0; i < symbols.size(); ++i) {
            const bool joins = i + 1 < symbols.size() && pair == symbols[i] + ' ' + symbols[i + 1];
            merged.push_back(joins ? symbols[i] + symbols[i + 1] : symbols[i]);
            i += joins ? 1 : 0;
        }
        symbols = std::move(merged);
    }
    for (const auto& symbol : symbols) {
        const auto id = id_of(symbol);
        tokens.push_back({id >= 0 ? id : unknown_, number});
    }
}

Encoding Tokenizer::encode(std::string_view text, std::int64_t max_length) const {
    const auto length = static_cast<std::size_t>(max_length > 0 ? max_length : max_length_);
    Encoding encoding;
    encoding.tokens = tokenize(text);
    const std::size_t kept = std::min(encoding.tokens.size(), length - 2);
    encoding.truncated = kept < encoding.tokens.size();
    encoding.ids.assign(length, pad_);
    encoding.ids[0] = bos_;
    for (std::size_t i = 0; i < kept; ++i) encoding.ids[i + 1] = encoding.tokens[i].id;
    encoding.ids[kept + 1] = eos_;
    return encoding;
}

std::vector<std::int64_t> Tokenizer::find_word(std::string_view prompt, std::string_view word,
                                               std::int64_t max_length) const {
    const auto length = static_cast<std::size_t>(max_length > 0 ? max_length : max_length_);
    const auto tokens = tokenize(prompt);
    const auto wanted = tokenize(word);
    std::vector<std::int64_t> columns;
    bool cut_off = false;
    for (std::size_t i = 0; !wanted.empty() && i + wanted.size() <= tokens.size(); ++i) {
        const std::size_t end = i + wanted.size();
        const bool begins = i == 0 || tokens[i - 1].word != tokens[i].word;
        const bool ends = end == tokens.size() || tokens[end].word != tokens[end - 1].word;
        const auto same = [](const Token& a, const Token& b) { return a.id == b.id; };
        if (!begins || !ends ||
            !std::equal(wanted.begin(), wanted.end(), tokens.begin() + static_cast<std::ptrdiff_t>(i), same))
            continue;
        if (i + wanted.size() > length - 2) {
            cut_off = true;
            continue;
        }
        for (std::size_t k = 0; k < wanted.size(); ++k)
            columns.push_back(static_cast<std::int64_t>(i + k + 1));
    }
    if (!columns.empty()) return columns;
    if (cut_off)
        throw Error(
            ErrorCode::NotFound,
            fmt::format("the word \"{}\" stands beyond the {} tokens that the model reads", word, length - 2),
            "shorten the prompt or move the word forward");
    throw Error(ErrorCode::NotFound,
                fmt::format("the prompt \"{}\" does not contain the word \"{}\"", prompt, word),
                "use a word of the prompt, spelt the same way");
}

}  // namespace gse::neural
