// The stand-in server as a child process, and orders for it.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include <nlohmann/json.hpp>

#include "engine/base/error.h"
#include "engine/remote/api/remote_api.h"

namespace gse::remote {

using Knobs = std::map<std::string, std::string>;

/// A server of one flavour. It ends with the object.
class StandIn {
public:
    /// `certificate` is a file with a certificate and its key, for TLS. Throws where it does not start.
    explicit StandIn(const std::string& flavour, const std::string& host = "127.0.0.1",
                     const std::filesystem::path& certificate = {}, int port = 0);
    ~StandIn();
    StandIn(const StandIn&) = delete;
    StandIn& operator=(const StandIn&) = delete;

    /// Forgets jobs, log and knobs, and sets these.
    void reset(const Knobs& knobs = {});
    void set(const Knobs& knobs);
    /// Requests so far, without those about the stand-in itself.
    nlohmann::json log();
    /// Requests whose path ends so.
    std::vector<nlohmann::json> asked(const std::string& end);
    /// Ends the program at once, as a crash would.
    void kill();
    /// Ends it and starts it again at its port: it knows nothing any more.
    void restart();

    std::string url() const;
    int port() const { return port_; }
    ServerAddress address() const;

private:
    nlohmann::json control(const std::string& place);
    void start();

    std::string flavour_;
    pid_t process_ = -1;
    int port_ = 0;
    std::string host_;
    std::filesystem::path certificate_;
};

/// Server on the first of UsualPorts that is free; null where none is.
std::unique_ptr<StandIn> stand_in_at_usual_port(const std::string& flavour);

/// The one server of a flavour that cases share, as if it had just been started.
StandIn& shared_stand_in(const std::string& flavour);

/// True where the stand-in can run; otherwise the case is to return: it counts as skipped.
bool can_stand_in();

/// Times that let no fault of speed happen by chance, and waste none.
ServerTimes patient_times();
/// Times after which a server that hangs is given up.
ServerTimes hasty_times();

/// Picture of 64 x 64 with soft colours, the mask a square in its middle.
RedrawOrder small_order(const std::string& prompt = "a golden bear");

/// Error that a body throws; -1 = it throws none.
struct Caught {
    int code = -1;
    std::string message, hint;

    bool is(ErrorCode wanted) const { return code == static_cast<int>(wanted); }
    bool says(const std::string& words) const { return message.find(words) != std::string::npos; }
};

template <class F> Caught caught(F&& body) {
    try {
        body();
    } catch (const Error& error) { return {static_cast<int>(error.code()), error.message(), error.hint()}; }
    return {};
}

}  // namespace gse::remote
