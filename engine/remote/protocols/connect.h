// Connection to an image server of any kind.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "engine/remote/api/remote_api.h"

namespace gse::remote {

/// See RemoteApi::connect().
std::unique_ptr<ImageServer> connect(const ServerAddress& address, const JobControl& job);

/// See RemoteApi::find_here().
std::vector<FoundServer> find_here(std::span<const int> ports, const JobControl& job);

/// See RemoteApi::keep_credentials().
std::string keep_credentials(const std::string& url);

/// As RemoteApi::forget_credentials().
void forget_credentials(const std::string& url);

}  // namespace gse::remote
