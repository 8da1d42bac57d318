// Entry point of the shared library that speaks to image servers.
#include "engine/remote/api/remote_api.h"
#include "engine/remote/protocols/connect.h"

namespace gse::remote {
namespace {

class Plugin final : public RemoteApi {
public:
    std::unique_ptr<ImageServer> connect(const ServerAddress& address, const JobControl& job) override {
        return remote::connect(address, job);
    }
    std::vector<FoundServer> find_here(std::span<const int> ports, const JobControl& job) override {
        return remote::find_here(ports, job);
    }
    std::string keep_credentials(const std::string& url) override { return remote::keep_credentials(url); }
    void forget_credentials(const std::string& url) override { remote::forget_credentials(url); }
};

}  // namespace
}  // namespace gse::remote

extern "C" gse::remote::RemoteApi* gse_remote_api() {
    static gse::remote::Plugin plugin;
    return &plugin;
}
