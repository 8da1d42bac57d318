// Answer of an image server, in lines for the window.
#include "app/session/edit/server_facts.h"

#include <fmt/format.h>

#include "engine/base/error.h"
#include "engine/base/printable.h"
#include "engine/remote/api/server_kind.h"
#include "engine/remote/api/server_lora.h"
#include "engine/remote/api/server_url.h"
#include "engine/remote/views/remote_view_editor.h"
#include "engine/remote/views/view_frame.h"

namespace gse::app {
namespace {

std::string abilities_of(const remote::ServerFacts& facts) {
    std::string text = facts.takes_mask ? "takes masks" : "takes no masks";
    if (facts.references > 0) text += fmt::format(", takes {} more pictures", facts.references);
    text += facts.repeats ? ", repeats a picture by its seed" : ", cannot repeat a picture";
    if (facts.reports_progress) text += ", tells its progress";
    if (facts.shows_previews) text += ", shows pictures in the making";
    if (facts.cancels) text += ", stops when told";
    return text;
}

/// Two families for nameless models are told apart: a name that tells the family gives the same one for both.
bool told_by_name(const std::string& model) {
    return remote::family_of(model, "sd15").name == remote::family_of(model, "editor").name;
}

std::string origin_of_family(const remote::ServerSettings& settings, const std::string& model) {
    if (settings.family != "auto") return "chosen by you";
    if (model.empty()) return "a guess: the server does not name its model";
    return told_by_name(model) ? "from the model's name" : "a guess: the model's name tells nothing";
}

/// False for names that no setting can hold.
bool is_lora_name(const std::string& name) {
    try {
        return remote::parse_server_lora(name + ":1").name == name;
    } catch (const Error&) { return false; }
}

/// Numbers of the family where nobody chose others.
remote::ServerSettings usual_of(const remote::ModelFamily& used) {
    const auto& family = remote::family_named(used.name);
    remote::ServerSettings usual;
    usual.side = remote::sent_side(0, family.side, family.side_step);
    usual.steps = family.steps;
    usual.guidance = family.guidance_scale;
    usual.strength = family.strength;
    return usual;
}

}  // namespace

ServerAnswer answer_of(const pipeline::ViewServer& server, const remote::ServerSettings& settings) {
    const auto& facts = server.facts();
    const auto model = settings.model.empty() ? facts.model : settings.model;
    ServerAnswer answer;
    answer.kind = printable(facts.product);
    answer.model = facts.model;
    answer.is_comfy = facts.kind == remote::ServerKind::Comfy;
    answer.lora_names = facts.lora_names;
    answer.usual = usual_of(server.family());
    answer.side_step = server.family().side_step;
    answer.facts = {
        {"Server", fmt::format("{}{}{} ({})", answer.kind, facts.version.empty() ? "" : " ",
                               printable(facts.version), remote::server_kind_name(facts.kind))},
        {"Model", model.empty() ? "not told" : printable(model),
         settings.model.empty() ? "" : "chosen by you"},
        {"Abilities", abilities_of(facts)},
        {"Family",
         fmt::format("{}, {}", server.family().name,
                     server.family().instructed() ? "told what to do" : "told what the picture shows"),
         origin_of_family(settings, model)},
        {"Agreement", std::string(remote::agreement_name(server.agreement())),
         settings.agreement == "auto" ? "as it suits family and server" : "chosen by you"}};
    for (const auto& note : facts.notes) answer.notes.push_back(printable(note));
    if (!facts.repeats) answer.notes.emplace_back("The same edit will look different when it is made again.");
    answer.models = facts.models;
    for (const auto& lora : facts.loras)
        if (is_lora_name(lora)) answer.loras.push_back(lora);
    return answer;
}

ui::ServerView::Fact values_fact(const remote::ServerSettings& settings, const ui::ServerView& view) {
    const auto& usual = view.usual;
    const int side = remote::sent_side(settings.side, usual.side, view.side_step);
    const bool chosen =
        settings.side > 0 || settings.steps > 0 || settings.guidance > 0 || settings.strength > 0;
    return {"Values",
            fmt::format("{} steps, guidance {}, strength {}, {} x {} pixels",
                        settings.steps > 0 ? settings.steps : usual.steps,
                        settings.guidance > 0 ? settings.guidance : usual.guidance,
                        settings.strength > 0 ? settings.strength : usual.strength, side, side),
            chosen ? "some chosen by you" : "of the family"};
}

ui::ServerView::Here here_of(const remote::FoundServer& found) {
    if (!found.problem.empty()) return {found.url, found.problem, false};
    return {found.url,
            fmt::format("{} at {}{}{}", found.product, remote::parse_server_url(found.url).url.nickname(),
                        found.model.empty() ? "" : ", ", found.model),
            true};
}

std::vector<std::string> server_families() {
    std::vector<std::string> names{"auto"};
    for (const auto& family : remote::model_families()) names.emplace_back(family.name);
    return names;
}

}  // namespace gse::app
