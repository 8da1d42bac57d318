// The gate: pictures before the loop.
#include "engine/pipeline/run/preview_check.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/io/image/image_file.h"

namespace gse::pipeline {
namespace {

constexpr int WrittenSide = 256;  // pictures of small models are enlarged to about this, pixel by pixel

/// The view at another size.
Camera resized_camera(const Camera& camera, int side) {
    Camera result = camera;
    const double scale_x = static_cast<double>(side) / camera.width,
                 scale_y = static_cast<double>(side) / camera.height;
    result.width = result.height = side;
    result.fx *= scale_x;
    result.cx *= scale_x;
    result.fy *= scale_y;
    result.cy *= scale_y;
    return result;
}

Image enlarged(const Image& image, int factor) {
    Image result(image.width * factor, image.height * factor, image.channels);
    for (int y = 0; y < result.height; ++y)
        for (int x = 0; x < result.width; ++x)
            for (int c = 0; c < image.channels; ++c) result.at(x, y, c) = image.at(x / factor, y / factor, c);
    return result;
}

/// Sets the request as the edit will make it, for a model that redraws pictures in a way of its own.
void ask_its_own_way(neural::SampleRequest& request, EditJob& job) {
    const auto kind = job.model().kind();
    if (kind == neural::BundleKind::Plain) return;
    const auto& recipe = job.recipe();
    request.steps = recipe.request.view_steps;
    request.strength = recipe.request.view_strength;
    request.guidance_scale = recipe.guidance.view_guidance_scale;
    request.image_guidance_scale = recipe.guidance.image_guidance_scale;
    if (kind == neural::BundleKind::InstructPix2Pix) request.prompt = told_to_editor(recipe.request);
}

}  // namespace

PreviewCheck look_through_gate(EditJob& job, const GateParameters& parameters) {
    job.times().begin("gate");
    PreviewCheck gate;
    const auto& views = job.views();
    const std::size_t count = std::min(views.size(), static_cast<std::size_t>(std::max(1, parameters.views)));
    for (std::size_t i = 0; i < count; ++i) {
        if (job.control().stop_requested())
            throw Error(ErrorCode::Cancelled, "the pictures before the edit were stopped");
        const std::size_t view = i * views.size() / count;
        const Camera camera = resized_camera(views[view].camera, job.model().image_size());
        const Image before = job.painter().paint(job.drawn().spans(), camera, job.render_settings()).colour;
        neural::SampleRequest request;
        request.prompt = job.model_prompt();
        if (!job.view_words().empty()) request.prompt += ", " + job.view_words()[view];
        request.steps = parameters.steps;
        request.guidance_scale = parameters.guidance_scale;
        request.strength = parameters.strength;
        ask_its_own_way(request, job);
        request.seed = job.recipe().request.seed + i;
        gate.pictures.push_back({view, before, job.model().img2img(before, request)});
        job.control().report("asking the model", static_cast<int>(i + 1), static_cast<int>(count));
    }
    std::vector<PicturePair> pairs;
    for (const auto& picture : gate.pictures) pairs.emplace_back(&picture.before, &picture.after);
    static_cast<EditQuality&>(gate) =
        judge(job.model(), job.recipe().request.sentence(), job.model_prompt(), pairs);
    if (gate.warns) log::warning("{}", gate.verdict);
    job.times().end();
    return gate;
}

void write_gate(const std::filesystem::path& folder, const PreviewCheck& gate) {
    for (std::size_t i = 0; i < gate.pictures.size(); ++i) {
        const auto& picture = gate.pictures[i];
        const int factor = std::max(1, WrittenSide / picture.before.width);
        write_png(folder / fmt::format("gate_{}.png", i),
                  side_by_side(enlarged(picture.before, factor), enlarged(picture.after, factor)));
    }
}

nlohmann::ordered_json gate_to_json(const PreviewCheck& gate) {
    auto json = verdict_to_json(gate);
    json["views"] = nlohmann::ordered_json::array();
    for (const auto& picture : gate.pictures) json["views"].push_back(picture.view);
    return json;
}

}  // namespace gse::pipeline
