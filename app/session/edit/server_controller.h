// Image server that draws the views of edits: its settings and facts, the switch, and the artist's consent.
#pragma once

#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "app/engine_names.h"
#include "app/session/edit/asked_sentence.h"
#include "app/session/edit/server_costs.h"
#include "app/session/state/estimate.h"
#include "app/session/state/workspace.h"
#include "engine/edit/request/request.h"
#include "engine/pipeline/models/view_server.h"
#include "engine/remote/api/server_settings.h"

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
    /// Words about what goes where when the server looks for the source of a checked request, in so many
    /// pictures.
    std::string told_of_search(const edit::EditRequest& request, int pictures) const;
    /// The settings as they are while the server is on; without an address otherwise.
    remote::ServerSettings offered() const { return on_ ? settings_ : remote::ServerSettings{}; }
    /// Takes a click on told_of_search() for the consent.
    void agree() { consents_.insert(consent_key()); }
    /// True where the server may be sent what the sentence needs, or where none is needed. Otherwise asks the
    /// artist; with the consent, `then` is called later.
    bool may_send(const AskedSentence& sentence, std::function<void()> then);
    /// Road for the news of servers at work, which refresh() takes up.
    const std::shared_ptr<ServerRoad>& road() const { return road_; }
    /// Takes previews and times of pictures that came. Once per frame.
    void refresh();
    /// Part of these edits that the server would do as it is set now; none while it is off.
    ServerCost cost_of(const std::vector<PlannedEdit>& edits) const;
    /// Forgets pictures that were for views of another document.
    void take_document();
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
    std::shared_ptr<ServerRoad> road_ = std::make_shared<ServerRoad>();
    ServerCosts costs_;
    ui::DrawingView drawing_;
    std::string model_, model_of_;  // the one that it told last, and its server's address
};

}  // namespace gse::app
