// Subjects on one page that needs no other file.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/laboratory/bench/charts/subject.h"

namespace gse::bench {

/// One subject on the page: `png` is its picture as a file's bytes; `notes` stand above the picture.
struct PageSection {
    std::string title;
    std::vector<std::string> notes;
    std::string png;
    std::vector<Table> tables;
    std::vector<std::string> remarks;
    nlohmann::ordered_json parameters;
};

/// An HTML page with the pictures in it. `machine`: names and values at the top.
std::string html_page(const std::string& title, const nlohmann::ordered_json& machine,
                      std::span<const PageSection> sections);

/// RFC 4648, with padding.
std::string base64_text(std::string_view bytes);

}  // namespace gse::bench
