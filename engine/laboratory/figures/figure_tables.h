// Tables of engine/FIGURES.md, from what `gseditpro-lab eval` and `bench` leave.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace gse::bench {

/// Rows of a Markdown table; `rows[0]` is the head. Every row has as many cells.
std::string markdown_table(const std::vector<std::vector<std::string>>& rows);

/// Figures of the standard suite, a column per evaluation, with goals. `reports`: eval.json of each seed.
std::string edits_table(const std::vector<nlohmann::ordered_json>& reports);
/// Medians over all edits of each kind of all evaluations: error removed, outline IoU, PSNR outside, passes
/// of the UNet.
std::string kinds_table(const std::vector<nlohmann::ordered_json>& reports);
/// Figures of each new word ("pink", "rabbit"): edits, median of the error removed, outline IoU.
std::string words_table(const std::vector<nlohmann::ordered_json>& reports);
/// UNet passes of the search and of the whole edit, per mode of the edit: least, median, most.
std::string passes_table(const std::vector<nlohmann::ordered_json>& reports);

/// How many searches were refused at the default threshold `least_confidence`, per kind of word. `searches`:
/// the JSON of `bench search`.
std::string searches_table(const nlohmann::ordered_json& searches, double least_confidence);
/// Shares of scenes whose front is right to 15 and 45 degrees, and what the encoder tells. `clip`: the JSON
/// of `bench clip`.
std::string encoder_table(const nlohmann::ordered_json& clip);
/// A line per method and setting. `edit`: edit.json of `bench edit`.
std::string methods_table(const nlohmann::ordered_json& edit);
/// A line per way to make the views of a server agree. `rows`: the JSON of `bench server`.
std::string servers_table(const nlohmann::ordered_json& rows);
/// A line per cause of trouble. `stability`: stability.json of `bench stability`.
std::string stability_table(const nlohmann::ordered_json& stability);

}  // namespace gse::bench
