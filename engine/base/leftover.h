// Telling what a killed run left behind from what a living one is writing.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace gse {

/// "PROCESS-NUMBER-BOOT": unlike that of any other writer on this machine; it becomes part of the temporary
/// name.
std::string writer_mark();

/// Locks an open file or folder for as long as its descriptor lives. Places without locks are passed over.
void hold(int descriptor);

/// True when the writer that gave `path` this mark is gone: nobody holds it, and its process is not there (on
/// this machine), or nothing was changed for `foreign_age_seconds` (from another machine, or before the last
/// start). False for a text that is no mark, and in doubt.
bool is_left_over(const std::filesystem::path& path, std::string_view mark, double foreign_age_seconds);

}  // namespace gse
