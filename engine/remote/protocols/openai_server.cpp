// OpenAI's picture edits: one form per picture, answered when it is drawn. The standard knows no seed.
#include "engine/remote/protocols/openai_server.h"

#include <algorithm>

#include "engine/remote/picture/picture_codec.h"
#include "engine/remote/protocols/order_checks.h"
#include "engine/remote/protocols/request_options.h"
#include "engine/remote/protocols/server_error.h"

namespace gse::remote {
namespace {

constexpr std::size_t ModelListBytes = std::size_t{4} << 20;
constexpr std::size_t MostPictures = 4;

OpenAiProduct product_of(ServerLink& link, const nlohmann::json& models, const JobControl& job) {
    if (const auto jobs = link.look("/sdcpp/v1/capabilities", job); jobs && jobs->is_object())
        return OpenAiProduct::SdServer;
    const auto owners = texts_of(value_of(models, "data"), "owned_by");
    const auto owned_by = [&](const char* name) {
        return std::find(owners.begin(), owners.end(), name) != owners.end();
    };
    if (owned_by("vllm")) return OpenAiProduct::Vllm;
    if (link.url().host == "api.openai.com" || owned_by("openai")) return OpenAiProduct::OpenAi;
    return OpenAiProduct::Other;
}

std::string picture_in(const nlohmann::json& answer, const ServerUrl& url) {
    const auto& data = value_of(answer, "data");
    if (!data.is_array() || data.empty()) throw answer_error(url, "without a picture");
    auto picture = text_of(data[0], "b64_json");
    if (!picture.empty()) return picture;
    if (!text_of(data[0], "url").empty())
        throw answer_error(url, "with the address of a picture instead of a picture");
    throw answer_error(url, "without a picture");
}

}  // namespace

ServerFacts OpenAiServer::probe(const JobControl& job) {
    Ask how;
    how.most_bytes = ModelListBytes;
    const auto models = link_->ask_json(link_->get("/v1/models"), how, job);
    if (!value_of(models, "data").is_array()) throw answer_error(link_->url(), "without a list of models");
    product_ = product_of(*link_, models, job);
    check_openai_options(options_, product_, link_->url());
    ServerFacts facts;
    choose_loras(facts, job);
    facts.kind = ServerKind::OpenAi;
    facts.product = openai_product_name(product_);
    facts.models = texts_of(value_of(models, "data"), "id");
    if (!wanted_model_.empty()) facts.model = wanted_model_;
    else if (facts.models.size() == 1) facts.model = facts.models[0];
    if (!facts.models.empty() && !facts.model.empty() &&
        std::find(facts.models.begin(), facts.models.end(), facts.model) == facts.models.end())
        throw Error(ErrorCode::InvalidArgument,
                    link_->url().nickname() + " has no model \"" + shown(facts.model) + "\"",
                    "the server's list of models names those it has");
    facts.references = MostPictures - 1;
    facts.repeats = product_ == OpenAiProduct::SdServer || product_ == OpenAiProduct::Vllm;
    return facts_ = facts;
}

/// The standard has none, but sd-server and vLLM-Omni take them. The latter has no list. Others may be it
/// under another name.
void OpenAiServer::choose_loras(ServerFacts& facts, const JobControl& job) {
    std::vector<OfferedLora> offered;
    facts.lora_names = product_ == OpenAiProduct::OpenAi ? LoraNames::None : LoraNames::Any;
    if (product_ == OpenAiProduct::SdServer)
        if (const auto json = link_->look("/sdcpp/v1/capabilities", job);
            json && value_of(*json, "loras").is_array()) {
            offered = offered_loras(value_of(*json, "loras"));
            facts.lora_names = LoraNames::Listed;
        }
    facts.loras = names_of(offered);
    loras_ = named_loras(wanted_loras_, offered, facts.lora_names, link_->url());
    if (product_ == OpenAiProduct::Other && !loras_.empty())
        facts.notes.emplace_back(
            "It does not say whether it takes LoRAs. They are sent as vLLM-Omni takes "
            "them, and one that is passed over changes nothing.");
}

RedrawnPicture OpenAiServer::redraw(const RedrawOrder& order, const JobControl& job) {
    check_order(order, facts_);
    if (leaves_nothing(order)) return {order.picture, facts_.model};
    Ask how;
    how.repeat = Repeat::UnlessStarted;
    how.draws = true;
    how.most_bytes = picture_answer_bytes(order, 0);
    how.meanwhile = [&] { job.report(DrawingStage, 0, 0); };
    how.meanwhile();
    const auto request = link_->requests().post_parts(
        "/v1/images/edits", openai_parts(order, product_, facts_.model, {loras_, options_}));
    const auto json = link_->ask_json(request, how, job);
    return {received_picture(picture_in(json, link_->url()), order.picture), facts_.model};
}

}  // namespace gse::remote
