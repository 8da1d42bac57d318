// Image server that draws the views of edits: its settings and facts, the switch, and the artist's consent.
#include "app/session/edit/server_controller.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <utility>

#include "app/session/edit/server_facts.h"
#include "engine/base/error.h"
#include "engine/base/fields.h"
#include "engine/base/log.h"
#include "engine/base/printable.h"
#include "engine/edit/request/checked_request.h"
#include "engine/edit/request/decide_mode.h"
#include "engine/pipeline/models/remote_loader.h"
#include "engine/remote/api/server_lora.h"
#include "engine/remote/api/server_option.h"
#include "engine/remote/api/server_url.h"
#include "engine/remote/views/picture_source.h"
#include "engine/remote/views/view_frame.h"

namespace gse::app {
namespace {

namespace command = ui::command;

std::string sentence_of(const Error& error) {
    const auto text = printable(error.message());
    return error.hint().empty() ? text : fmt::format("{}: {}", text, error.hint());
}

/// False for what is only moved, copied or removed.
bool is_drawn(const edit::EditRequest& request) {
    try {
        return !edit::check(request).is_rearranged();
    } catch (const Error&) { return true; }  // no job runs with it
}

/// Views that are sent in a round.
int pictures_of(const edit::EditRequest& request) {
    auto mode = edit::EditMode::Modify;
    try {
        mode = edit::decide_mode(edit::check(request), std::nullopt).first;
    } catch (const Error&) {  // the edit says what is wrong with it
    }
    return edit::round_plan(request, mode).views;
}

/// Throws Error for settings that no server takes.
void check_settings(const remote::ServerSettings& settings) {
    check_fields(settings);
    remote::parse_server_loras(settings.lora);
    remote::parse_server_options(settings.option);
    for (const auto& text : settings.target_picture)
        if (const auto own = remote::target_picture_of(text); !std::filesystem::is_regular_file(own.file))
            throw Error(ErrorCode::NotFound,
                        fmt::format("there is no picture \"{}\"", printable(own.file.string())),
                        "choose a PNG or JPEG");
}

/// Views that have other pictures of the artist's own than before, in words; empty = none has.
std::string said_of_pictures(const remote::ServerSettings& before, const remote::ServerSettings& now) {
    for (const auto& text : now.target_picture)
        if (const auto own = remote::target_picture_of(text);
            std::find(before.target_picture.begin(), before.target_picture.end(), text) ==
            before.target_picture.end())
            return fmt::format("The next edit draws {} like {}.", printable(own.view),
                               printable(own.file.filename().string()));
    return before.target_picture.size() > now.target_picture.size() ? "The next edit draws that view itself."
                                                                    : "";
}

/// Settings that a server's answer depends on: not the numbers.
nlohmann::ordered_json asked_with(remote::ServerSettings settings) {
    settings.side = settings.steps = 0;
    settings.guidance = settings.strength = 0;
    settings.target_picture.clear();
    return fields_to_json(settings);
}

/// Words about who can read what goes there.
std::string said_of_way(const remote::ServerUrl& url) {
    if (remote::is_loopback(url.host)) return "That is this machine.";
    if (url.encrypted() || remote::is_private(url.host)) return "That server may keep them.";
    return "That server may keep them. It is a public address, and the way there is not encrypted: others on "
           "the way can read and keep them, too.";
}

}  // namespace

remote::ServerSettings ServerController::server_for(const edit::EditRequest& request) const {
    const bool used = on_ && settings_.used() && consents_.contains(consent_key()) && is_drawn(request);
    return used ? settings_ : remote::ServerSettings{};
}

/// A public address is asked about again for each document.
std::string ServerController::consent_key() const {
    const auto url = remote::parse_server_url(settings_.url).url;
    return remote::is_private(url.host) ? url.origin()
                                        : fmt::format("{} {}", url.origin(), workspace_.opened);
}

std::string ServerController::told(const edit::EditRequest& request) const {
    const auto url = remote::parse_server_url(settings_.url).url;
    const int side =
        view_.usual.side > 0 ? remote::sent_side(settings_.side, view_.usual.side, view_.side_step) : 0;
    const auto size = side > 0 ? fmt::format(", {0} x {0} pixels", side) : std::string();
    return fmt::format(
        "{} pictures of your scene in each round{}, their masks{} and the sentence \"{}\" go to "
        "{} ({}{}). {}",
        pictures_of(request), size, settings_.target_picture.empty() ? "" : ", your own pictures",
        request.prompt, url.nickname(), kind_.empty() ? "an image server" : kind_,
        url.encrypted() || remote::is_loopback(url.host) ? "" : ", not encrypted", said_of_way(url));
}

std::string ServerController::told_of_search(const edit::EditRequest& request, int pictures) const {
    const auto url = remote::parse_server_url(settings_.url).url;
    return fmt::format(
        "The image server can show where \"{}\" is, by what it changes: {} pictures of your scene, as many "
        "again where it is small, and the sentence \"{}\" go to {} ({}{}). {}",
        request.source, pictures, request.prompt, url.nickname(), kind_.empty() ? "an image server" : kind_,
        url.encrypted() || remote::is_loopback(url.host) ? "" : ", not encrypted", said_of_way(url));
}

bool ServerController::may_send(const AskedSentence& sentence, std::function<void()> then) {
    if (!on_ || !settings_.used() || consents_.contains(consent_key())) return true;
    if (sentence.steps().size() < 2 && !is_drawn(sentence.asked())) return true;
    const auto agreed = [this, key = consent_key(), then = std::move(then)] {
        if (!on_ || key != consent_key()) return;  // another server was chosen meanwhile
        consents_.insert(key);
        then();
    };
    workspace_.notices.ask("Send pictures to the image server?", told(sentence.request()),
                           {{{"Send"}, agreed}, {{"Cancel"}, {}}});
    return false;
}

void ServerController::mention(const remote::ServerSettings& named) {
    if (!named.used()) return;
    const auto url = remote::without_secrets(named.url);
    workspace_.notices.toast(
        fmt::format("An image server drew the views of this recipe ({}). It is not asked here unless you "
                    "switch it on under Models.",
                    printable(url)));
}

// News

void ServerController::refresh() {
    for (auto& one : road_->take()) {
        costs_.measure(one);
        model_ = one.model;
        model_of_ = one.settings.url;
        drawing_ = {std::move(one.drawing.sent), std::move(one.drawing.preview)};
    }
    if (!workspace_.jobs->works()) drawing_ = {};
}

void ServerController::take_document() {
    settings_.target_picture.clear();
    road_ = std::make_shared<ServerRoad>();
    drawing_ = {};
}

ServerCost ServerController::cost_of(const std::vector<PlannedEdit>& edits) const {
    if (!on_ || !settings_.used()) return {};
    return costs_.cost_of(edits, settings_, model_of_ == settings_.url ? model_ : std::string());
}

// Settings

void ServerController::settings_to_json(nlohmann::json& json) const {
    if (!settings_.used()) return;
    json["server"] = fields_to_json(settings_);
    json["server"].erase("target_picture");  // of this scene
    json["server"].erase("also");            // of the command line alone
    json["server"]["url"] = remote::without_secrets(settings_.url);
    json["server_times"] = costs_.to_json();
}

void ServerController::settings_from_json(const nlohmann::json& json) {
    if (!json.contains("server")) return;
    if (json.contains("server_times")) costs_.take(json["server_times"]);
    try {
        remote::ServerSettings read;
        fields_from_json(read, nlohmann::ordered_json(json["server"]));
        check_settings(read);
        read.url = remote::parse_server_url(read.url).url.at("");
        read.also.clear();  // the consent names one server
        settings_ = std::move(read);
    } catch (const std::exception& error) {  // of another version, or edited by hand
        log::warning("the settings of the image server cannot be used ({})", error.what());
    }
}

void ServerController::show(ui::ServerPart& model) const {
    model.server = view_;
    model.server.choice = settings_;
    if (!view_.facts.empty()) model.server.facts.push_back(values_fact(settings_, view_));
    model.server.families = server_families();
    model.server.on = on_;
    model.drawing = drawing_;
}

// Commands

void ServerController::forget_facts() {
    auto known = std::exchange(view_, {});
    view_.here = std::move(known.here);  // they are no facts about the one that is chosen
    view_.looked = known.looked;
    view_.looking = known.looking;
    kind_.clear();
}

/// Throws Error.
void ServerController::take(const remote::ServerSettings& choice) {
    check_settings(choice);
    const auto url = choice.url.empty() ? std::string() : remote::parse_server_url(choice.url).url.at("");
    if (remote::without_secrets(choice.url) != choice.url) remote_api().keep_credentials(choice.url);
    if (url == settings_.url) {
        settings_ = choice;
    } else {
        on_ = false;
        settings_ = {};
        forget_facts();
    }
    settings_.url = url;
    workspace_.settings_changed = true;
}

template <> void ServerController::on(const command::SetServer& one) {
    const auto before = settings_;
    const bool asked = !view_.facts.empty() || !view_.problem.empty();
    try {
        take(one.choice);
    } catch (const Error& error) { return workspace_.notices.report(error); }
    if (const auto said = said_of_pictures(before, settings_); !said.empty()) workspace_.notices.toast(said);
    const bool answers_differ = asked_with(before) != asked_with(settings_);
    if (asked && before.url == settings_.url && answers_differ && !workspace_.jobs->works()) ask();
}

template <> void ServerController::on(const command::KeepServerPassword& one) {
    if (!settings_.used()) return;
    try {
        const auto url = remote::parse_server_url(settings_.url).url;
        const auto place = url.at("").substr(url.scheme.size() + 3);
        remote_api().keep_credentials(fmt::format("{}://{}:{}@{}", url.scheme,
                                                  remote::percent_encoded(one.name),
                                                  remote::percent_encoded(one.password), place));
        view_.problem.clear();
        workspace_.notices.toast(fmt::format("The password for {} is kept.", url.nickname()));
    } catch (const Error& error) { workspace_.notices.report(error); }
}

template <> void ServerController::on(const command::TestServer&) { ask(); }

/// Asks the server what it is, on the work thread.
void ServerController::ask() {
    if (!settings_.used()) return;
    if (workspace_.jobs->works())
        return workspace_.notices.toast("The image server can be asked when the job is done.");
    auto known = std::exchange(view_, {});
    view_.usual = known.usual;  // so that what was chosen wrongly can be taken off
    view_.side_step = known.side_step;
    view_.here = std::move(known.here);
    view_.looked = known.looked;
    view_.models = std::move(known.models);
    view_.loras = std::move(known.loras);
    view_.lora_names = known.lora_names;
    view_.is_comfy = known.is_comfy;
    kind_.clear();
    view_.testing = true;
    auto answer = std::make_shared<ServerAnswer>();
    auto work = [settings = settings_, answer](const JobControl& control) {
        control.report(asking_text(settings), 0, 0);
        const ViewServer views(connect_server(settings, control), settings, nullptr, control);
        *answer = answer_of(views, settings);
    };
    auto done = [this, answer, url = settings_.url](const Error* error) {
        view_.testing = false;
        if (url != settings_.url) return;
        if (error != nullptr) {
            if (error->code() != ErrorCode::Cancelled) view_.problem = sentence_of(*error);
            return;
        }
        view_.facts = answer->facts;
        view_.notes = answer->notes;
        view_.models = answer->models;
        view_.loras = answer->loras;
        view_.lora_names = answer->lora_names;
        view_.is_comfy = answer->is_comfy;
        view_.usual = answer->usual;
        view_.side_step = answer->side_step;
        kind_ = answer->kind;
        model_ = answer->model;
        model_of_ = url;
    };
    workspace_.jobs->start_work(JobKind::Other, {"Test the image server", work, done});
}

/// Asks the usual ports of this machine, on the work thread.
template <> void ServerController::on(const command::FindServers&) {
    if (workspace_.jobs->works())
        return workspace_.notices.toast("Servers can be looked for when the job is done.");
    view_.here.clear();
    view_.looked = false;
    view_.looking = true;
    auto answer = std::make_shared<std::vector<remote::FoundServer>>();
    auto work = [answer](const JobControl& control) {
        *answer = remote_api().find_here(remote::UsualPorts, control);
    };
    auto done = [this, answer](const Error* error) {
        view_.looking = false;
        view_.looked = error == nullptr;
        if (error != nullptr) return workspace_.report_end(*error);
        for (const auto& one : *answer) view_.here.push_back(here_of(one));
    };
    workspace_.jobs->start_work(JobKind::Other, {"Look for image servers", work, done});
}

template <> void ServerController::on(const command::UseServer& one) { on_ = one.on && settings_.used(); }

template <> void ServerController::on(const command::ForgetServer&) {
    try {
        if (settings_.used()) remote_api().forget_credentials(settings_.url);
    } catch (const Error& error) { workspace_.notices.report(error); }
    settings_ = {};
    on_ = false;
    consents_.clear();
    costs_.forget();
    forget_facts();
    workspace_.settings_changed = true;
}

void ServerController::run(const ui::ServerCommand& command) {
    std::visit([this](const auto& one) { on(one); }, command);
}

}  // namespace gse::app
