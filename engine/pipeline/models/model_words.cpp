// Words of a model, by its files.
#include "engine/pipeline/models/model_words.h"

#include <memory>
#include <mutex>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/json.h"
#include "engine/base/log.h"
#include "engine/edit/words/dye_words.h"
#ifdef GSE_NEURAL
#include "engine/language/lexicon.h"
#include "engine/language/vocabulary.h"
#include "engine/neural/api/prompt_reader.h"
#endif

namespace gse::pipeline {

namespace fs = std::filesystem;

constexpr std::uint64_t LongestHeader = 64u << 20;

#ifdef GSE_NEURAL
namespace {

/// The reader of the model asked about last; null where it has none.
std::shared_ptr<const neural::PromptReader> reader_of(const fs::path& model) {
    static std::mutex mutex;
    static fs::path path;
    static std::shared_ptr<const neural::PromptReader> reader;
    const std::lock_guard lock(mutex);
    if (path == model) return reader;
    path = model;
    reader = nullptr;
    try {
        reader = std::make_shared<const neural::PromptReader>(model);
    } catch (const Error& error) {  // what is wrong with the model is said when it is loaded
        log::debug("where sentences are cut is not known: {}", error.what());
    }
    return reader;
}

}  // namespace

std::size_t words_read(const fs::path& model, const std::vector<std::string>& words) {
    const auto reader = reader_of(model);
    if (!reader) return words.size();
    const auto known = language::promptable_vocabulary(model_words(model), generated_vocabulary(model));
    std::vector<std::string> told;
    std::vector<std::size_t> places;  // of what is told, in the sentence
    for (std::size_t i = 0; i < words.size(); ++i) {
        const auto kept = words[i] == language::Identifier || known.empty()
                              ? std::vector<std::string>{words[i]}
                              : language::match_word(words[i], known).kept;
        for (const auto& word : kept) {
            told.push_back(word);
            places.push_back(i);
        }
    }
    const auto read = reader->words_read(told);
    return read < told.size() ? places[read] : words.size();
}
#else
std::size_t words_read(const fs::path&, const std::vector<std::string>& words) { return words.size(); }
#endif

nlohmann::json model_json(const fs::path& path) {
    return fs::exists(path) ? try_parse_json(read_start(path, LongestHeader)) : nlohmann::json();
}

namespace {

std::vector<std::string> word_list(const fs::path& folder, const char* key) {
    std::vector<std::string> words;
    const auto own = model_json(folder / "gseditpro.json");
    if (!own.is_object() || !own.contains(key) || !own[key].is_array()) return words;
    for (const auto& word : own[key])
        if (word.is_string()) words.push_back(word.get<std::string>());
    return words;
}

}  // namespace

std::vector<std::string> model_words(const fs::path& folder) { return word_list(folder, "vocabulary"); }

language::plan::ModelAbility model_ability(const fs::path& folder) {
    auto known = model_words(folder);
    const bool open = known.empty();
    return {open, std::move(known)};
}

std::vector<std::string> generated_vocabulary(const fs::path& folder) {
    const auto known = model_words(folder);
    return known.empty() ? known : edit::with_dyes(word_list(folder, "drawn_vocabulary"), known);
}

}  // namespace gse::pipeline
