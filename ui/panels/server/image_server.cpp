// Image server, a part of Models: its address, what it says of itself, the switch, and how it is used.
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>

#include "engine/base/error.h"
#include "engine/remote/api/server_settings.h"
#include "engine/remote/api/server_url.h"
#include "ui/commands/guarded.h"
#include "ui/panels/panels.h"
#include "ui/panels/server/parts.h"
#include "ui/state/state.h"
#include "ui/widgets/controls.h"

namespace gse::ui {
namespace {

constexpr std::array<const char*, 5> Agreements{"auto", "none", "sheet", "reference", "warp"};

/// Why a text is no address of a server; empty = it is one, or nothing is typed.
std::string address_problem(const std::string& text) {
    if (text.empty()) return {};
    try {
        remote::parse_server_url(text);
    } catch (const Error& error) {
        return fmt::format("No address yet: {}; {}", error.message(), error.hint());
    }
    return {};
}

std::string why_not_use(const Context& context) {
    const auto& typed = context.state.models;
    if (typed.server_url.empty()) return "Type the address of a server first";
    return typed.server_problem.empty() ? "" : "This is no address of a server; the line below it says why";
}

/// Takes the address as it is typed, unless it is in use already. A password in it leaves the screen.
void take_address(Context& context) {
    auto& typed = context.state.models;
    auto choice = context.model.server.choice;
    const auto plain =
        typed.server_url.empty() ? std::string() : remote::parse_server_url(typed.server_url).url.at("");
    if (typed.server_url == choice.url) return;
    choice.url = typed.server_url;
    context.emit(command::SetServer{choice});
    typed.server_url = plain;
}

void draw_address(Context& context) {
    auto& typed = context.state.models;
    const auto& server = context.model.server;
    if (typed.server_shown != server.choice.url) {
        typed.server_shown = typed.server_url = server.choice.url;
        typed.server_problem.clear();
    }
    const auto before = typed.server_url;
    const bool entered = text_input(context, "models.server.url", typed.server_url, "http://127.0.0.1:7860",
                                    ImGuiInputTextFlags_EnterReturnsTrue);
    if (typed.server_url != before) typed.server_problem = address_problem(typed.server_url);
    if (!typed.server_problem.empty()) coloured_text(palette::Warning, typed.server_problem);
    const auto off = why_not_use(context);
    if (entered && off.empty()) take_address(context);
    const auto busy = context.model.job.running ? "A job is running." : "";
    if (button(context, {.name = "models.server.test",
                         .text = "Test",
                         .why_off = off.empty() ? busy : off,
                         .tooltip = "Ask the server what it is. No picture is sent."})) {
        take_address(context);
        context.emit(command::TestServer{});
    }
    flow(button_width("Forget"));
    if (button(context, {.name = "models.server.forget",
                         .text = "Forget",
                         .why_off = server.choice.url.empty() ? "There is no server to forget" : "",
                         .tooltip = "Forget address, facts and password."})) {
        typed.server_url.clear();
        typed.server_problem.clear();
        context.emit(command::ForgetServer{});
    }
}

/// Looks for servers on this machine, and lists them.
void draw_servers_here(Context& context) {
    const auto& server = context.model.server;
    if (button(context, {.name = "models.server.find",
                         .text = "Look on this machine",
                         .why_off = context.model.job.running ? "A job is running." : "",
                         .tooltip = "Ask the usual ports of image servers here what listens. No picture and "
                                    "no password is sent."}))
        context.emit(command::FindServers{});
    if (server.looking) dim_text("The usual ports of this machine are being asked.");
    if (server.looked && server.here.empty())
        dim_text("No program listens on the usual ports of image servers. Type the address.");
    for (std::size_t i = 0; i < server.here.size(); ++i) {
        const auto& one = server.here[i];
        if (!one.usable) {
            dim_text(one.text);
            continue;
        }
        if (!button(context, {.name = fmt::format("models.server.here.{}", i),
                              .text = one.text,
                              .tooltip = "Take this server's address"}))
            continue;
        context.state.models.server_url = one.url;
        context.state.models.server_problem.clear();
        take_address(context);
    }
}

void draw_switch(Context& context) {
    bool on = context.model.server.on;
    ImGui::BeginDisabled(!on && !why_not_use(context).empty());
    if (checkbox(context, "models.server.on", "Draw with this server", on,
                 "Edits have their views drawn there. The search, the label and the judgement stay here. You "
                 "are asked before the first picture goes.")) {
        if (on) take_address(context);
        context.emit(command::UseServer{on});
    }
    ImGui::EndDisabled();
}

void draw_facts(const ServerView& server, Context& context) {
    if (server.testing) dim_text("The server is being asked what it is.");
    if (!server.problem.empty()) coloured_text(palette::Bad, server.problem);
    for (const auto& fact : server.facts)
        property(context, fact.name,
                 fact.origin.empty() ? fact.value : fmt::format("{} ({})", fact.value, fact.origin));
    for (const auto& note : server.notes) dim_text(note);
}

/// List of names to choose from. True where `chosen` became another one; a name that is not listed stays.
bool choose(Context& context, std::string_view name, std::vector<const char*> names, std::string& chosen) {
    const auto found =
        std::find_if(names.begin(), names.end(), [&](const char* one) { return chosen == one; });
    int index = found == names.end() ? -1 : static_cast<int>(found - names.begin());
    if (!combo(context, name, names, index)) return false;
    chosen = names[static_cast<std::size_t>(index)];
    return true;
}

std::vector<const char*> texts_of(const std::vector<std::string>& names) {
    std::vector<const char*> texts;
    for (const auto& name : names) texts.push_back(name.c_str());
    return texts;
}

void draw_choices(Context& context) {
    const auto& server = context.model.server;
    auto choice = server.choice;
    bool changed = false;
    if (server.models.size() > 1) {
        row_label(context, "Set model", "The model that the server draws with.");
        std::string shown = choice.model.empty() ? "as it is loaded" : choice.model;
        auto names = texts_of(server.models);
        names.insert(names.begin(), "as it is loaded");
        if (choose(context, "models.server.model", names, shown)) {
            choice.model = shown == names.front() ? "" : shown;
            changed = true;
        }
    }
    row_label(context, "Set family",
              "Family of the model: it decides steps, guidance, strength, size and the form of the sentence. "
              "auto = by the model's name.");
    changed |= choose(context, "models.server.family", texts_of(server.families), choice.family);
    row_label(
        context, "Set agreement",
        "Way to make the views agree. Sheet: several views in one picture. Reference: the first is shown "
        "beside the others. Warp: the first is carried over by depth. auto = as it suits the family.");
    changed |=
        choose(context, "models.server.agreement", {Agreements.begin(), Agreements.end()}, choice.agreement);
    if (changed) context.emit(command::SetServer{choice});
}

void draw_password(Context& context) {
    if (!folding(context, "models.server.secret", "Password")) return;
    auto& typed = context.state.models;
    dim_text("It is kept in servers.json of your settings, which only you can read.");
    text_input(context, "models.server.user", typed.server_user, "user name");
    text_input(context, "models.server.password", typed.server_password, "password",
               ImGuiInputTextFlags_Password);
    const bool typed_all = !typed.server_user.empty() && !typed.server_password.empty();
    if (button(context, {.name = "models.server.keep",
                         .text = "Keep",
                         .why_off = typed_all ? "" : "Type user name and password first"})) {
        context.emit(command::KeepServerPassword{typed.server_user, typed.server_password});
        typed.server_user.clear();
        typed.server_password.clear();
    }
    dim_text("A token goes into the environment variable GSEDITPRO_SERVER_TOKEN before the program starts.");
}

}  // namespace

void draw_image_server(Context& context) {
    heading(context, "Image server");
    dim_text(
        "A picture model that runs elsewhere, such as sd-server, Forge or ComfyUI, can draw the views of an "
        "edit.");
    draw_address(context);
    draw_servers_here(context);
    draw_switch(context);
    draw_facts(context.model.server, context);
    if (context.model.server.choice.url.empty()) return;
    draw_choices(context);
    draw_drawing_settings(context);
    draw_password(context);
}

}  // namespace gse::ui
