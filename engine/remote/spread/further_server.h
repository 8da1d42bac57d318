// Servers that draw beside the first one.
#pragma once

#include <cstddef>
#include <string>

#include "engine/remote/api/image_server.h"

namespace gse::remote {

/// Server of the same kind with the same model as the first one.
struct FurtherServer {
    ImageServer* server = nullptr;
    std::string name;       // for people
    std::size_t drawn = 0;  // pictures
    bool left_out = false;  // since it failed
};

/// Name of a server with its facts.
struct NamedServer {
    const std::string& name;
    const ServerFacts& facts;
};

/// Throws Error (InvalidArgument) where two servers speak two protocols, or tell of two models.
void check_alike(const NamedServer& first, const NamedServer& further);

}  // namespace gse::remote
