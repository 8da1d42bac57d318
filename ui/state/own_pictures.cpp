// Pictures of the artist's own that views of the next edit shall look like.
#include "ui/state/own_pictures.h"

#include <fmt/format.h>

#include "engine/remote/api/server_settings.h"
#include "ui/state/state.h"
#include "ui/widgets/folder_listing.h"

namespace gse::ui {

std::string own_picture_of(const remote::ServerSettings& settings, const std::string& view) {
    for (const auto& text : settings.target_picture)
        if (const auto own = remote::target_picture_of(text); own.view == view) return utf8_of(own.file);
    return {};
}

remote::ServerSettings with_own_picture(remote::ServerSettings settings, const std::string& view,
                                        const std::string& file) {
    std::erase_if(settings.target_picture,
                  [&](const std::string& text) { return remote::target_picture_of(text).view == view; });
    if (!file.empty()) settings.target_picture.push_back(fmt::format("{}={}", view, file));
    return settings;
}

bool is_own_picture(const Context& context, const std::vector<std::string>& paths) {
    const std::vector<std::string> pictures{".png", ".jpg", ".jpeg"};
    return context.model.server.on && !context.state.targets.view.empty() && paths.size() == 1 &&
           has_extension(paths.front(), pictures);
}

}  // namespace gse::ui
