// Several edits by one sentence, each from another seed, to choose from.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "engine/pipeline/run/edit_job.h"

namespace gse::pipeline {

constexpr int MostVariations = 64;

/// The recipe of a variation, counted from 0: the same but for the seed.
EditRecipe variation_of(EditRecipe recipe, int index);

/// A contact sheet: the unedited scene in its first row, below it a row for each edit, from four directions.
class VariationSheet {
public:
    /// `name`: what its row is called; the seed, and the verdict's score where there is one, are added to it.
    void add(EditJob& job, const std::string& name);
    bool empty() const { return rows_.empty(); }
    /// As PNG; something must have been added.
    void write(const std::filesystem::path& path) const;

private:
    struct Row {
        std::string caption;
        std::vector<Image> pictures;
    };
    std::vector<Row> rows_;
};

/// What a variation is called on the sheet and in a summary: "2: seed 1, score 0.61".
std::string variation_caption(const EditJob& job, const std::string& name);

}  // namespace gse::pipeline
