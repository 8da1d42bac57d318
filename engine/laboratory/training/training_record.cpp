// Logs, curves and samples of a training.
#include "engine/laboratory/training/training_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/log.h"
#include "engine/io/image/drawing.h"
#include "engine/io/image/image_file.h"
#include "engine/localize/clusters.h"
#include "engine/neural/api/api.h"
#include "engine/pipeline/models/neural_loader.h"

namespace gse::training {
namespace {

constexpr int ChartWidth = 380, ChartHeight = 220, Margin = 14, TitleHeight = 20;
constexpr double TextHeight = 8;
constexpr DrawColour Ink{0.82f, 0.83f, 0.85f}, Dim{0.45f, 0.47f, 0.5f}, Line{0.36f, 0.6f, 0.95f};
constexpr float CleanPlate = 0.1f;
constexpr std::size_t LogHead = 4;  // step, seconds, lr, grad_norm: not curves
constexpr int SampleSide = 128, SampleColumns = 6, SampleSteps = 40;

/// Sentences of the samples: every object, every colour and material, every accessory and ground once or
/// more.
constexpr std::array<const char*, 24> SamplePrompts{"a red bear on the grass",
                                                    "a blue dog on the sand",
                                                    "a green cat on the snow",
                                                    "a yellow duck on the water",
                                                    "a stone statue on the tiles",
                                                    "a purple ball on the grass",
                                                    "a wooden vase on the sand",
                                                    "an orange mushroom on the snow",
                                                    "a black chair on the tiles",
                                                    "a white car on the sand",
                                                    "a golden house on the grass",
                                                    "a green tree on the snow",
                                                    "a red bear wearing a blue hat",
                                                    "a white cat wearing a hat",
                                                    "a blue duck wearing a golden crown",
                                                    "a yellow bear wearing sunglasses",
                                                    "a green dog wearing a red scarf",
                                                    "a stone statue in flames",
                                                    "a purple bear with white wings",
                                                    "a wooden mushroom wearing a crown",
                                                    "an orange vase wearing a black hat",
                                                    "a golden statue, front view",
                                                    "a blue bear, back view",
                                                    "a red car, side view"};

struct TrainingLog {
    std::vector<std::string> columns;
    std::vector<std::vector<double>> values;  // [column][row]
};

TrainingLog read_log(const std::filesystem::path& path) {
    std::istringstream stream(read_file(path));
    TrainingLog log;
    std::string line, word;
    while (std::getline(stream, line)) {
        std::istringstream words(line);
        std::vector<std::string> row;
        while (std::getline(words, word, '\t')) row.push_back(word);
        if (log.columns.empty()) {
            log.columns = row;
            log.values.resize(row.size());
            continue;
        }
        if (row.size() != log.columns.size())
            throw Error(ErrorCode::Malformed,
                        fmt::format("a line has {} values instead of {}", row.size(), log.columns.size()), {},
                        path);
        for (std::size_t i = 0; i < row.size(); ++i)
            log.values[i].push_back(std::strtod(row[i].c_str(), nullptr));
    }
    if (log.columns.size() <= LogHead || log.values[0].empty())
        throw Error(ErrorCode::Malformed, "the log holds no curves", {}, path);
    return log;
}

void draw_curve(Image& sheet, int top, const std::string& title, const std::vector<double>& steps,
                const std::vector<double>& values) {
    double low = 1e300, high = 1e-300;
    for (const double value : values)
        if (value > 0 && std::isfinite(value)) low = std::min(low, value), high = std::max(high, value);
    const int left = Margin, right = ChartWidth - Margin, ceiling = top + TitleHeight + Margin,
              floor = top + ChartHeight - Margin;
    draw_text(sheet, left, top + TitleHeight, title, TextHeight, Ink);
    if (!(high > low)) return;
    const auto height_of = [&](double value) {
        return floor - (floor - ceiling) * std::log(value / low) / std::log(high / low);
    };
    for (const double value : {low, std::sqrt(low * high), high}) {
        const double y = height_of(value);
        draw_polyline(sheet, std::array<std::array<double, 2>, 2>{{{left + 0.0, y}, {right + 0.0, y}}}, 1,
                      Dim);
        draw_text(sheet, left + 2, y - 2, fmt::format("{:.3g}", value), TextHeight * 0.8, Dim);
    }
    std::vector<std::array<double, 2>> points;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const double x = left + (right - left) * (steps.back() > 0 ? steps[i] / steps.back() : 0);
        points.push_back({x, values[i] > 0 ? height_of(values[i]) : std::nan("")});
    }
    draw_polyline(sheet, points, 2, Line);
}

/// Pictures under each other.
Image stacked(const std::vector<Image>& pictures) {
    int width = 0, height = 0;
    for (const auto& picture : pictures) width = std::max(width, picture.width), height += picture.height;
    Image result(width, height, 3, CleanPlate);
    int top = 0;
    for (const auto& picture : pictures) {
        for (int y = 0; y < picture.height; ++y)
            std::copy_n(
                &picture.data[static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) * 3],
                picture.width * 3,
                &result.data[static_cast<std::size_t>(top + y) * static_cast<std::size_t>(width) * 3]);
        top += picture.height;
    }
    return result;
}

