// Models that were found on this machine, and what the one in use knows.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "ui/model/view_model.h"

namespace gse::app {

class ModelList {
public:
    /// Looks for models; `in_use` is a path and is listed in any case.
    void refresh(const std::string& in_use);
    /// A model is being tried; empty = none is.
    void try_out(const std::string& path);
    /// It cannot be used, for this reason.
    void refuse(const std::string& path, const std::string& problem) { problems_[path] = problem; }
    void accept(const std::string& path) { problems_.erase(path); }

    /// The row of a path; null where it is not listed.
    const ui::ModelView* find(const std::string& path) const;
    /// Name of a model, or its path.
    std::string name_of(const std::string& path) const;
    const std::vector<std::string>& known_words() const { return known_words_; }
    const std::vector<std::string>& generated_vocabulary() const { return generated_vocabulary_; }
    /// Words of sentences that it takes: found or drawn; empty = any.
    std::vector<std::string> words_to_say() const;
    void show(ui::ModelPart& model) const;

private:
    std::vector<ui::ModelView> rows_;
    std::map<std::string, std::string> problems_;  // by path, of models that were tried; empty = none yet
    std::string tried_;
    std::vector<std::string> known_words_, generated_vocabulary_;  // of the model in use
};

}  // namespace gse::app
