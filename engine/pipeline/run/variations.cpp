// Rows of pictures.
#include "engine/pipeline/run/variations.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "engine/base/check.h"
#include "engine/io/image/drawing.h"
#include "engine/io/image/image_file.h"
#include "engine/math/camera.h"

namespace gse::pipeline {
namespace {

constexpr int PictureSide = 256, RowGap = 6, RowCaption = 22, Directions = 4;  // pixels
constexpr float SheetColour = 0.1f;
constexpr double RowLetters = 10, FirstAzimuth = 0.35;  // radians from the front, as in before_after.png
constexpr DrawColour RowText{0.85f, 0.85f, 0.85f};

std::vector<Image> around(EditJob& job, const GaussianSet& set) {
    std::vector<Image> pictures;
    for (int i = 0; i < Directions; ++i) {
        const double azimuth = job.film_front() + FirstAzimuth + 2 * std::numbers::pi * i / Directions;
        pictures.push_back(job.painter()
                               .paint(set.spans(),
                                      orbit_camera(job.film_orbit(), azimuth, PictureSide, PictureSide),
                                      job.plan().settings)
                               .colour);
    }
    return pictures;
}

}  // namespace

EditRecipe variation_of(EditRecipe recipe, int index) {
    recipe.request.seed += static_cast<std::uint64_t>(index);
    return recipe;
}

std::string variation_caption(const EditJob& job, const std::string& name) {
    const auto& verdict = job.edited().verdict;
    const auto score =
        verdict && verdict->score ? fmt::format(", score {:.2f}", *verdict->score) : std::string();
    return fmt::format("{}: seed {}{}", name, job.recipe().request.seed, score);
}

void VariationSheet::add(EditJob& job, const std::string& name) {
    if (rows_.empty()) rows_.push_back({"before", around(job, job.drawn())});
    rows_.push_back({variation_caption(job, name), around(job, job.drawn_result())});
}

void VariationSheet::write(const std::filesystem::path& path) const {
    GSE_CHECK(!rows_.empty());
    constexpr int row_height = RowCaption + PictureSide + RowGap;
    Image sheet(Directions * (PictureSide + RowGap) + RowGap,
                static_cast<int>(rows_.size()) * row_height + RowGap, 3, SheetColour);
    for (std::size_t r = 0; r < rows_.size(); ++r) {
        const int top = static_cast<int>(r) * row_height;
        draw_text(sheet, RowGap, top + RowCaption - 6, rows_[r].caption, RowLetters, RowText);
        for (std::size_t i = 0; i < rows_[r].pictures.size(); ++i)
            for (int y = 0; y < PictureSide; ++y)
                for (int x = 0; x < PictureSide; ++x)
                    for (int c = 0; c < 3; ++c)
                        sheet.at(RowGap + static_cast<int>(i) * (PictureSide + RowGap) + x,
                                 top + RowCaption + y, c) =
                            std::clamp(rows_[r].pictures[i].at(x, y, c), 0.0f, 1.0f);
    }
    write_png(path, sheet);
}

}  // namespace gse::pipeline
