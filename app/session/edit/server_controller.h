// Image server that draws the views of edits: its settings and facts, the switch, and the artist's consent.
#pragma once

#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "app/engine_names.h"
#include "app/session/edit/asked_sentence.h"
#include "app/session/state/estimate.h"
#include "app/session/state/workspace.h"
#include "engine/edit/request/request.h"
#include "engine/pipeline/models/view_server.h"
#include "engine/remote/api/server_settings.h"
#include "engine/remote/views/agreement.h"

namespace gse::app {

class ServerController {
public:
    explicit ServerController(Workspace& workspace) : workspace_(workspace) {}

    void run(const ui::ServerCommand& command);
    void show(ui::ServerPart& model) const;

    bool on() const { return on_; }
    /// Server for the recipe of a request. It has no address unless it is on, the artist has agreed, and
    /// something is to be drawn.
    remote::ServerSettings server_for(const edit::EditRequest& request) const;
    /// True where the server may be sent what the sentence needs, or where none is needed. Otherwise asks the
    /// artist; with the consent, `then` is called later.
    bool may_send(const AskedSentence& sentence, std::function<void()> then);
    /// Takes the time that the server of a run took for its pictures, where it drew any. Null = there was
    /// none.
    void measure(const remote::ServerSettings& settings, const ViewServer* server);
    /// Part of these edits that the server would do as it is set now; none while it is off.
    ServerCost cost_of(const std::vector<PlannedEdit>& edits) const;
    /// Forgets pictures that were for views of another document.
    void take_document() { settings_.target_picture.clear(); }
    /// Shows the server that a recipe names. It is neither asked nor switched on.
    void mention(const remote::ServerSettings& named);

    void settings_to_json(nlohmann::json& json) const;  // of the program
    void settings_from_json(const nlohmann::json& json);

private:
    template <class C> void on(const C& command);
    void take(const remote::ServerSettings& choice);
    void forget_facts();
    void ask();
    std::string consent_key() const;
    std::string told(const edit::EditRequest& request) const;

    Workspace& workspace_;
    remote::ServerSettings settings_;  // its url has no secrets
    bool on_ = false;
    ui::ServerView view_;             // of the last answer
    std::string kind_;                // "sd-server"; empty = not asked yet
    std::set<std::string> consents_;  // of this session
    /// Way in which pictures were drawn, and seconds for one.
    struct Measured {
        remote::Agreement agreement;
        double seconds = 0;
    };
    std::map<std::string, Measured> measured_;  // in this session, by settings
};

}  // namespace gse::app
