// Models that were found on this machine, and what the one in use knows.
#include "app/session/model_list.h"

#include <algorithm>
#include <utility>

#include "engine/language/vocabulary.h"
#include "engine/pipeline/models/model_catalogue.h"
#include "engine/pipeline/models/model_words.h"

namespace gse::app {

void ModelList::refresh(const std::string& in_use) {
    std::vector<std::string> tried;
    for (const auto& [path, problem] : problems_) tried.push_back(path);
    tried.push_back(in_use);
    rows_.clear();
    for (auto& found : pipeline::find_models(tried)) {
        ui::ModelView row{std::move(found)};
        row.chosen = row.path == in_use;
        row.checking = row.path == tried_;
        const auto problem = problems_.find(row.path);
        if (problem != problems_.end() && !problem->second.empty()) {
            row.usable = false;
            row.problem = problem->second;
        }
        rows_.push_back(std::move(row));
    }
    known_words_ = pipeline::model_words(in_use);
    generated_vocabulary_ = pipeline::generated_vocabulary(in_use);
}

void ModelList::try_out(const std::string& path) {
    tried_ = path;
    if (!path.empty()) problems_.try_emplace(path);
}

const ui::ModelView* ModelList::find(const std::string& path) const {
    const auto row =
        std::find_if(rows_.begin(), rows_.end(), [&](const auto& model) { return model.path == path; });
    return row == rows_.end() ? nullptr : &*row;
}

std::string ModelList::name_of(const std::string& path) const {
    const auto* row = find(path);
    return row == nullptr || row->name.empty() ? path : row->name;
}

std::vector<std::string> ModelList::words_to_say() const {
    return language::promptable_vocabulary(known_words_, generated_vocabulary_);
}

void ModelList::show(ui::ModelPart& model) const {
    model.models = rows_;
    model.known_words = known_words_;
    model.generated_vocabulary = generated_vocabulary_;
    model.words_known = true;
}

}  // namespace gse::app