Image sample_sheet(neural::TextToImage& model, const JobControl& job) {
    constexpr int gap = 6, cell_height = SampleSide + TitleHeight;
    const int rows = (static_cast<int>(SamplePrompts.size()) + SampleColumns - 1) / SampleColumns;
    Image sheet(SampleColumns * (SampleSide + gap) + gap, rows * (cell_height + gap) + gap, 3, CleanPlate);
    for (std::size_t i = 0; i < SamplePrompts.size(); ++i) {
        if (job.stop_requested()) throw Error(ErrorCode::Cancelled, "drawing the samples was stopped");
        neural::SampleRequest request;
        request.prompt = SamplePrompts[i];
        request.steps = SampleSteps;
        request.seed = i;
        const Image picture = localize::resize_image(model.sample(request), SampleSide, SampleSide);
        const int left = gap + static_cast<int>(i) % SampleColumns * (SampleSide + gap);
        const int top = gap + static_cast<int>(i) / SampleColumns * (cell_height + gap);
        for (int y = 0; y < SampleSide; ++y)
            for (int x = 0; x < SampleSide; ++x)
                for (int c = 0; c < 3; ++c)
                    sheet.at(left + x, top + y, c) = std::clamp(picture.at(x, y, c), 0.0f, 1.0f);
        const double height =
            std::min(TextHeight, TextHeight * SampleSide / text_width(SamplePrompts[i], TextHeight));
        draw_text(sheet, left, top + SampleSide + TitleHeight - 6, SamplePrompts[i], height, Ink);
        job.report("samples", static_cast<int>(i + 1), static_cast<int>(SamplePrompts.size()));
    }
    return sheet;
}

}  // namespace

Image training_curves(const std::filesystem::path& path) {
    const TrainingLog log = read_log(path);
    const auto curves = log.columns.size() - LogHead;
    Image sheet(ChartWidth * static_cast<int>(curves), ChartHeight, 3, CleanPlate);
    std::vector<Image> charts;
    for (std::size_t column = LogHead; column < log.columns.size(); ++column) {
        Image chart(ChartWidth, ChartHeight, 3, CleanPlate);
        draw_curve(chart, 0,
                   fmt::format("{} {}, {:.0f} steps", path.stem().string(), log.columns[column],
                               log.values[0].back()),
                   log.values[0], log.values[column]);
        const int left = ChartWidth * static_cast<int>(column - LogHead);
        for (int y = 0; y < ChartHeight; ++y)
            std::copy_n(&chart.at(0, y, 0), ChartWidth * 3, &sheet.at(left, y, 0));
    }
    return sheet;
}

void write_training_record(const std::filesystem::path& work, const std::filesystem::path& model,
                           const JobControl& job) {
    for (const char* stage : {"vae", "unet", "clip"}) {
        const auto from = work / fmt::format("{}.tsv", stage);
        if (std::filesystem::exists(from))
            write_file(model / "log" / fmt::format("{}.tsv", stage), read_file(from));
    }
    std::vector<std::filesystem::path> logs;  // of earlier runs, too
    if (std::filesystem::is_directory(model / "log"))
        for (const auto& entry : std::filesystem::directory_iterator(model / "log"))
            if (entry.path().extension() == ".tsv") logs.push_back(entry.path());
    std::sort(logs.begin(), logs.end());
    std::vector<Image> curves;
    for (const auto& path : logs) {
        try {
            curves.push_back(training_curves(path));
        } catch (const Error& error) { log::warning("no curves of {}: {}", path.string(), error.message()); }
    }
    if (!curves.empty()) write_png(model / "log/curves.png", stacked(curves));
    const auto loaded = pipeline::neural_api().load_model(model, {});
    write_png(model / "log/samples.png", sample_sheet(*loaded, job));
}

}  // namespace gse::training
