// ComfyUI: upload, submit, look until done, fetch the picture, and leave nothing behind.
#include "engine/remote/protocols/comfy_server.h"

#include <algorithm>
#include <span>

#include <fmt/format.h>

#include "engine/base/content_hash.h"
#include "engine/base/json.h"
#include "engine/remote/api/server_settings.h"
#include "engine/remote/http/unique_id.h"
#include "engine/remote/picture/picture_codec.h"
#include "engine/remote/protocols/comfy_nodes.h"
#include "engine/remote/protocols/order_checks.h"
#include "engine/remote/protocols/server_error.h"
#include "engine/remote/protocols/server_loras.h"
#include "engine/remote/workflow/workflow_files.h"
#include "engine/remote/workflow/workflow_loras.h"
#include "engine/remote/workflow/workflow_options.h"

namespace gse::remote {
namespace {

constexpr std::size_t LongestJobId = 128, HistoryBytes = std::size_t{4} << 20;
constexpr const char* UploadFolder = "gse";

/// Name that two equal pictures share: the server caches by it.
std::string upload_name(const std::string& png) {
    ContentHash hash;
    hash.text(png);
    return "gse_" + hash.key().hex().substr(0, 16) + ".png";
}

/// Ends a job of ours, waiting or running. Old servers stop whatever runs: they are asked only while ours
/// does.
NextRequest cancel_request(const RequestMaker& requests, const std::string& id) {
    const nlohmann::json ours{{"prompt_id", id}};
    auto interrupt = [=](const HttpResult& queue) -> std::unique_ptr<NextRequest> {
        const auto json = try_parse_json(queue.answer.body);
        const auto& running = value_of(json, "queue_running");
        const bool runs =
            running.is_array() && std::any_of(running.begin(), running.end(), [&](const auto& item) {
                return item.is_array() && item.size() > 1 && item[1] == id;
            });
        if (!runs) return nullptr;
        return std::make_unique<NextRequest>(NextRequest{requests.post("/interrupt", ours)});
    };
    auto look = [=](const HttpResult&) {
        return std::make_unique<NextRequest>(NextRequest{requests.get("/queue"), interrupt});
    };
    auto remove = [=](const HttpResult& cancelled) -> std::unique_ptr<NextRequest> {
        if (cancelled.ok() && cancelled.answer.status == 200) return nullptr;
        return std::make_unique<NextRequest>(
            NextRequest{requests.post("/queue", {{"delete", nlohmann::json::array({id})}}), look});
    };
    return {requests.post("/api/jobs/" + percent_encoded(id) + "/cancel", nlohmann::json::object()), remove};
}

std::string prompt_id_of(const nlohmann::json& json) {
    const auto id = text_of(json, "prompt_id");
    return id.size() <= LongestJobId ? id : std::string();
}

/// Throws Error for a job that failed or was stopped.
void check_messages(const nlohmann::json& status, const ServerUrl& url) {
    const auto& messages = value_of(status, "messages");
    for (const auto& message : messages.is_array() ? messages : nlohmann::json::array()) {
        if (!message.is_array() || message.size() < 2 || !message[0].is_string()) continue;
        if (message[0] == "execution_interrupted")
            throw Error(ErrorCode::Foreign, fmt::format("{} was interrupted", url.nickname()),
                        "somebody stopped it there; ask again");
        if (message[0] == "execution_error")
            throw work_error(
                url, fmt::format("node {} {}: {}", text_of(message[1], "node_id"),
                                 text_of(message[1], "node_type"), text_of(message[1], "exception_message")));
    }
    if (text_of(status, "status_str") == "error") throw work_error(url, "");
}

/// Order with a mask and nothing else, as most are.
RedrawOrder usual_order() {
    RedrawOrder order;
    order.mask = Image(1, 1, 1, 1);
    return order;
}

/// Place of a job in a list of the queue; -1 = not in it.
int place_in(const nlohmann::json& list, const std::string& id) {
    if (!list.is_array()) return -1;
    for (std::size_t i = 0; i < list.size(); ++i)
        if (list[i].is_array() && list[i].size() > 1 && list[i][1] == id) return static_cast<int>(i);
    return -1;
}

}  // namespace

ComfyServer::ComfyServer(std::unique_ptr<ServerLink> link, const ServerAddress& address)
    : link_(std::move(link)), workflow_(address.workflow), wanted_model_(address.model),
      wanted_loras_(address.loras), options_(address.options), paid_nodes_(address.allow_paid_nodes),
      client_(unique_id()) {}

ServerFacts ComfyServer::probe(const JobControl& job) {
    const auto stats = link_->ask_json(link_->get("/system_stats"), {}, job);
    const auto version = text_of(value_of(stats, "system"), "comfyui_version");
    if (version.empty()) throw answer_error(link_->url(), "as no ComfyUI does");
    ServerFacts facts;
    facts.kind = ServerKind::Comfy;
    facts.product = "ComfyUI";
    facts.version = shown(version);
    facts.cancels = true;
    facts.references = 1;
    facts.models = offered_names(*link_, "CheckpointLoaderSimple", "ckpt_name", job);
    const auto unets = offered_names(*link_, "UNETLoader", "unet_name", job);
    choose_bundled(facts.models, unets);
    facts.models.insert(facts.models.end(), unets.begin(), unets.end());
    facts.loras = offered_names(*link_, "LoraLoader", "lora_name", job);
    choose_loras(facts.loras);
    if (!is_bundled()) {
        const auto& workflow = workflow_for({}, job);
        facts.references = workflow.count(WorkflowRole::Reference);
        facts.takes_mask = workflow.find(WorkflowRole::Mask) != nullptr || workflow.mask_in_alpha;
        facts.repeats = workflow.find(WorkflowRole::Seed) != nullptr;
        facts.notes = workflow.table();
        facts.model = model_;
    } else {
        auto fits = load_workflow(bundled_workflow_for(usual_order(), bundled_));
        set_inputs(fits, options_);  // said before the first picture
        if (facts.models.size() == 1) facts.model = facts.models[0];
    }
    if (!wanted_model_.empty()) facts.model = wanted_model_;
    return facts_ = facts;
}

bool ComfyServer::is_bundled() const { return workflow_.empty() || is_bundled_workflow(workflow_.string()); }

/// Models that edit come without text encoder and autoencoder: another node loads them than checkpoints.
void ComfyServer::choose_bundled(const std::vector<std::string>& checkpoints,
                                 const std::vector<std::string>& unets) {
    bundled_ = is_bundled() ? workflow_.string() : std::string();
    if (!workflow_.empty()) return;
    const auto has = [&](const auto& names) {
        return std::find(names.begin(), names.end(), wanted_model_) != names.end();
    };
    const bool edits =
        wanted_model_.empty() ? checkpoints.empty() && !unets.empty() : has(unets) && !has(checkpoints);
    if (edits) bundled_ = "edit";
}

void ComfyServer::choose_loras(const std::vector<std::string>& names) {
    std::vector<OfferedLora> offered;
    for (const auto& name : names) offered.push_back({name, name});
    loras_.clear();
    for (const auto& lora : chosen_loras(wanted_loras_, offered, link_->url()))
        loras_.emplace_back(lora.name, lora.weight);
}

const Workflow& ComfyServer::workflow_for(const RedrawOrder& order, const JobControl& job) {
    const auto name = is_bundled() ? bundled_workflow_for(order, bundled_) : workflow_.string();
    if (loaded_ && loaded_name_ == name) return *loaded_;
    auto workflow = load_workflow(name);
    set_inputs(workflow, options_);
    add_lora_loaders(workflow, loras_);
    model_ = check_nodes(*link_, workflow, wanted_model_, paid_nodes_, job);
    loaded_name_ = name;
    loaded_ = std::move(workflow);
    return *loaded_;
}

std::string ComfyServer::upload(const std::string& png, const JobControl& job) {
    std::vector<HttpPart> parts{{"image", png, upload_name(png), "image/png"},
                                {"type", upload_type_},
                                {"overwrite", "true"},
                                {"subfolder", UploadFolder}};
    const auto json =
        link_->ask_json(link_->requests().post_parts("/upload/image", std::move(parts)), {}, job);
    const auto name = text_of(json, "name"), folder = text_of(json, "subfolder"),
               type = text_of(json, "type");
    if (name.empty()) throw answer_error(link_->url(), "without the name of an uploaded picture");
    const auto path = folder.empty() ? name : folder + "/" + name;
    return type == "input" || type.empty() ? path : path + " [" + type + "]";
}

WorkflowValues ComfyServer::uploaded(const RedrawOrder& order, const Workflow& workflow,
                                     const JobControl& job) {
    WorkflowValues values;
    Image mask = order.mask;
    if (mask.data.empty()) mask = Image(order.picture.width, order.picture.height, 1, 1);
    values.image = upload(
        workflow.mask_in_alpha ? picture_with_mask_png(order.picture, mask) : picture_png(order.picture),
        job);
    if (workflow.find(WorkflowRole::Mask)) values.mask = upload(mask_png(mask), job);
    for (const auto& reference : order.references)
        values.references.push_back(upload(picture_png(reference), job));
    values.prompt = order.prompt;
    values.negative_prompt = order.negative_prompt;
    values.seed = order.seed;
    values.strength = order.strength;
    values.steps = order.steps;  // KSampler runs as many at the end of a longer schedule
    values.guidance_scale = order.guidance_scale;
    values.distilled_guidance = order.distilled_guidance;
    values.width = order.picture.width;
    values.height = order.picture.height;
    values.model = model_;
    return values;
}

std::string ComfyServer::submit(const nlohmann::json& graph, const JobControl& job) {
    const auto own_id = unique_id();
    Ask how;
    how.repeat = Repeat::UnlessStarted;
    how.after_stop = [requests = link_->requests(), own_id](const HttpResult& result) {
        const auto id = prompt_id_of(try_parse_json(result.answer.body));
        return std::make_unique<NextRequest>(cancel_request(requests, id.empty() ? own_id : id));
    };
    const nlohmann::json body{{"prompt", graph}, {"client_id", client_}, {"prompt_id", own_id}};
    const auto answer = link_->ask_any_status(link_->requests().post("/prompt", body), how, job);
    const auto json = try_parse_json(answer.body);
    if (const auto words = node_errors(json); !words.empty())
        throw Error(ErrorCode::InvalidArgument,
                    fmt::format("{} refuses the workflow: {}", link_->url().nickname(), words),
                    "change the workflow there and export it again");
    if (answer.status != 200) throw status_error(answer, link_->url(), link_->requests().has_secret());
    const auto id = prompt_id_of(link_->json_of(answer));
    if (id.empty()) throw answer_error(link_->url(), "without the number of a job");
    return id;
}

bool ComfyServer::is_queued(const std::string& id, const JobControl& job) {
    Ask how;
    how.most_bytes = HistoryBytes;
    const auto json = link_->ask_json(link_->get("/queue"), how, job);
    if (place_in(value_of(json, "queue_running"), id) >= 0) {
        job.report(DrawingStage, 0, 0);
        return true;
    }
    const int place = place_in(value_of(json, "queue_pending"), id);
    if (place >= 0) job.report("waiting in the server's queue", place + 1, 0);
    return place >= 0;
}

nlohmann::json ComfyServer::wait_for_job(const std::string& id, const JobControl& job) {
    Ask how;
    how.most_bytes = HistoryBytes;
    for (int missed = 0;;) {
        const auto json = link_->ask_json(link_->get("/history/" + percent_encoded(id)), how, job);
        const auto& entry = value_of(json, id.c_str());
        if (entry.is_object()) {
            check_messages(value_of(entry, "status"), link_->url());
            return value_of(entry, "outputs");
        }
        if (!json.is_object() || !json.empty()) throw answer_error(link_->url(), "about another job");
        missed = is_queued(id, job) ? 0 : missed + 1;
        if (missed > 2) return nullptr;
        wait_stoppable(job.stop, missed > 0 ? link_->times().slow_poll : 2 * link_->times().poll);
    }
}

Image ComfyServer::picture_of(const nlohmann::json& outputs, const std::string& node,
                              const RedrawOrder& order, const JobControl& job) {
    const auto& images = value_of(value_of(outputs, node.c_str()), "images");
    const auto name = images.is_array() && !images.empty() ? text_of(images[0], "filename") : std::string();
    if (name.empty()) throw answer_error(link_->url(), "without a picture");
    const auto place = fmt::format("/view?filename={}&subfolder={}&type={}", percent_encoded(name),
                                   percent_encoded(text_of(images[0], "subfolder")),
                                   percent_encoded(text_of(images[0], "type")));
    Ask how;
    how.most_bytes = picture_answer_bytes(order, 0);
    const auto answer = link_->ask(link_->get(place), how, job);
    return received_picture(std::as_bytes(std::span(answer.body)), order.picture);
}

std::string ComfyServer::send(const RedrawOrder& order, const Workflow& workflow, const JobControl& job) {
    job.report("sending the picture", 0, 0);
    try {
        return submit(filled_workflow(workflow, uploaded(order, workflow, job)), job);
    } catch (const Error& error) {
        const bool wants_input = error.message().find("[temp]") != std::string::npos;
        if (!wants_input || upload_type_ == "input") throw;
    }
    upload_type_ = "input";  // for loaders that know no other folder
    return submit(filled_workflow(workflow, uploaded(order, workflow, job)), job);
}

RedrawnPicture ComfyServer::redraw(const RedrawOrder& order, const JobControl& job) {
    check_order(order, facts_);
    if (leaves_nothing(order)) return {order.picture, facts_.model};
    const auto& workflow = workflow_for(order, job);
    if (order.references.size() != workflow.count(WorkflowRole::Reference))
        throw Error(ErrorCode::InvalidArgument,
                    fmt::format("the workflow takes {} references, not {}",
                                workflow.count(WorkflowRole::Reference), order.references.size()),
                    "give as many as it has");
    for (int attempt = 0; attempt < 2; ++attempt) {
        const auto id = send(order, workflow, job);
        try {
            const auto outputs = wait_for_job(id, job);
            if (outputs.is_null()) continue;
            auto picture = picture_of(outputs, workflow.find(WorkflowRole::Output)->node, order, job);
            link_->send_later(link_->requests().post("/history", {{"delete", nlohmann::json::array({id})}}));
            return {std::move(picture), model_};
        } catch (const Error& error) {
            if (error.code() == ErrorCode::Cancelled) {
                auto cancel = cancel_request(link_->requests(), id);
                link_->send_later(std::move(cancel.request), std::move(cancel.then));
            }
            throw;
        }
    }
    throw Error(ErrorCode::Foreign, fmt::format("{} forgets its jobs", link_->url().nickname()),
                "look whether it is being restarted");
}

}  // namespace gse::remote
