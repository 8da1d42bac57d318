// Answer of an image server, in lines for the window.
#pragma once

#include <string>
#include <vector>

#include "engine/pipeline/models/view_server.h"
#include "engine/remote/api/remote_api.h"
#include "engine/remote/api/server_lora.h"
#include "engine/remote/api/server_settings.h"
#include "ui/model/view_model.h"

namespace gse::app {

/// Facts about a server and its use, in plain values: they go from the job to the window.
struct ServerAnswer {
    std::vector<ui::ServerView::Fact> facts;
    std::vector<std::string> notes, models, loras;
    std::string kind;       // "sd-server"
    std::string model;      // that it has loaded; empty = not told
    bool is_comfy = false;  // it draws by workflows
    remote::LoraNames lora_names = remote::LoraNames::Listed;
    remote::ServerSettings usual;  // side, steps, guidance and strength of the family
    int side_step = 64;            // of the family, px
};

/// Facts of a server that was asked and its family, with their origins.
ServerAnswer answer_of(const pipeline::ViewServer& server, const remote::ServerSettings& settings);

/// Numbers that the server is driven with, and their origin, beside the usual ones in `view`.
ui::ServerView::Fact values_fact(const remote::ServerSettings& settings, const ui::ServerView& view);

/// Server on this machine, in a line for the window.
ui::ServerView::Here here_of(const remote::FoundServer& found);

/// "auto" and the names of all families.
std::vector<std::string> server_families();

}  // namespace gse::app
