// Cells of two tables, shaded.
#include "engine/laboratory/bench/raster/stability_chart.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/io/image/drawing.h"
#include "engine/laboratory/bench/charts/pareto_chart.h"
#include "engine/laboratory/bench/raster/stability_bench.h"

namespace gse::bench {
namespace {

constexpr double CellHeight = 26, NamesWidth = 150, Gap = 24, Edge = 20, HeadHeight = 110, TextHeight = 9;
constexpr DrawColour Black{0.12f, 0.12f, 0.14f}, Deep{0.10f, 0.35f, 0.62f}, White{1, 1, 1};

void fill(Image& image, double left, double top, double right, double bottom, const DrawColour& colour) {
    for (int y = static_cast<int>(top); y < std::min(image.height, static_cast<int>(bottom)); ++y)
        for (int x = static_cast<int>(left); x < std::min(image.width, static_cast<int>(right)); ++x)
            for (int c = 0; c < 3; ++c) image.at(x, y, c) = colour[static_cast<std::size_t>(c)];
}

void centred(Image& image, double x, double y, const std::string& text, const DrawColour& colour) {
    draw_text(image, x - text_width(text, TextHeight) / 2, y, text, TextHeight, colour);
}

std::string decade_name(std::size_t decade) {
    if (decade == 0) return "less";
    return "1e" + std::to_string(static_cast<int>(decade) - static_cast<int>(ErrorDecades));
}

void draw_line_of_cells(Image& image, double left, double top, double cell,
                        const std::vector<std::size_t>& counts) {
    const double all = static_cast<double>(std::accumulate(counts.begin(), counts.end(), std::size_t{0}));
    for (std::size_t i = 0; i < counts.size(); ++i) {
        if (counts[i] == 0) continue;
        const auto share = static_cast<float>(
            0.12 + 0.88 * std::sqrt(static_cast<double>(counts[i]) / all));  // one of many is seen too
        DrawColour shade;
        for (std::size_t c = 0; c < 3; ++c) shade[c] = 1 + share * (Deep[c] - 1);
        const double x = left + static_cast<double>(i) * cell;
        fill(image, x + 1, top + 1, x + cell, top + CellHeight, shade);
        centred(image, x + cell / 2, top + 0.5 * (CellHeight + TextHeight), std::to_string(counts[i]),
                share > 0.55f ? White : Black);
    }
}

}  // namespace

Image draw_histograms(const std::string& title, const std::vector<std::string>& names,
                      const std::vector<HistogramPanel>& panels, const std::vector<std::string>& notes) {
    const double bottom = HeadHeight + CellHeight * static_cast<double>(names.size());
    Image image(ChartWidth, static_cast<int>(bottom + 30 + 20 * static_cast<double>(notes.size())), 3, 1.0f);
    draw_text(image, Edge, 34, title, 13, Black);
    const auto count = static_cast<double>(std::max<std::size_t>(1, panels.size()));
    const double width = (ChartWidth - 2 * Edge - NamesWidth - Gap * (count - 1)) / count;
    const double cell = width / static_cast<double>(ErrorDecades);
    for (std::size_t i = 0; i < names.size(); ++i) {
        const double top = HeadHeight + CellHeight * static_cast<double>(i);
        if (i % 2 == 0) fill(image, Edge, top, ChartWidth - Edge, top + CellHeight, {0.96f, 0.96f, 0.97f});
        draw_text(image, Edge + 4, top + 0.5 * (CellHeight + TextHeight), names[i], TextHeight, Black);
    }
    for (std::size_t p = 0; p < panels.size(); ++p) {
        const double left = Edge + NamesWidth + static_cast<double>(p) * (width + Gap);
        draw_text(image, left, 68, panels[p].title, 10, Black);
        for (std::size_t d = 0; d < ErrorDecades; ++d)
            centred(image, left + (static_cast<double>(d) + 0.5) * cell, HeadHeight - 10, decade_name(d),
                    Black);
        for (std::size_t i = 0; i < panels[p].counts.size(); ++i)
            draw_line_of_cells(image, left, HeadHeight + CellHeight * static_cast<double>(i), cell,
                               panels[p].counts[i]);
    }
    for (std::size_t i = 0; i < notes.size(); ++i)
        draw_text(image, Edge, bottom + 30 + 20 * static_cast<double>(i), notes[i], TextHeight, Black);
    return image;
}

}  // namespace gse::bench
