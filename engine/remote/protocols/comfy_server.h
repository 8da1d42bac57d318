// Protocol D: ComfyUI, which runs a workflow.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/remote/api/image_server.h"
#include "engine/remote/protocols/server_link.h"
#include "engine/remote/workflow/workflow.h"

namespace gse::remote {

class ComfyServer final : public ImageServer {
public:
    ComfyServer(std::unique_ptr<ServerLink> link, const ServerAddress& address);
    ServerFacts probe(const JobControl& job) override;
    RedrawnPicture redraw(const RedrawOrder& order, const JobControl& job) override;

private:
    bool is_bundled() const;
    /// Chooses among the bundled workflows by the node that loads the model.
    void choose_bundled(const std::vector<std::string>& checkpoints, const std::vector<std::string>& unets);
    void choose_loras(const std::vector<std::string>& names);
    /// The workflow for an order, checked against the nodes and models that the server has.
    const Workflow& workflow_for(const RedrawOrder& order, const JobControl& job);
    /// Uploads the pictures of an order; gives the values with the names that they have there.
    WorkflowValues uploaded(const RedrawOrder& order, const Workflow& workflow, const JobControl& job);
    std::string upload(const std::string& png, const JobControl& job);
    /// Uploads and submits; gives the number of the job in the server's queue.
    std::string send(const RedrawOrder& order, const Workflow& workflow, const JobControl& job);
    std::string submit(const nlohmann::json& graph, const JobControl& job);
    /// Outputs of a finished job; null where the server does not know it.
    nlohmann::json wait_for_job(const std::string& id, const JobControl& job);
    /// True while the job waits or runs; reports its place.
    bool is_queued(const std::string& id, const JobControl& job);
    Image picture_of(const nlohmann::json& outputs, const std::string& node, const RedrawOrder& order,
                     const JobControl& job);

    std::unique_ptr<ServerLink> link_;
    const std::filesystem::path workflow_;  // of the artist, or a bundled one; empty = what fits
    std::string bundled_ = {};              // "edit", or empty: by what an order holds
    const std::string wanted_model_;
    const std::vector<ServerLora> wanted_loras_;
    const std::vector<ServerOption> options_;
    const bool paid_nodes_;
    const std::string client_;
    std::string upload_type_ = "temp";
    std::string loaded_name_ = {};
    std::optional<Workflow> loaded_ = {};
    std::string model_ = {};
    std::vector<std::pair<std::string, double>> loras_ = {};  // names as the server has them, weights
    ServerFacts facts_ = {};
};

}  // namespace gse::remote
