// Answer of an image server, in lines for the window.
#pragma once

#include <string>
#include <vector>

#include "engine/pipeline/models/view_server.h"
#include "engine/remote/api/server_settings.h"
#include "ui/model/view_model.h"

namespace gse::app {

/// Facts about a server and its use, in plain values: they go from the job to the window.
struct ServerAnswer {
    std::vector<ui::ServerView::Fact> facts;
    std::vector<std::string> notes, models;
    std::string kind;  // "sd-server"
    int side = 0;      // of the pictures that are sent, px
};

/// Facts of a server that was asked, its family with the values that it is driven with, and their origins.
ServerAnswer answer_of(const pipeline::ViewServer& server, const remote::ServerSettings& settings);

/// "auto" and the names of all families.
std::vector<std::string> server_families();

}  // namespace gse::app
