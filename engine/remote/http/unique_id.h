// Numbers that no other client has.
#pragma once

#include <string>

namespace gse::remote {

/// Random UUID (version 4) in small letters.
std::string unique_id();

}  // namespace gse::remote
