// WebUI servers: one request per picture, which is answered when it is drawn.
#include "engine/remote/protocols/webui_server.h"

#include <algorithm>

#include <fmt/format.h>

#include "engine/base/json.h"
#include "engine/base/log.h"
#include "engine/remote/http/unique_id.h"
#include "engine/remote/picture/picture_codec.h"
#include "engine/remote/protocols/order_checks.h"
#include "engine/remote/protocols/request_options.h"
#include "engine/remote/protocols/server_error.h"
#include "engine/remote/protocols/webui_progress.h"

namespace gse::remote {
namespace {

constexpr std::size_t ListBytes = std::size_t{4} << 20;
constexpr std::size_t LoraBytes = std::size_t{64} << 20;  // with all that was noted when they were trained
constexpr std::size_t EchoedPictures = 2;                 // sd-server sends picture and mask back

Ask list_ask() {
    Ask how;
    how.most_bytes = ListBytes;
    return how;
}

/// The text of the one picture of an answer.
std::string picture_text(const nlohmann::json& answer, const ServerUrl& url) {
    const auto& images = value_of(answer, "images");
    if (!images.is_array() || images.empty()) throw answer_error(url, "without a picture");
    if (!images[0].is_string()) throw answer_error(url, "with a picture that is no text");
    if (images[0].get_ref<const std::string&>().empty())
        throw Error(ErrorCode::Foreign, fmt::format("{} drew nothing", url.nickname()),
                    "the server's own messages say more");
    return images[0].get<std::string>();
}

}  // namespace

ServerFacts WebuiServer::probe(const JobControl& job) {
    check_webui_options(options_, product_, link_->url());
    ServerFacts facts;
    facts.kind = ServerKind::Webui;
    facts.product = webui_product_name(product_);
    facts.references = webui_references(product_);
    facts.cancels = webui_has_tasks(product_);
    facts.reports_progress = product_ != WebuiProduct::SdServer && product_ != WebuiProduct::KoboldCpp;
    facts.shows_previews = facts.reports_progress;
    read_models(facts, job);
    switch_model(facts, job);
    return facts_ = facts;
}

void WebuiServer::read_models(ServerFacts& facts, const JobControl& job) {
    const auto list = link_->ask_any_status(link_->get("/sdapi/v1/sd-models"), list_ask(), job);
    if (list.status == 401 || list.status == 403 || (list.status >= 300 && list.status < 400))
        throw status_error(list, link_->url(), link_->requests().has_secret());
    if (list.status != 200 && product_ == WebuiProduct::Other)
        throw status_error(list, link_->url(), link_->requests().has_secret());
    if (list.status == 200) {
        facts.models = texts_of(link_->json_of(list), "title");
        if (facts.models.size() == 1) facts.model = facts.models[0];
    }
    if (const auto options = link_->try_json(link_->get("/sdapi/v1/options"), job))
        if (const auto model = text_of(*options, "sd_model_checkpoint"); !model.empty()) facts.model = model;
    std::vector<OfferedLora> offered;
    const auto loras = link_->try_json(link_->get("/sdapi/v1/loras"), job, LoraBytes);
    if (loras && loras->is_array()) offered = offered_loras(*loras);
    else facts.lora_names = LoraNames::Any;
    facts.loras = names_of(offered);
    loras_ = named_loras(wanted_loras_, offered, facts.lora_names, link_->url());
    if (product_ == WebuiProduct::SdNext)
        if (const auto version = link_->try_json(link_->get("/sdapi/v1/version"), job))
            facts.version = shown(text_of(*version, "version"));
}

void WebuiServer::switch_model(ServerFacts& facts, const JobControl& job) {
    if (wanted_model_.empty() || wanted_model_ == facts.model) return;
    if (product_ == WebuiProduct::SdServer || product_ == WebuiProduct::KoboldCpp)
        check_only_model(link_->url(), wanted_model_, facts.model);
    const auto known = std::find_if(facts.models.begin(), facts.models.end(), [&](const auto& title) {
        return title == wanted_model_ || title.starts_with(wanted_model_ + " ") ||
               title.starts_with(wanted_model_ + ".");
    });
    if (known == facts.models.end())
        throw Error(ErrorCode::InvalidArgument,
                    fmt::format("{} has no model \"{}\"", link_->url().nickname(), shown(wanted_model_)),
                    "the server's list of models names those it has");
    if (*known == facts.model) return;
    job.report("the server loads the model", 0, 0);
    Ask how;
    how.repeat = Repeat::UnlessStarted;
    how.draws = true;  // it answers when the model is loaded
    if (product_ == WebuiProduct::SdNext)
        link_->ask(
            link_->requests().post("/sdapi/v1/checkpoint?sd_model_checkpoint=" + percent_encoded(*known),
                                   nlohmann::json::object()),
            how, job);
    else link_->ask(link_->requests().post("/sdapi/v1/options", {{"sd_model_checkpoint", *known}}), how, job);
    facts.model = *known;
}

void WebuiServer::stop_task(const std::string& task) {
    if (!webui_has_tasks(product_)) return;
    // Interrupting stops whatever runs: only where that is ours.
    auto interrupt = [requests =
                          link_->requests()](const HttpResult& result) -> std::unique_ptr<NextRequest> {
        if (!result.ok() || result.answer.status != 200) return nullptr;
        if (value_of(try_parse_json(result.answer.body), "active") != true) return nullptr;
        return std::make_unique<NextRequest>(
            NextRequest{requests.post("/sdapi/v1/interrupt", nlohmann::json::object())});
    };
    link_->send_later(link_->requests().post("/internal/progress", webui_task_body(task)), interrupt);
}

RedrawnPicture WebuiServer::redraw(const RedrawOrder& order, const JobControl& job) {
    check_order(order, facts_);
    if (leaves_nothing(order)) return {order.picture, facts_.model};
    const auto task = fmt::format("task(gse-{})", unique_id());
    Ask how;
    how.repeat = Repeat::UnlessStarted;
    how.draws = true;
    how.most_bytes = picture_answer_bytes(order, EchoedPictures);
    WebuiProgress progress(*link_, product_, task, order);
    how.meanwhile = [&] {
        if (facts_.reports_progress) progress.look(job);
        else job.report(DrawingStage, 0, 0);
    };
    job.report(DrawingStage, 0, 0);
    try {
        auto body = webui_body(order, product_, task);
        if (!loras_.empty() && webui_lists_loras(product_)) body["lora"] = lora_list(loras_);
        else body["prompt"] = prompt_with_loras(order.prompt, loras_);
        add_options(body, options_);
        const auto request = link_->requests().post("/sdapi/v1/img2img", body);
        const auto json = link_->ask_json(request, how, job);
        const auto model = webui_model(json);
        return {received_picture(picture_text(json, link_->url()), order.picture),
                model.empty() ? facts_.model : shown(model)};
    } catch (const Error& error) {
        if (error.code() == ErrorCode::Cancelled) stop_task(task);
        throw;
    }
}

}  // namespace gse::remote
