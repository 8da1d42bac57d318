// Protocol B: picture edits of the OpenAI interface (/v1/images/edits), as several programs speak it.
#pragma once

#include <memory>

#include "engine/remote/api/image_server.h"
#include "engine/remote/protocols/openai_request.h"
#include "engine/remote/protocols/server_link.h"
#include "engine/remote/protocols/server_loras.h"

namespace gse::remote {

class OpenAiServer final : public ImageServer {
public:
    /// The address's model is the one to draw with; empty = the server's only one, else the server's choice.
    OpenAiServer(std::unique_ptr<ServerLink> link, const ServerAddress& address)
        : link_(std::move(link)), wanted_model_(address.model), wanted_loras_(address.loras),
          options_(address.options) {}
    ServerFacts probe(const JobControl& job) override;
    RedrawnPicture redraw(const RedrawOrder& order, const JobControl& job) override;

private:
    void choose_loras(ServerFacts& facts, const JobControl& job);

    std::unique_ptr<ServerLink> link_;
    const std::string wanted_model_;
    const std::vector<ServerLora> wanted_loras_;
    const std::vector<ServerOption> options_;
    std::vector<ChosenLora> loras_ = {};
    OpenAiProduct product_ = OpenAiProduct::Other;
    ServerFacts facts_;
};

}  // namespace gse::remote
