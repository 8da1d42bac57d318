// Pairs in rows.
#include "engine/pipeline/report/target_sheet.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/io/image/drawing.h"
#include "engine/io/image/image_file.h"
#include "engine/localize/clusters.h"

namespace gse::pipeline {
namespace {

constexpr int CellSide = 192, Gap = 6, CaptionHeight = 20;  // pixels
constexpr std::size_t PairsPerRow = 2;
constexpr float CleanPlate = 0.1f, DroppedLight = 0.35f;
constexpr double LetterHeight = 9;
constexpr DrawColour CaptionColour{0.8f, 0.8f, 0.8f};

std::string file_name(const edit::ViewTargets& round) { return fmt::format("targets_{}.png", round.round); }

std::string name_of(const std::vector<View>& views, std::size_t view) {
    return view < views.size() && !views[view].name.empty() ? views[view].name : fmt::format("view {}", view);
}

std::string caption(const edit::ViewTarget& target, const std::vector<View>& views) {
    std::string text = name_of(views, target.view);
    if (target.attempt > 0) text += fmt::format(", redrawn {} more", target.attempt);
    if (target.missing) text += ", missing";
    else if (target.dropped) text += ", dropped";
    return text;
}

/// Into a cell, as large as fits.
void paste(const Image& picture, int left, int top, float light, Image& sheet) {
    const int longer = std::max({picture.width, picture.height, 1});
    const Image scaled = localize::resize_image(picture, std::max(1, picture.width * CellSide / longer),
                                                std::max(1, picture.height * CellSide / longer));
    for (int y = 0; y < scaled.height; ++y)
        for (int x = 0; x < scaled.width; ++x)
            for (int c = 0; c < 3; ++c)
                sheet.at(left + x, top + y, c) = light * std::clamp(scaled.at(x, y, c), 0.0f, 1.0f);
}

}  // namespace

Image target_sheet(const edit::ViewTargets& round, const std::vector<View>& views) {
    constexpr int pair_width = 2 * CellSide + 2 + Gap, row_height = CellSide + CaptionHeight + Gap;
    const auto columns = std::clamp<std::size_t>(round.views.size(), 1, PairsPerRow);
    const auto rows = (round.views.size() + PairsPerRow - 1) / PairsPerRow;
    Image sheet(static_cast<int>(columns) * pair_width + Gap, static_cast<int>(rows) * row_height + Gap, 3,
                CleanPlate);
    for (std::size_t i = 0; i < round.views.size(); ++i) {
        const auto& target = round.views[i];
        const int left = Gap + static_cast<int>(i % PairsPerRow) * pair_width,
                  top = Gap + static_cast<int>(i / PairsPerRow) * row_height;
        const float light = target.dropped ? DroppedLight : 1;
        paste(*target.before, left, top, light, sheet);
        paste(*target.after, left + CellSide + 2, top, light, sheet);
        draw_text(sheet, left, top + CellSide + CaptionHeight - 6, caption(target, views), LetterHeight,
                  CaptionColour);
    }
    return sheet;
}

void write_targets(const std::filesystem::path& folder, ThreadPool& threads,
                   const std::vector<edit::ViewTargets>& rounds, const std::vector<View>& views) {
    threads.parallel_for(rounds.size(), 1, [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t i = begin; i < end; ++i)
            write_png(folder / file_name(rounds[i]), target_sheet(rounds[i], views));
    });
}

std::vector<std::string> missing_views(const std::vector<edit::ViewTargets>& rounds,
                                       const std::vector<View>& views) {
    std::vector<std::string> names;
    for (const auto& round : rounds)
        for (const auto& target : round.views)
            if (target.missing) names.push_back(name_of(views, target.view));
    return names;
}

nlohmann::ordered_json targets_to_json(const std::vector<edit::ViewTargets>& rounds,
                                       const std::vector<View>& views) {
    auto list = nlohmann::ordered_json::array();
    for (const auto& round : rounds) {
        nlohmann::ordered_json entry{{"round", round.round}, {"file", "evidence/" + file_name(round)}};
        if (!round.sentence.empty()) entry["sentence"] = round.sentence;  // it says more than the artist's
        if (!round.warnings.empty()) entry["warnings"] = round.warnings;
        entry["views"] = nlohmann::ordered_json::array();
        for (const auto& target : round.views) {
            entry["views"].push_back({{"view", name_of(views, target.view)},
                                      {"redrawn", target.attempt},
                                      {"dropped", target.dropped}});
            if (target.missing) entry["views"].back()["missing"] = true;
        }
        list.push_back(std::move(entry));
    }
    return list;
}

}  // namespace gse::pipeline
