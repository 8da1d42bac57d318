// Time that image servers took for their pictures, by settings and model: the estimate of the next edit.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/session/state/estimate.h"
#include "app/session/state/server_news.h"

namespace gse::app {

class ServerCosts {
public:
    /// Most entries that are kept; the oldest go.
    static constexpr std::size_t Most = 32;

    /// Takes what a server has drawn so far; nothing where it drew none.
    void measure(const ServerNews& news);
    /// Pictures that these edits ask a server for, and their time where such were drawn before. `model`: that
    /// the server has loaded; empty = not known.
    ServerCost cost_of(const std::vector<PlannedEdit>& edits, const remote::ServerSettings& settings,
                       const std::string& model) const;
    void forget() { measured_.clear(); }

    nlohmann::json to_json() const;
    /// Takes what to_json() gave. Entries that are none are left out.
    void take(const nlohmann::json& json);

private:
    /// Way in which pictures were drawn, and seconds for one.
    struct Measured {
        std::string key, model;
        remote::Agreement agreement = remote::Agreement::None;
        double seconds = 0;
    };
    void keep(Measured entry);

    std::vector<Measured> measured_;  // the newest last
};

}  // namespace gse::app
