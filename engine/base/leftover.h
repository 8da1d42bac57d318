// Tells leftovers of a killed run from files of a living one.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace gse {

/// "PROCESS-NUMBER-BOOT", part of a temporary name. Differs from the mark of any other writer on this
/// machine.
std::string writer_mark();

/// Locks an open file or folder for as long as its descriptor lives. File systems without locks are passed
/// over.
void hold(int descriptor);

/// True when the writer that gave `path` this mark is gone: nobody holds the lock, and its process has ended.
/// For marks of another machine or an earlier boot, an age of `foreign_age_seconds` decides. False for a text
/// that is no mark, and in doubt.
bool is_left_over(const std::filesystem::path& path, std::string_view mark, double foreign_age_seconds);

}  // namespace gse
