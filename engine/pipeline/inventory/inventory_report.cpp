// Columns: name, kind, size, use; a reason stands on a line of its own.
#include "engine/pipeline/inventory/inventory_report.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/base/path_text.h"
#include "engine/base/printable.h"

namespace gse::pipeline {
namespace {

using neural::WeightPlace;

constexpr std::size_t Columns = 100, NameColumns = 34, KindColumns = 38, SizeColumns = 7;
constexpr std::size_t LongestOption = 8;  // that has room in the last column

/// Columns of a terminal, a character of UTF-8 each.
std::size_t width_of(const std::string& text) {
    return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char letter) {
        return (static_cast<unsigned char>(letter) & 0xc0) != 0x80;
    }));
}

/// The text without its middle where it is longer than `columns`, and padded where it is shorter.
std::string fitted(const std::string& text, std::size_t columns) {
    const auto width = width_of(text);
    if (width <= columns) return text + std::string(columns - width, ' ');
    constexpr std::size_t Dots = 3;
    const std::size_t front = (columns - Dots) / 2, back = columns - Dots - front;
    const auto byte_of = [&](std::size_t character) {
        std::size_t at = 0;
        for (std::size_t seen = 0; at < text.size(); ++at)
            if ((static_cast<unsigned char>(text[at]) & 0xc0) != 0x80 && seen++ == character) break;
        return at;
    };
    return text.substr(0, byte_of(front)) + "..." + text.substr(byte_of(width - back));
}

std::string size_text(std::uint64_t bytes) {
    const auto count = static_cast<double>(bytes);
    if (count >= 1e9) return fmt::format("{:.1f} GB", count / 1e9);
    if (count >= 1e6) return fmt::format("{:.0f} MB", count / 1e6);
    return fmt::format("{:.0f} kB", std::max(count / 1e3, bytes > 0 ? 1.0 : 0.0));
}

bool has_room(const std::string& how) { return how.starts_with("--") && how.size() <= LongestOption; }

std::string use_word(const ModelFile& file) {
    switch (file.use.place) {
        case WeightPlace::Here: return has_room(file.use.how) ? "here " + file.use.how : "here";
        case WeightPlace::Server: return "server";
        case WeightPlace::Nowhere: break;
    }
    return file.broken ? "broken" : "no";
}

/// Lines of at most Columns columns, broken at spaces.
std::string wrapped(const std::string& text, const std::string& indent) {
    std::string lines, line;
    for (std::size_t at = 0; at < text.size();) {
        const auto end = std::min(text.find(' ', at), text.size());
        const auto word = text.substr(at, end - at);
        if (!line.empty() && indent.size() + width_of(line) + 1 + width_of(word) > Columns) {
            lines += indent + line + "\n";
            line.clear();
        }
        line += (line.empty() ? "" : " ") + word;
        at = end + 1;
    }
    return line.empty() ? lines : lines + indent + line + "\n";
}

/// Remark below a row; empty where the row says all.
std::string remark_of(const ModelFile& file) {
    if (file.use.place == WeightPlace::Here) return has_room(file.use.how) ? "" : file.use.how;
    const bool driven = file.use.place == WeightPlace::Server && !file.server_family.empty();
    return driven ? fmt::format("{} (--server-family {})", file.use.why, file.server_family) : file.use.why;
}

std::string row_text(const ModelFile& file) {
    auto text = fmt::format(
        "  {}  {}  {:>{}}  {}\n", fitted(printable(file.path.filename().string()), NameColumns),
        fitted(printable(file.kind), KindColumns), size_text(file.bytes), SizeColumns, use_word(file));
    return text + wrapped(printable(remark_of(file)), "      ");
}

std::string looked_at_text(const ModelInventory& inventory) {
    std::string text = "No models were found. Looked at:\n";
    for (const auto& place : inventory.folders)
        text += fmt::format("  {}{}{}\n", printable(place.folder.string()),
                            place.program.empty() ? "" : " (" + place.program + ")",
                            place.found ? "" : ": not there");
    return text + "Name a folder: gseditpro models FOLDER\n";
}

std::string totals_text(const ModelInventory& inventory) {
    const auto count = [&](WeightPlace place) {
        return std::count_if(inventory.files.begin(), inventory.files.end(),
                             [&](const ModelFile& file) { return file.use.place == place; });
    };
    auto text =
        fmt::format("\n{} found: {} loaded here, {} through a server, {} not used\n", inventory.files.size(),
                    count(WeightPlace::Here), count(WeightPlace::Server), count(WeightPlace::Nowhere));
    if (count(WeightPlace::Server) > 0)
        text += "Start a server with such a model and name it: gseditpro edit ... --server URL\n";
    if (inventory.cut_short) text += "There is more than is listed here: name single folders.\n";
    return text;
}

}  // namespace

nlohmann::ordered_json inventory_json(const ModelInventory& inventory) {
    using Json = nlohmann::ordered_json;
    Json folders = Json::array(), models = Json::array();
    for (const auto& place : inventory.folders)
        folders.push_back({{"path", text_of_path(place.folder.string())},
                           {"program", place.program},
                           {"found", place.found}});
    for (const auto& file : inventory.files)
        models.push_back({{"path", text_of_path(file.path.string())},
                          {"kind", file.kind},
                          {"bytes", file.bytes},
                          {"use", file.use.place == WeightPlace::Here     ? "here"
                                  : file.use.place == WeightPlace::Server ? "server"
                                                                          : "none"},
                          {"option", file.use.how.starts_with("--") ? file.use.how : ""},
                          {"reason", file.use.why},
                          {"server_family", file.server_family},
                          {"broken", file.broken}});
    return {{"folders", folders}, {"models", models}, {"complete", !inventory.cut_short}};
}

std::string inventory_text(const ModelInventory& inventory) {
    if (inventory.files.empty()) return looked_at_text(inventory);
    std::string text;
    std::filesystem::path folder;
    for (const auto& file : inventory.files) {
        if (text.empty() || file.path.parent_path() != folder) {
            folder = file.path.parent_path();
            text += fmt::format("{}{}\n", text.empty() ? "" : "\n", printable(folder.string()));
        }
        text += row_text(file);
    }
    return text + totals_text(inventory);
}

}  // namespace gse::pipeline
