// Histograms by cause as a picture.
#pragma once

#include <string>
#include <vector>

#include "engine/base/image.h"

namespace gse::bench {

/// A row of counts per name.
struct HistogramPanel {
    std::string title;                             // what is counted
    std::vector<std::vector<std::size_t>> counts;  // [names][decades]
};

/// Chart [H,ChartWidth,3]: panels beside each other, a line per name and a cell per decade of error
/// (stability_bench.h). A cell is darker the larger its share of the line, with the count in it.
Image draw_histograms(const std::string& title, const std::vector<std::string>& names,
                      const std::vector<HistogramPanel>& panels, const std::vector<std::string>& notes);

}  // namespace gse::bench
