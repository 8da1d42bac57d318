// Several edits by one sentence, each from another seed, to choose from.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "engine/pipeline/run/edit_job.h"

namespace gse::pipeline {

constexpr int MostVariations = 64;

/// Recipe of a variation, counted from 0: only the seed differs.
EditRecipe variation_of(EditRecipe recipe, int index);

/// Contact sheet from four directions: the unedited scene in its first row, below it a row for each edit.
class VariationSheet {
public:
    /// Adds a row called `name`. The seed, and the verdict's score if there is one, are added to it.
    void add(EditJob& job, const std::string& name);
    bool empty() const { return rows_.empty(); }
    /// Bytes as PNG. At least one row must have been added.
    void write(const std::filesystem::path& path) const;

private:
    struct Row {
        std::string caption;
        std::vector<Image> pictures;
    };
    std::vector<Row> rows_;
};

/// Name of a variation on the sheet and in a summary: "2: seed 1, score 0.61".
std::string variation_caption(const EditJob& job, const std::string& name);

}  // namespace gse::pipeline
