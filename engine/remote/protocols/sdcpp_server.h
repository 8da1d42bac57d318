// Protocol C: sd-server's jobs (stable-diffusion.cpp, /sdcpp/v1).
#pragma once

#include <memory>

#include <nlohmann/json.hpp>

#include "engine/remote/api/image_server.h"
#include "engine/remote/protocols/server_link.h"
#include "engine/remote/protocols/server_loras.h"

namespace gse::remote {

/// Body of POST img_gen.
nlohmann::json sdcpp_body(const RedrawOrder& order);

/// Steps to ask of samplers that run the last int(strength * steps) + 1 of `steps`, so that `real` ones run.
int steps_to_ask_of_levels(int real, double strength);

/// Name of a sampler as sd-server's jobs know it ("euler" for "Euler"). They pass over other spellings, and
/// draw with an ancestral sampler.
std::string sdcpp_sampler(std::string_view name);

class SdCppServer final : public ImageServer {
public:
    /// The address's model is the one that it must have; empty = any.
    SdCppServer(std::unique_ptr<ServerLink> link, const ServerAddress& address)
        : link_(std::move(link)), wanted_model_(address.model), wanted_loras_(address.loras),
          options_(address.options) {}
    ServerFacts probe(const JobControl& job) override;
    RedrawnPicture redraw(const RedrawOrder& order, const JobControl& job) override;

private:
    std::string submit(const nlohmann::json& body, const JobControl& job);
    /// The finished job; null where the server does not know it.
    nlohmann::json wait_for_job(const std::string& id, std::size_t most_bytes, const JobControl& job);

    std::unique_ptr<ServerLink> link_;
    const std::string wanted_model_;
    const std::vector<ServerLora> wanted_loras_;
    const std::vector<ServerOption> options_;
    std::vector<ChosenLora> loras_ = {};
    ServerFacts facts_;
};

}  // namespace gse::remote
