// Server of a run that draws views in place of the model.
#pragma once

#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/base/answer_cache.h"
#include "engine/edit/interfaces/edit_plan.h"
#include "engine/edit/interfaces/interfaces.h"
#include "engine/edit/request/checked_request.h"
#include "engine/remote/api/image_server.h"
#include "engine/remote/api/server_settings.h"

namespace gse::remote {

class PictureSource;
struct DrawingNews;
enum class Agreement;
struct ModelFamily;
struct OwnPicture;
struct PartialRounds;
struct RemoteDrawing;
struct ServerUse;

}  // namespace gse::remote

namespace gse::pipeline {

/// A server, asked once what it is; its model's family and the way to draw follow from the settings and from
/// that. Editors of one run share what it drew.
class ViewServer {
public:
    /// Asks the server for its facts. `cache` may be null. Throws Error as ImageServer::probe(), and
    /// (InvalidArgument) for settings that are none or do not fit the server.
    ViewServer(std::shared_ptr<remote::ImageServer> server, const remote::ServerSettings& settings,
               std::shared_ptr<AnswerCache> cache, const JobControl& job);
    /// `own`: pictures of the artist's own. `further`: the servers of ServerSettings::also. One that speaks
    /// another protocol or has another model than the first is refused (InvalidArgument).
    ViewServer(std::shared_ptr<remote::ImageServer> server, const remote::ServerSettings& settings,
               std::shared_ptr<AnswerCache> cache, const JobControl& job,
               const std::vector<remote::OwnPicture>& own,
               std::vector<std::shared_ptr<remote::ImageServer>> further = {});
    ~ViewServer();

    const remote::ServerFacts& facts() const;
    const remote::ModelFamily& family() const;
    remote::Agreement agreement() const;
    /// Side of the pictures that are sent, px.
    int side() const;
    const remote::ServerUse& use() const;
    /// Address without scheme and secrets, for people.
    const std::string& nickname() const;
    /// Who is told of the pictures in the making (remote::DrawingWatch); empty = nobody.
    void watch(std::function<void(const remote::DrawingNews&)> watch);
    /// From the next editor on: use of rounds that end before all of their views are drawn.
    void use_partial_rounds(remote::PartialRounds partial);

    /// Draws the views of a request in that mode. The server stays alive.
    std::unique_ptr<edit::MultiViewEditor> editor(const edit::CheckedRequest& request, edit::EditMode mode,
                                                  const std::string& negative_prompt);
    /// From now on the views of a round are handed out in place of being drawn, and the edit ends with Error
    /// (Cancelled). Null: they are drawn again.
    void hand_out(std::vector<edit::EditView>* views) { handed_out_ = views; }
    /// Finds the thing of a request in pictures by what the server changes in them: the edit, or (`paints`)
    /// the thing's colour. The server stays alive. Throws Error as remote::DifferenceSource.
    std::unique_ptr<edit::AttentionSource> differences(const edit::CheckedRequest& request,
                                                       edit::EditMode mode,
                                                       const std::string& negative_prompt, bool paints,
                                                       const JobControl& job);
    /// Key of all that the pictures follow from beside the request; no address.
    std::string key() const;
    /// Facts and counts for a report; no address.
    nlohmann::ordered_json to_json() const;

private:
    /// Spreads the views over the further servers.
    void spread(const remote::ServerSettings& settings, const JobControl& job);
    /// Settings of what is drawn, with the words of a request.
    remote::RemoteDrawing told(const edit::CheckedRequest& request, edit::EditMode mode,
                               const std::string& negative_prompt) const;

    std::shared_ptr<remote::ImageServer> server_;
    std::vector<std::shared_ptr<remote::ImageServer>> further_;
    std::shared_ptr<AnswerCache> cache_;
    std::unique_ptr<remote::PictureSource> source_;
    std::unique_ptr<remote::RemoteDrawing> drawing_;  // without its text
    std::vector<edit::EditView>* handed_out_ = nullptr;
    const std::vector<std::string> loras_, options_;  // of the server
};

/// The server at the settings' address. Name and password that stand in the address are kept in the user's
/// file of credentials. Throws Error as remote::RemoteApi::connect().
std::shared_ptr<remote::ImageServer> connect_server(const remote::ServerSettings& settings,
                                                    const JobControl& job);

/// The servers of ServerSettings::also, as connect_server(). Throws Error (InvalidArgument) for an address
/// that is named twice.
std::vector<std::shared_ptr<remote::ImageServer>> connect_further_servers(
    const remote::ServerSettings& settings, const JobControl& job);

/// The server that the settings name, connected and asked what it is; null where they name none. Throws Error
/// as remote::RemoteApi::connect() and ViewServer.
std::shared_ptr<ViewServer> open_view_server(const remote::ServerSettings& settings,
                                             std::shared_ptr<AnswerCache> cache, const JobControl& job);

/// Plan whose views and masks have another size. Masks are smoothed where they grow.
edit::EditPlan plan_at_side(edit::EditPlan plan, int side);

}  // namespace gse::pipeline
