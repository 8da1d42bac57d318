// Families, orders and reports of a run's server.
#include "engine/pipeline/models/view_server.h"

#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "engine/base/content_hash.h"
#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/log.h"
#include "engine/base/printable.h"
#include "engine/pipeline/models/remote_loader.h"
#include "engine/pipeline/models/server_instruction.h"
#include "engine/pipeline/recipe/target_pictures.h"
#include "engine/remote/api/server_kind.h"
#include "engine/remote/api/server_url.h"
#include "engine/remote/views/difference_source.h"
#include "engine/remote/views/picture_source.h"
#include "engine/remote/views/remote_view_editor.h"
#include "engine/remote/views/view_frame.h"

namespace gse::pipeline {
namespace {

/// The family that the settings name, or that of the model, with the numbers of the settings.
remote::ModelFamily family_for(const remote::ServerSettings& settings, const remote::ServerFacts& facts) {
    // A model behind OpenAI's protocol edits by instructions, unless its name tells otherwise.
    const auto otherwise = facts.kind == remote::ServerKind::OpenAi ? "editor" : "sd15";
    const auto& model = settings.model.empty() ? facts.model : settings.model;
    auto family = settings.family == "auto" ? remote::family_of(model, otherwise)
                                            : remote::family_named(settings.family);
    if (settings.steps > 0) family.steps = settings.steps;
    if (settings.guidance > 0) family.guidance_scale = settings.guidance;
    if (settings.strength > 0) family.strength = settings.strength;
    return family;
}

/// Takes the views of the first round in place of drawing them.
class HandedOutViews final : public edit::MultiViewEditor {
public:
    explicit HandedOutViews(std::vector<edit::EditView>& views) : views_(views) {}
    edit::EditedViews edit(const std::vector<edit::EditView>& views, const edit::EditViewsRequest&,
                           const JobControl&) override {
        views_ = views;
        throw Error(ErrorCode::Cancelled, "the views are handed out");
    }
    bool agrees_on_colour() const override { return true; }  // no view is drawn before the others

private:
    std::vector<edit::EditView>& views_;
};

/// Inputs of the pictures that no order holds.
std::string identity_of(const remote::ServerSettings& settings) {
    ContentHash hash;
    hash.text(settings.model);
    hash.texts(settings.lora);
    hash.texts(settings.option);
    const auto& workflow = settings.workflow;
    if (!workflow.empty()) hash.text(remote::is_bundled_workflow(workflow) ? workflow : read_file(workflow));
    return hash.key().hex();
}

}  // namespace

ViewServer::ViewServer(std::shared_ptr<remote::ImageServer> server, const remote::ServerSettings& settings,
                       std::shared_ptr<AnswerCache> cache, const JobControl& job)
    : ViewServer(std::move(server), settings, std::move(cache), job, {}) {}

ViewServer::ViewServer(std::shared_ptr<remote::ImageServer> server, const remote::ServerSettings& settings,
                       std::shared_ptr<AnswerCache> cache, const JobControl& job,
                       const std::vector<remote::OwnPicture>& own,
                       std::vector<std::shared_ptr<remote::ImageServer>> further)
    : server_(std::move(server)), further_(std::move(further)), cache_(std::move(cache)),
      source_(std::make_unique<remote::PictureSource>(*server_, server_->probe(job), identity_of(settings),
                                                      cache_.get())),
      drawing_(std::make_unique<remote::RemoteDrawing>()), loras_(settings.lora), options_(settings.option) {
    drawing_->family = family_for(settings, facts());
    drawing_->own = own;
    drawing_->key_view = settings.key_view;
    drawing_->agreement = remote::suited_agreement(remote::agreement_of(settings.agreement), drawing_->family,
                                                   facts(), !drawing_->own.empty());
    drawing_->side = remote::sent_side(settings.side, drawing_->family.side, drawing_->family.side_step);
    if (settings.fit_partial)
        drawing_->partial.fits = [](const remote::PartialRound& round) {
            if (!round.reason.empty()) log::warning("{}", round.reason);
            return true;
        };
    if (settings.used()) drawing_->nickname = remote::parse_server_url(settings.url).url.nickname();
    log::info("the views are drawn by {} ({}): family {}, agreement {}, {} x {} pixels", facts().product,
              facts().model.empty() ? "model not told" : printable(facts().model), drawing_->family.name,
              remote::agreement_name(drawing_->agreement), drawing_->side, drawing_->side);
    if (!facts().repeats) log::warning("this server cannot repeat a picture: another run differs");
    if (!further_.empty()) spread(settings, job);
}

void ViewServer::spread(const remote::ServerSettings& settings, const JobControl& job) {
    std::vector<remote::FurtherServer> team;
    for (std::size_t i = 0; i < further_.size(); ++i) {
        const auto name = i < settings.also.size() ? remote::parse_server_url(settings.also[i]).url.nickname()
                                                   : std::string("a further server");
        remote::check_alike({drawing_->nickname, facts()}, {name, further_[i]->probe(job)});
        team.push_back({further_[i].get(), name});
    }
    source_->spread_over(std::move(team));
    const auto agreement = drawing_->agreement;
    if (agreement == remote::Agreement::Warp)
        log::warning(
            "each view follows those before it (agreement warp), so that the first server draws them all: "
            "--server-agreement none spreads them");
}

ViewServer::~ViewServer() = default;

const remote::ServerFacts& ViewServer::facts() const { return source_->facts(); }
const remote::ModelFamily& ViewServer::family() const { return drawing_->family; }
remote::Agreement ViewServer::agreement() const { return drawing_->agreement; }
int ViewServer::side() const { return drawing_->side; }
const std::string& ViewServer::nickname() const { return drawing_->nickname; }
const remote::ServerUse& ViewServer::use() const { return source_->use(); }
void ViewServer::watch(std::function<void(const remote::DrawingNews&)> watch) {
    source_->watch(std::move(watch));
}
void ViewServer::use_partial_rounds(remote::PartialRounds partial) { drawing_->partial = std::move(partial); }

std::unique_ptr<edit::MultiViewEditor> ViewServer::editor(const edit::CheckedRequest& request,
                                                          edit::EditMode mode,
                                                          const std::string& negative_prompt) {
    if (handed_out_ != nullptr) return std::make_unique<HandedOutViews>(*handed_out_);
    return std::make_unique<remote::RemoteViewEditor>(*source_, told(request, mode, negative_prompt));
}

std::unique_ptr<edit::AttentionSource> ViewServer::differences(const edit::CheckedRequest& request,
                                                               edit::EditMode mode,
                                                               const std::string& negative_prompt,
                                                               bool paints, const JobControl& job) {
    return std::make_unique<remote::DifferenceSource>(
        *source_,
        remote::DifferenceEdit{told(request, mode, negative_prompt), request.sentence().before(),
                               request.source(), paints},
        job);
}

remote::RemoteDrawing ViewServer::told(const edit::CheckedRequest& request, edit::EditMode mode,
                                       const std::string& negative_prompt) const {
    auto drawing = *drawing_;
    drawing.text = {request.sentence().prompt(), server_instruction(request, mode), negative_prompt};
    return drawing;
}

std::string ViewServer::key() const {
    const auto& family = drawing_->family;
    ContentHash own;
    for (const auto& picture : drawing_->own) own.text(picture.view), own.image(picture.picture);
    own.text(drawing_->key_view);
    return fmt::format("{} {} {} {} {} {} {} {} {} {} {} {}", remote::server_kind_name(facts().kind),
                       facts().product, facts().model, family.name, family.steps, family.guidance_scale,
                       family.strength, remote::agreement_name(drawing_->agreement), drawing_->side,
                       fmt::join(loras_, " "), fmt::join(options_, " "), own.key().hex());
}

nlohmann::ordered_json ViewServer::to_json() const {
    const auto& family = drawing_->family;
    nlohmann::ordered_json json{{"kind", remote::server_kind_name(facts().kind)},
                                {"product", facts().product},
                                {"version", facts().version},
                                {"model", source_->model().empty() ? facts().model : source_->model()},
                                {"family", family.name},
                                {"agreement", remote::agreement_name(drawing_->agreement)},
                                {"side", drawing_->side},
                                {"steps", family.steps},
                                {"guidance", family.guidance_scale},
                                {"strength", family.strength}};
    for (const auto& own : drawing_->own) json["target_pictures"].push_back(own.view);
    if (!drawing_->key_view.empty()) json["key_view"] = drawing_->key_view;
    if (!loras_.empty()) json["lora"] = loras_;
    if (!options_.empty()) json["options"] = options_;
    const auto& use = source_->use();
    json["requests"] = use.requests;
    json["cached_requests"] = use.cached;
    json["megapixels"] = use.megapixels;
    json["seconds"] = use.seconds;
    if (use.smaller_side > 0) json["smaller_side"] = use.smaller_side;
    if (further_.empty()) return json;
    std::vector<std::size_t> shares{use.requests};
    for (const auto& one : source_->further()) {
        shares.front() -= one.drawn;
        shares.push_back(one.drawn);
    }
    json["requests_by_server"] = shares;
    return json;
}

std::shared_ptr<remote::ImageServer> connect_server(const remote::ServerSettings& settings,
                                                    const JobControl& job) {
    remote::ServerAddress address;
    address.url = remote_api().keep_credentials(settings.url);
    if (settings.kind != "auto") address.kind = remote::server_kind_of(settings.kind);
    address.model = settings.model;
    address.workflow = settings.workflow;
    address.loras = remote::parse_server_loras(settings.lora);
    address.options = remote::parse_server_options(settings.option);
    address.ca_file = settings.ca;
    address.allow_paid_nodes = settings.paid_nodes;
    return remote_api().connect(address, job);
}

std::vector<std::shared_ptr<remote::ImageServer>> connect_further_servers(
    const remote::ServerSettings& settings, const JobControl& job) {
    std::set<std::string> known{remote::parse_server_url(settings.url).url.at("")};
    std::vector<std::shared_ptr<remote::ImageServer>> further;
    for (const auto& text : settings.also) {
        const auto url = remote::parse_server_url(text).url;
        if (!known.insert(url.at("")).second)
            throw Error(ErrorCode::InvalidArgument,
                        fmt::format("the image server {} is named twice", url.nickname()),
                        "name another one with --server-also, or leave it away");
        auto one = settings;
        one.url = text;
        further.push_back(connect_server(one, job));
    }
    return further;
}

std::shared_ptr<ViewServer> open_view_server(const remote::ServerSettings& settings,
                                             std::shared_ptr<AnswerCache> cache, const JobControl& job) {
    if (!settings.used()) return nullptr;
    auto addresses = settings.also;
    addresses.insert(addresses.begin(), settings.url);
    for (const auto& address : addresses) {
        const auto url = remote::parse_server_url(address).url;
        log::info("pictures of the scene, their masks and the sentence go to {}{}, which may keep them",
                  url.nickname(), url.encrypted() ? "" : " (not encrypted)");
    }
    const auto own = read_target_pictures(settings);
    auto server = connect_server(settings, job);
    return std::make_shared<ViewServer>(std::move(server), settings, std::move(cache), job, own,
                                        connect_further_servers(settings, job));
}

edit::EditPlan plan_at_side(edit::EditPlan plan, int side) {
    for (auto& view : plan.views) view.camera = view.camera.resized(side, side);
    for (auto& mask : plan.masks) mask = remote::at_side(mask, side);
    return plan;
}

}  // namespace gse::pipeline
