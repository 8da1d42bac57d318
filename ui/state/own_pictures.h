// Pictures of the artist's own that views of the next edit shall look like.
#pragma once

#include <string>
#include <vector>

#include "ui/model/context.h"

namespace gse::ui {

/// File for a view; empty = it has none.
std::string own_picture_of(const remote::ServerSettings& settings, const std::string& view);
/// Settings with a file for the view in place of an earlier one; empty = without one.
remote::ServerSettings with_own_picture(remote::ServerSettings settings, const std::string& view,
                                        const std::string& file);
/// True for one picture that is dropped while a view of Targets is selected and a server draws.
bool is_own_picture(const Context& context, const std::vector<std::string>& paths);

}  // namespace gse::ui
