// One located scene, edited by each way and seed.
#include "engine/laboratory/bench/server_bench.h"

#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "engine/base/clock.h"
#include "engine/base/error.h"
#include "engine/io/project/load_scene.h"
#include "engine/laboratory/bench/inconsistent_server.h"
#include "engine/pipeline/run/edit_job.h"
#include "engine/remote/views/picture_source.h"

namespace gse::bench {
namespace {

using pipeline::EditJob;

struct Way {
    const char *name, *agreement, *model;
    int rounds;
};

constexpr std::array<Way, 8> Ways{{{"none", "none", "sd-v1-5", 1},
                                   {"sheet", "sheet", "flux1-kontext", 1},
                                   {"reference", "reference", "flux2-klein", 1},
                                   {"warp", "warp", "sd-v1-5-inpainting", 1},
                                   {"none, second round", "none", "sd-v1-5", 2},
                                   {"sheet, second round", "sheet", "flux1-kontext", 2},
                                   {"reference, second round", "reference", "flux2-klein", 2},
                                   {"warp, second round", "warp", "sd-v1-5-inpainting", 2}}};

constexpr float Covered = 0.95f;  // share of a pixel that the label covers, to count

double psnr_to_truth(EditJob& job) {
    const auto& bits = *job.located().label.bits;
    const std::vector<float> values(bits.begin(), bits.end());
    const auto settings = job.render_settings();
    double squares = 0, count = 0;
    for (const auto& view : job.views()) {
        Image covered;
        job.painter().rasterizer().forward_values(job.drawn().spans(), view.camera, settings, values,
                                                  covered);
        const Image truth =
            painted_truth(job.painter().paint(job.drawn().spans(), view.camera, settings).colour);
        const auto& after = job.painter().paint(job.drawn_result().spans(), view.camera, settings).colour;
        for (std::size_t i = 0; i < covered.data.size(); ++i) {
            if (covered.data[i] < Covered) continue;
            for (std::size_t c = 0; c < 3; ++c) {
                const double difference = after.data[i * 3 + c] - truth.data[i * 3 + c];
                squares += difference * difference, count += 1;
            }
        }
    }
    return squares > 0 ? -10 * std::log10(squares / count) : 99;
}

pipeline::EditRecipe recipe_of(const Way& way, int side, int seed) {
    pipeline::EditRecipe recipe;
    recipe.request.source = "bear";
    recipe.request.prompt = "a blue bear";
    recipe.request.target = "blue";
    recipe.request.seed = static_cast<std::uint64_t>(seed);
    recipe.request.rounds = way.rounds;
    recipe.server.url = "http://in-process";
    recipe.server.agreement = way.agreement;
    recipe.server.side = side;
    return recipe;
}

/// Adds the figures of one edit to those of its way.
void measure(const Way& way, const Scene& scene, const std::shared_ptr<neural::TextToImage>& model,
             const ServerBenchParameters& parameters, int seed, const JobControl& control,
             AgreementFigures& figures) {
    const auto recipe = recipe_of(way, parameters.side, seed);
    const Inconsistency amounts{parameters.hue, parameters.texture, parameters.outline};
    pipeline::EditJobInput input;
    input.scene = scene;
    input.model = model;
    input.server = std::make_shared<pipeline::ViewServer>(
        std::make_shared<InconsistentServer>(amounts, way.model), recipe.server, nullptr, control);
    EditJob job(recipe, std::move(input), control);
    job.locate();
    if (!job.found()) throw Error(ErrorCode::NotFound, job.located().message);
    const double begin = wall_seconds();
    job.run();
    figures.seconds += wall_seconds() - begin;
    figures.psnr += psnr_to_truth(job);
    for (const auto& record : job.result().history)
        if (const auto found = record.guidance.find("rejected"); found != record.guidance.end()) {
            figures.rejected += found->second;
            figures.disagreement += record.guidance.at("disagreement") / way.rounds;
        }
    figures.requests += static_cast<double>(job.server()->use().requests);
    figures.megapixels += job.server()->use().megapixels;
}

}  // namespace

std::vector<AgreementFigures> bench_server(const std::filesystem::path& path,
                                           const ServerBenchParameters& parameters, const JobControl& job) {
    const Scene scene = load_scene(path);
    const auto model = pipeline::load_recipe_model({});
    std::vector<AgreementFigures> rows;
    for (const auto& way : Ways) {
        AgreementFigures figures{way.name};
        for (int seed = 1; seed <= parameters.seeds; ++seed)
            measure(way, scene, model, parameters, seed, job, figures);
        for (auto* sum : {&figures.disagreement, &figures.psnr, &figures.rejected, &figures.requests,
                          &figures.megapixels, &figures.seconds})
            *sum /= parameters.seeds;
        rows.push_back(figures);
    }
    return rows;
}

std::string agreement_text(const std::vector<AgreementFigures>& rows) {
    std::string text = fmt::format("{:<26}{:>13}{:>9}{:>10}{:>10}{:>8}{:>8}\n", "agreement", "disagreement",
                                   "PSNR", "rejected", "requests", "MP", "s");
    for (const auto& row : rows)
        text +=
            fmt::format("{:<26}{:>13.4f}{:>9.2f}{:>10.1f}{:>10.1f}{:>8.2f}{:>8.1f}\n", row.name,
                        row.disagreement, row.psnr, row.rejected, row.requests, row.megapixels, row.seconds);
    return text;
}

nlohmann::ordered_json agreement_json(const std::vector<AgreementFigures>& rows) {
    auto json = nlohmann::ordered_json::array();
    for (const auto& row : rows)
        json.push_back({{"agreement", row.name},
                        {"disagreement", row.disagreement},
                        {"psnr_db", row.psnr},
                        {"rejected", row.rejected},
                        {"requests", row.requests},
                        {"megapixels", row.megapixels},
                        {"seconds", row.seconds}});
    return json;
}

}  // namespace gse::bench
