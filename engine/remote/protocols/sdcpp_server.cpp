// sd-server's jobs: ask, look until done, take the picture. A job's number survives a lost connection.
#include "engine/remote/protocols/sdcpp_server.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <span>

#include <fmt/format.h>

#include "engine/base/json.h"
#include "engine/remote/picture/base64.h"
#include "engine/remote/picture/picture_codec.h"
#include "engine/remote/protocols/order_checks.h"
#include "engine/remote/protocols/request_options.h"
#include "engine/remote/protocols/server_error.h"

namespace gse::remote {
namespace {

constexpr std::size_t MostReferences = 4, LongestId = 128, CapabilityBytes = std::size_t{4} << 20;
constexpr std::chrono::seconds QuickPolls{10};
constexpr double LongestQueue = 1e6;

std::string in_base64(const std::string& file) { return base64_encoded(std::as_bytes(std::span(file))); }

std::string job_place(const std::string& id) { return "/sdcpp/v1/jobs/" + percent_encoded(id); }

/// Number of a job in an answer to a submission; empty without a usable one.
std::string job_id(const nlohmann::json& json) {
    const auto id = text_of(json, "id");
    return id.size() <= LongestId ? id : std::string();
}

}  // namespace

int steps_to_ask_of_levels(int real, double strength) {
    if (strength >= 1) return real;
    return std::max(1, static_cast<int>(std::ceil((real - 1) / strength - 1e-9)));
}

std::string sdcpp_sampler(std::string_view name) {
    std::string known(name);
    for (char& c : known) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return known;
}

nlohmann::json sdcpp_body(const RedrawOrder& order) {
    nlohmann::json guidance{{"txt_cfg", order.guidance_scale}};
    if (order.distilled_guidance > 0) guidance["distilled_guidance"] = order.distilled_guidance;
    nlohmann::json sampling{{"sample_steps", steps_to_ask_of_levels(order.steps, order.strength)},
                            {"guidance", guidance}};
    if (!order.sampler.empty()) sampling["sample_method"] = sdcpp_sampler(order.sampler);
    nlohmann::json body{{"prompt", order.prompt},
                        {"negative_prompt", order.negative_prompt},
                        {"width", order.picture.width},
                        {"height", order.picture.height},
                        {"seed", order.seed},
                        {"strength", order.strength},
                        {"batch_count", 1},
                        {"embed_image_metadata", false},
                        {"output_format", "png"},
                        {"init_image", in_base64(picture_png(order.picture))},
                        {"sample_params", sampling}};
    if (!order.mask.data.empty()) body["mask_image"] = in_base64(mask_png(order.mask));
    for (const auto& reference : order.references)
        body["ref_images"].push_back(in_base64(picture_png(reference)));
    return body;
}

ServerFacts SdCppServer::probe(const JobControl& job) {
    check_sdcpp_options(options_, link_->url());
    Ask how;
    how.most_bytes = CapabilityBytes;
    const auto json = link_->ask_json(link_->get("/sdcpp/v1/capabilities"), how, job);
    if (!json.is_object()) throw answer_error(link_->url(), "as no sd-server does");
    for (const auto& [name, list] : {std::pair{"sample_params.sample_method", "samplers"},
                                     std::pair{"sample_params.scheduler", "schedulers"}})
        check_offered_value(options_, name, texts_of(value_of(json, list), nullptr), link_->url());
    const auto& model = value_of(json, "model");
    const auto& by_mode = value_of(value_of(json, "features_by_mode"), "img_gen");
    const auto& features = by_mode.is_object() ? by_mode : value_of(json, "features");  // older builds
    ServerFacts facts;
    facts.kind = ServerKind::SdCpp;
    facts.product = "sd-server";
    facts.model = shown(text_of(model, "name").empty() ? text_of(model, "stem") : text_of(model, "name"));
    check_only_model(link_->url(), wanted_model_, facts.model);
    const auto offered = offered_loras(value_of(json, "loras"));
    facts.loras = names_of(offered);
    if (!value_of(json, "loras").is_array()) facts.lora_names = LoraNames::Any;
    loras_ = named_loras(wanted_loras_, offered, facts.lora_names, link_->url());
    facts.references = value_of(features, "ref_images") == false ? 0 : MostReferences;
    facts.takes_mask = value_of(features, "mask_image") != false;
    facts.cancels = value_of(features, "cancel_queued") != false;
    return facts_ = facts;
}

std::string SdCppServer::submit(const nlohmann::json& body, const JobControl& job) {
    Ask how;
    how.repeat = Repeat::UnlessStarted;
    how.after_stop = [requests =
                          link_->requests()](const HttpResult& result) -> std::unique_ptr<NextRequest> {
        const auto id = job_id(try_parse_json(result.answer.body));
        if (!result.ok() || id.empty()) return nullptr;
        return std::make_unique<NextRequest>(
            NextRequest{requests.post(job_place(id) + "/cancel", nlohmann::json::object())});
    };
    const auto json = link_->ask_json(link_->requests().post("/sdcpp/v1/img_gen", body), how, job);
    const auto id = job_id(json);
    if (id.empty()) throw answer_error(link_->url(), "without the number of a job");
    return id;
}

nlohmann::json SdCppServer::wait_for_job(const std::string& id, std::size_t most_bytes,
                                         const JobControl& job) {
    const auto begin = std::chrono::steady_clock::now();
    Ask how;
    how.most_bytes = most_bytes;
    while (true) {
        const auto answer = link_->ask_any_status(link_->get(job_place(id)), how, job);
        if (answer.status == 404) return nullptr;
        if (answer.status == 410)
            throw Error(ErrorCode::Foreign,
                        fmt::format("{} has thrown the picture away already", link_->url().nickname()),
                        "ask again");
        if (answer.status != 200) throw status_error(answer, link_->url(), false);
        auto json = link_->json_of(answer);
        const auto status = text_of(json, "status");
        if (status == "completed") return json;
        if (status == "failed") throw work_error(link_->url(), server_words(answer));
        if (status == "cancelled")
            throw Error(ErrorCode::Foreign, fmt::format("{} cancelled the job", link_->url().nickname()),
                        "somebody stopped it there; ask again");
        if (status != "queued" && status != "generating")
            throw answer_error(link_->url(),
                               fmt::format("with an unknown state of the job (\"{}\")", shown(status)));
        if (status == "queued")
            job.report("waiting in the server's queue",
                       static_cast<int>(number_of(json, "queue_position", 0, LongestQueue, 0)), 0);
        else job.report(DrawingStage, 0, 0);
        const bool quick = std::chrono::steady_clock::now() - begin < QuickPolls;
        wait_stoppable(job.stop, quick ? link_->times().poll : link_->times().slow_poll);
    }
}

RedrawnPicture SdCppServer::redraw(const RedrawOrder& order, const JobControl& job) {
    check_order(order, facts_);
    if (leaves_nothing(order)) return {order.picture, facts_.model};
    auto body = sdcpp_body(order);
    if (!loras_.empty()) body["lora"] = lora_list(loras_);
    add_options(body, options_);
    nlohmann::json done;
    for (int attempt = 0; attempt < 2 && done.is_null(); ++attempt) {
        if (attempt > 0) probe(job);  // it was started again, perhaps with another model
        const auto id = submit(body, job);
        try {
            done = wait_for_job(id, picture_answer_bytes(order, 0), job);
        } catch (const Error& error) {
            if (error.code() == ErrorCode::Cancelled)
                link_->send_later(
                    link_->requests().post(job_place(id) + "/cancel", nlohmann::json::object()));
            throw;
        }
    }
    if (done.is_null())
        throw Error(ErrorCode::Foreign, fmt::format("{} forgets its jobs", link_->url().nickname()),
                    "look whether it is being restarted");
    const auto& images = value_of(value_of(done, "result"), "images");
    const auto picture =
        images.is_array() && !images.empty() ? text_of(images[0], "b64_json") : std::string();
    if (picture.empty()) throw answer_error(link_->url(), "without a picture");
    return {received_picture(picture, order.picture), facts_.model};
}

}  // namespace gse::remote
