// Names compared as sentences write them.
#include "engine/pipeline/scene/label_names.h"

#include <algorithm>
#include <utility>

#include "engine/language/plan/words/file_words.h"
#include "engine/language/vocabulary.h"
#include "engine/language/words.h"

namespace gse::pipeline {
namespace {

bool marks_splats(const Label& label) {
    return std::find(label.bits->begin(), label.bits->end(), std::uint8_t{1}) != label.bits->end();
}

}  // namespace

const Label* label_named(const LabelSet& labels, std::string_view name) {
    const auto wanted = language::normalised_prompt(name);
    if (wanted.empty()) return nullptr;
    for (const Label& label : labels.labels)
        if (language::normalised_prompt(label.name) == wanted && marks_splats(label)) return &label;
    for (const Label& label : labels.labels)
        if (language::plan::thing_of_file_name(label.name) == wanted && marks_splats(label)) return &label;
    return nullptr;
}

const Label* label_for(const LabelSet& labels, std::string_view word, const std::vector<std::string>& known) {
    return language::vocabulary_contains(known, word) ? nullptr : label_named(labels, word);
}

std::vector<std::string> words_for_label(std::string_view name) {
    std::vector<std::string> words{language::normalised_prompt(name)};
    if (auto thing = language::plan::thing_of_file_name(name); !thing.empty() && thing != words.front())
        words.push_back(std::move(thing));
    return words;
}

std::vector<std::string> label_names(const LabelSet& labels) {
    std::vector<std::string> names;
    for (const Label& label : labels.labels) {
        if (!marks_splats(label)) continue;
        for (auto& word : words_for_label(label.name)) names.push_back(std::move(word));
    }
    return names;
}

LabelSet gathered(const LabelSet& labels, std::span<const std::int64_t> sources) {
    LabelSet result;
    for (const Label& label : labels.labels) {
        std::vector<float> weight(sources.size(), 0.0f);
        for (std::size_t row = 0; row < sources.size(); ++row)
            if (sources[row] >= 0) weight[row] = (*label.bits)[static_cast<std::size_t>(sources[row])];
        constexpr float Middle = 0.5f;
        result.labels.push_back(make_label(label.name, std::move(weight), Middle));
    }
    return result;
}

}  // namespace gse::pipeline
