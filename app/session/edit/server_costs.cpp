// A short list, and counts of pictures by the way they are drawn.
#include "app/session/edit/server_costs.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "app/session/state/json_values.h"
#include "engine/base/content_hash.h"
#include "engine/base/error.h"
#include "engine/edit/request/decide_mode.h"
#include "engine/edit/target_views/view_round.h"

namespace gse::app {
namespace {

constexpr double LongestPicture = 86'400;  // seconds
constexpr std::size_t LongestName = 256;

/// Key of the settings that decide how long a picture takes, and how many are asked for.
std::string key_of(remote::ServerSettings settings) {
    const bool follows = !settings.target_picture.empty();
    settings.target_picture.clear();
    settings.key_view.clear();
    ContentHash hash;
    hash.fields(settings);
    hash.numbers(follows);
    return hash.key().hex();
}

/// Pictures that are asked for to draw a round, where each is of use at once. `own` of the views are there.
int pictures_for(int views, int own, remote::Agreement agreement) {
    constexpr int cells = 4;  // of a sheet, the first of which shows the first view again
    const int missing = std::max(0, views - own);
    if (agreement == remote::Agreement::Sheet && missing > 0)
        return own > 0 ? (missing + cells - 2) / (cells - 1) : 1 + std::max(0, (missing - 2) / (cells - 1));
    if (agreement == remote::Agreement::Warp)  // filled, then closed; the first is drawn by itself
        return own > 0 ? 2 * missing : std::max(0, 2 * missing - 1);
    return missing;
}

}  // namespace

void ServerCosts::keep(Measured entry) {
    std::erase_if(measured_,
                  [&](const auto& other) { return other.key == entry.key && other.model == entry.model; });
    measured_.push_back(std::move(entry));
    if (measured_.size() > Most) measured_.erase(measured_.begin());
}

void ServerCosts::measure(const ServerNews& news) {
    const auto& use = news.drawing.use;
    if (use.requests == 0) return;
    const double seconds = use.seconds / static_cast<double>(use.requests);
    keep({key_of(news.settings), news.model, news.agreement, std::clamp(seconds, 0.0, LongestPicture)});
}

ServerCost ServerCosts::cost_of(const std::vector<PlannedEdit>& edits, const remote::ServerSettings& settings,
                                const std::string& model) const {
    const auto key = key_of(settings);
    const auto found = std::find_if(measured_.rbegin(), measured_.rend(), [&](const auto& one) {
        return one.key == key && (model.empty() || one.model.empty() || one.model == model);
    });
    const bool known = found != measured_.rend();
    const auto own = static_cast<int>(settings.target_picture.size());
    ServerCost cost;
    for (const auto& edit : edits) {
        if (!edit.made || !edit::is_drawn(edit.work.mode)) continue;
        const auto plan = edit::round_plan(edit.request, edit.work.mode);
        cost.pictures +=
            plan.rounds * pictures_for(plan.views, own, known ? found->agreement : remote::Agreement::None);
    }
    if (known) cost.seconds = cost.pictures * found->seconds;
    return cost;
}

nlohmann::json ServerCosts::to_json() const {
    auto json = nlohmann::json::array();
    for (const auto& one : measured_)
        json.push_back({{"settings", one.key},
                        {"model", one.model},
                        {"agreement", remote::agreement_name(one.agreement)},
                        {"seconds", one.seconds}});
    return json;
}

void ServerCosts::take(const nlohmann::json& json) {
    if (!json.is_array()) return;
    for (const auto& one : json) {
        if (!one.is_object() || !one.contains("seconds") || !one["seconds"].is_number()) continue;
        Measured read{text_of(one, "settings"), text_of(one, "model")};
        read.seconds = one["seconds"].get<double>();
        if (read.key.empty() || read.key.size() > LongestName || read.model.size() > LongestName) continue;
        if (!(read.seconds >= 0 && read.seconds <= LongestPicture)) continue;
        try {
            read.agreement = remote::agreement_of(text_of(one, "agreement"));
        } catch (const Error&) { continue; }  // of another version
        keep(std::move(read));
    }
}

}  // namespace gse::app
