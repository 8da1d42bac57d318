// Sessions of the window with an image server: addresses, sentences, and a server that stands in.
#pragma once

#include <doctest/doctest.h>

#include <cmath>
#include <string>

#include "engine/base/file.h"
#include "engine/pipeline/models/remote_loader.h"
#include "tests/stress/remote/stand_in.h"
#include "tests/ui/app/session.h"

namespace server_sessions {

using namespace gse;
using namespace gse::test;

inline bool can_ask() {
    if (pipeline::remote_library().empty()) skip_missing("libgse_remote.so is not there");
    return !pipeline::remote_library().empty() && remote::can_stand_in();
}

inline void choose(Session& session, const std::string& url) {
    gse::remote::ServerSettings settings;
    settings.url = url;
    session.app.run(command::SetServer{settings});
}

/// Small pictures, which the stand-in draws quickly.
inline void choose_small(Session& session, const std::string& url) {
    choose(session, url);
    auto settings = session.app.model().server.choice;
    settings.url = url;
    settings.side = 128;
    session.app.run(command::SetServer{settings});
}

inline std::string all_facts(const ui::ServerView& server) {
    std::string text;
    for (const auto& fact : server.facts) text += fact.name + ": " + fact.value + " (" + fact.origin + ")\n";
    return text;
}

inline std::string question(const Session& session) { return session.app.model().question.text; }

inline double mean_difference(const Image& a, const Image& b) {
    DOCTEST_REQUIRE(a.data.size() == b.data.size());
    double sum = 0;
    for (std::size_t i = 0; i < a.data.size(); ++i) sum += std::abs(a.data[i] - b.data[i]);
    return sum / static_cast<double>(a.data.size());
}

inline std::uint64_t questions(const Session& session) { return session.app.model().question.number; }

/// Everything in the folder, as one text.
inline std::string all_files(const fs::path& folder) {
    std::string text;
    for (const auto& file : fs::recursive_directory_iterator(folder))
        if (file.is_regular_file()) text += read_file(file.path());
    return text;
}

/// A sentence with a word that only a server draws, drawn small and quickly.
inline void ask_for_iridescence(Session& session) {
    auto request = session.app.model().request;
    request.source = "bear";
    request.prompt = "a golden iridescent bear";
    request.target = "golden iridescent";
    request.quality = "draft";
    request.method = "auto";
    request.views = 12;
    session.app.run(command::SetRequest{request});
}

/// The edit asked for with the server switched on; the question about it waits.
inline void ask_server(Session& session, const remote::StandIn& server) {
    session.open_bear();
    ask_for_iridescence(session);
    choose_small(session, server.url());
    session.app.run(command::UseServer{true});
    session.app.run(command::Edit{});
}

/// A window that edits with a stand-in switched on; the question about it waits.
struct Asked {
    Place place;
    remote::StandIn server;
    Session session;
    const ui::ViewModel& model = session.app.model();

    explicit Asked(const std::string& flavour = "sdserver", const remote::Knobs& knobs = {})
        : server(flavour) {
        server.set(knobs);
        ask_server(session, server);
    }
    void agree() { session.app.run(command::Answer{0}); }
    /// The edit with another seed.
    void edit_again() {
        auto request = model.request;
        request.seed += 1;
        session.app.run(command::SetRequest{request});
        session.app.run(command::Edit{});
    }
};

inline bool can_draw() { return can_ask() && networks(); }

}  // namespace server_sessions
