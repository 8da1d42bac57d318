// HTML by hand: a head, sections, tables, pictures as data.
#include "engine/laboratory/bench/charts/page.h"

#include <fmt/format.h>

#include <cstdint>

#include "engine/laboratory/bench/charts/pareto_chart.h"

namespace gse::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* Style =
    "body{font:15px/1.45 sans-serif;color:#1f1f24;max-width:1230px;margin:2em auto;padding:0 1em}"
    "h1{font-size:1.5em}h2{font-size:1.2em;margin-top:2.5em;border-top:1px solid #ccc;padding-top:1em}"
    "img{width:100%;max-width:1200px;height:auto;border:1px solid #ddd}"
    "table{border-collapse:collapse;margin:1em 0}caption{text-align:left;font-weight:bold;padding:.3em 0}"
    "th,td{padding:.15em .8em;border-bottom:1px solid "
    "#e2e2e6;text-align:right;font-variant-numeric:tabular-nums}"
    "th:first-child,td:first-child{text-align:left}p.note,details{color:#555}tr.default "
    "td{background:#f1f5fb}";

std::string escaped(std::string_view text) {
    std::string safe;
    for (const char c : text) {
        if (c == '&') safe += "&amp;";
        else if (c == '<') safe += "&lt;";
        else if (c == '>') safe += "&gt;";
        else if (c == '"') safe += "&quot;";
        else safe += c;
    }
    return safe;
}

std::string value_text(const Json& value) {
    if (value.is_number()) return number_text(value.get<double>());
    return value.is_string() ? value.get<std::string>() : value.dump();
}

std::string table_html(const Table& table) {
    std::string html = "<table>";
    if (!table.title.empty()) html += "<caption>" + escaped(table.title) + "</caption>";
    html += "<tr>";
    for (const auto& cell : table.head) html += "<th>" + escaped(cell) + "</th>";
    html += "</tr>\n";
    for (const auto& row : table.rows) {
        html += !row.empty() && row.back() == "default" ? "<tr class=\"default\">" : "<tr>";
        for (const auto& cell : row) html += "<td>" + escaped(cell) + "</td>";
        html += "</tr>\n";
    }
    return html + "</table>\n";
}

std::string pairs_html(const Json& pairs) {
    std::string html = "<table>";
    for (const auto& [name, value] : pairs.items())
        html += "<tr><td>" + escaped(name) + "</td><td>" + escaped(value_text(value)) + "</td></tr>\n";
    return html + "</table>\n";
}

std::string section_html(const PageSection& section) {
    std::string html = "<h2>" + escaped(section.title) + "</h2>\n";
    for (const auto& note : section.notes) html += "<p class=\"note\">" + escaped(note) + "</p>\n";
    if (!section.png.empty())
        html += "<img alt=\"" + escaped(section.title) + "\" src=\"data:image/png;base64," +
                base64_text(section.png) + "\">\n";
    for (const auto& remark : section.remarks) html += "<p>" + escaped(remark) + "</p>\n";
    for (const auto& table : section.tables) html += table_html(table);
    if (section.parameters.is_object() && !section.parameters.empty())
        html += "<details><summary>Parameters</summary>" + pairs_html(section.parameters) + "</details>\n";
    return html;
}

}  // namespace

std::string html_page(const std::string& title, const Json& machine, std::span<const PageSection> sections) {
    std::string html = "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>" +
                       escaped(title) + "</title><style>" + Style + "</style></head><body>\n<h1>" +
                       escaped(title) + "</h1>\n" + pairs_html(machine);
    for (const auto& section : sections) html += section_html(section);
    return html + "</body></html>\n";
}

std::string base64_text(std::string_view bytes) {
    constexpr std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const auto count = std::min<std::size_t>(3, bytes.size() - i);
        std::uint32_t bits = 0;
        for (std::size_t k = 0; k < 3; ++k)
            bits = bits << 8 | (k < count ? static_cast<std::uint8_t>(bytes[i + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k) text += k <= count ? letters[bits >> (18 - 6 * k) & 63u] : '=';
    }
    return text;
}

}  // namespace gse::bench
