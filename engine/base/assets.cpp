// Folder of the running program, from /proc/self/exe.
#include "engine/base/assets.h"

namespace gse {

std::filesystem::path assets_beside(const std::filesystem::path& program,
                                    const std::filesystem::path& checkout) {
    const auto installed = (program / "../share/gseditpro").lexically_normal();
    std::error_code ignored;
    return std::filesystem::is_directory(installed, ignored) ? installed : checkout;
}

std::filesystem::path assets_folder(const std::filesystem::path& checkout) {
    return assets_beside(std::filesystem::read_symlink("/proc/self/exe").parent_path(), checkout);
}

}  // namespace gse
