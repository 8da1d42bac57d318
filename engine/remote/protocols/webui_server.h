// Protocol A: WebUI (/sdapi/v1) as A1111, Forge, SD.Next, koboldcpp and sd-server speak it.
#pragma once

#include <memory>

#include "engine/remote/api/image_server.h"
#include "engine/remote/protocols/server_link.h"
#include "engine/remote/protocols/server_loras.h"
#include "engine/remote/protocols/webui_request.h"

namespace gse::remote {

class WebuiServer final : public ImageServer {
public:
    /// The address's model is switched to when the server is first asked; empty = the one that is loaded.
    WebuiServer(std::unique_ptr<ServerLink> link, WebuiProduct product, const ServerAddress& address)
        : link_(std::move(link)), product_(product), wanted_model_(address.model),
          wanted_loras_(address.loras), options_(address.options) {}
    ServerFacts probe(const JobControl& job) override;
    RedrawnPicture redraw(const RedrawOrder& order, const JobControl& job) override;

private:
    void read_models(ServerFacts& facts, const JobControl& job);
    void switch_model(ServerFacts& facts, const JobControl& job);
    void stop_task(const std::string& task);

    std::unique_ptr<ServerLink> link_;
    const WebuiProduct product_;
    const std::string wanted_model_;
    const std::vector<ServerLora> wanted_loras_;
    const std::vector<ServerOption> options_;
    std::vector<ChosenLora> loras_ = {};
    ServerFacts facts_;
};

}  // namespace gse::remote
