// Reading of torch's messages.
#include "engine/neural/layers/torch_errors.h"

#include <cstdlib>
#include <regex>

namespace gse::neural {

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

std::uint64_t refused_bytes(const std::string& text) {
    static const std::regex pattern("ried to allocate ([0-9.]+) ?([KMG]i)?[Bb]");
    std::smatch found;
    if (!std::regex_search(text, found, pattern)) return 0;
    const std::string unit = found[2];
    const double factor = unit == "Ki"   ? 1024.0
                          : unit == "Mi" ? 1048576.0
                          : unit == "Gi" ? 1073741824.0
                                         : 1.0;
    return static_cast<std::uint64_t>(std::strtod(found[1].str().c_str(), nullptr) * factor);
}

}  // namespace gse::neural
