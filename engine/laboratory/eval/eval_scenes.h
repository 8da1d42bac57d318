// Edits of real scenes: no truth to compare with, but what must not change can be measured.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/laboratory/eval/eval_sheet.h"
#include "engine/pipeline/run/edit_job.h"

namespace gse::bench {

/// A scene file with its edit.
struct RealEdit {
    std::string path, source, prompt, target;
};

/// "PATH" or "PATH:source:sentence:target"; what is left out is guessed: the word from the file's name, and
/// gold. Throws Error when the text has another form.
RealEdit parse_real_edit(const std::string& text, const std::vector<std::string>& known_words);

/// Figures of one real edit: labels, preservation on the edit's views and on others, drift, times; adds its
/// row to `sheets`. A failure becomes "error". Throws Error only when stopped.
nlohmann::ordered_json run_real_edit(const RealEdit& edit, pipeline::EditRecipe recipe,
                                     const std::shared_ptr<neural::TextToImage>& model, ContactSheets& sheets,
                                     const JobControl& job);

}  // namespace gse::bench
