// Answer of an image server, in lines for the window.
#include "app/session/edit/server_facts.h"

#include <fmt/format.h>

#include "engine/base/printable.h"
#include "engine/remote/api/server_kind.h"
#include "engine/remote/views/remote_view_editor.h"

namespace gse::app {
namespace {

std::string abilities_of(const remote::ServerFacts& facts) {
    std::string text = facts.takes_mask ? "takes masks" : "takes no masks";
    if (facts.references > 0) text += fmt::format(", takes {} more pictures", facts.references);
    text += facts.repeats ? ", repeats a picture by its seed" : ", cannot repeat a picture";
    if (facts.reports_progress) text += ", tells its progress";
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

std::string values_of(const pipeline::ViewServer& server) {
    const auto& family = server.family();
    return fmt::format("{} steps, guidance {}, strength {}, {} x {} pixels", family.steps,
                       family.guidance_scale, family.strength, server.side(), server.side());
}

}  // namespace

ServerAnswer answer_of(const pipeline::ViewServer& server, const remote::ServerSettings& settings) {
    const auto& facts = server.facts();
    const auto model = settings.model.empty() ? facts.model : settings.model;
    ServerAnswer answer;
    answer.kind = printable(facts.product);
    answer.side = server.side();
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
        {"Values", values_of(server), "of the family"},
        {"Agreement", std::string(remote::agreement_name(server.agreement())),
         settings.agreement == "auto" ? "as it suits family and server" : "chosen by you"}};
    for (const auto& note : facts.notes) answer.notes.push_back(printable(note));
    if (!facts.repeats) answer.notes.emplace_back("The same edit will look different when it is made again.");
    answer.models = facts.models;
    return answer;
}

std::vector<std::string> server_families() {
    std::vector<std::string> names{"auto"};
    for (const auto& family : remote::model_families()) names.emplace_back(family.name);
    return names;
}

}  // namespace gse::app
