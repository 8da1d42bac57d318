// Checked requests for tests.
#pragma once

#include <string>

#include "engine/edit/request/checked_request.h"

namespace gse::test {

/// Request of these words with usual settings.
inline edit::CheckedRequest asked(const std::string& source, const std::string& prompt,
                                  const std::string& target) {
    edit::EditRequest request;
    request.source = source;
    request.prompt = prompt;
    request.target = target;
    return edit::check(request);
}

}  // namespace gse::test
