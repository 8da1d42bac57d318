// The table of scene formats: whole in itself, and the one place from which lists, texts and types follow.
#include <algorithm>
#include <cctype>
#include <fstream>
#include <regex>
#include <set>

#include "engine/io/formats/mime_types.h"
#include "engine/io/formats/scene_formats.h"
#include "tests/unit/io/io_helpers.h"

namespace gse::test {
namespace {

/// Tells whether `text` holds `word`, not as a part of a longer name ("a.splat" in "a.ksplat").
bool names(const std::string& text, const std::string& word) {
    const auto inner = [](char letter) {
        return std::isalnum(static_cast<unsigned char>(letter)) != 0 || letter == '.';
    };
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
        const std::size_t end = at + word.size();
        const bool begins = at == 0 || !inner(text[at - 1]);
        const bool ends = end == text.size() || !inner(text[end]) || text[end] == '.';
        if (begins && ends) return true;
    }
    return false;
}

/// The rows of the Markdown tables in a document.
std::vector<std::vector<std::string>> table_rows(const std::filesystem::path& document) {
    std::vector<std::vector<std::string>> rows;
    std::ifstream stream(document);
    for (std::string line; std::getline(stream, line);) {
        if (!line.starts_with("| ")) continue;
        std::vector<std::string> cells;
        for (std::size_t begin = 1, end; (end = line.find('|', begin)) != std::string::npos; begin = end + 1)
            cells.push_back(line.substr(begin, end - begin));
        rows.push_back(cells);
    }
    return rows;
}

std::string without_comment(const std::string& line) { return line.substr(0, line.find("//")); }

}  // namespace

DOCTEST_TEST_CASE("a name takes the ending of another format, and each format says what it keeps") {
    std::set<std::string> said;
    for (const io::SceneFormat& format : scene_formats()) {
        if (!format.writable()) continue;
        const auto& ending = format.extensions.front();
        for (const char* name : {"a/bear", "a/bear.ply", "a/bear.compressed.ply", "a/bear.SPZ", "a/bear.obj"})
            DOCTEST_CHECK(
                with_ending(name, format) ==
                std::filesystem::path(format_written_to(name) == &format ? name : "a/bear" + ending));
        DOCTEST_CHECK(with_ending("my.bear.ply", format) == std::filesystem::path("my.bear" + ending));
        DOCTEST_CHECK(format_written_to(with_ending("bear.ksplat", format)) == &format);
        const auto text = kept_text(format);
        DOCTEST_CHECK((text.find("every bit") != std::string::npos) == format.exact);
        DOCTEST_CHECK((text.find("labels") < text.find("Leaves out")) == format.keeps_labels);
        said.insert(text);
    }
    DOCTEST_CHECK(said.size() > 1);
}

DOCTEST_TEST_CASE(
    "every scene format is whole: names, an ending, a reader, and options with values in order") {
    std::set<std::string> seen;
    for (const io::SceneFormat& format : scene_formats()) {
        DOCTEST_CAPTURE(format.name);
        DOCTEST_CHECK(seen.insert(format.name).second);
        DOCTEST_CHECK(find_format(format.name) == &format);
        DOCTEST_CHECK_FALSE(format.title.empty());
        DOCTEST_CHECK_FALSE(format.mime.type.empty());
        DOCTEST_REQUIRE_FALSE(format.extensions.empty());
        DOCTEST_CHECK(format.readable());
        DOCTEST_CHECK((format.read_parts != nullptr) == !format.file_names.empty());
        for (const std::string& extension : format.extensions) {
            DOCTEST_CHECK(extension.starts_with('.'));
            if (format.writable()) DOCTEST_CHECK(format_written_to("a" + extension) == &format);
        }
        for (const io::FormatOption& option : format.options)
            for (std::size_t at = 0; at < option.values.size(); ++at)
                DOCTEST_CHECK(option.values[at].value == option.values.front().value + static_cast<int>(at));
    }
    DOCTEST_CHECK(find_format("none") == nullptr);
    DOCTEST_CHECK(format_written_to("a.txt") == nullptr);
    DOCTEST_CHECK(format_written_to("A.Compressed.PLY") == find_format("compressed.ply"));
}

DOCTEST_TEST_CASE("errors name every scene format of the table") {
    const auto unknown = error_of([] { parse_scene(as_bytes("hello"), "a.txt"); });
    DOCTEST_REQUIRE(unknown);
    for (const std::string& name : readable_names()) DOCTEST_CHECK(names(unknown->hint(), name));
    const ScratchFolder scratch;
    const Scene scene = random_scene(2, 0, 1);
    const auto ending = error_of([&] { save_scene(scratch.path() / "a.xyz", scene); });
    const auto format = error_of([&] { save_scene(scratch.path() / "a.ply", scene, {.format = "xyz"}); });
    DOCTEST_REQUIRE(ending);
    DOCTEST_REQUIRE(format);
    for (const std::string& extension : writable_extensions())
        DOCTEST_CHECK(names(ending->hint(), extension));
    for (const std::string& name : writable_formats()) DOCTEST_CHECK(names(format->hint(), name));
}

DOCTEST_TEST_CASE("formats that a .txt file could be are told by their endings only") {
    for (const io::SceneFormat& format : scene_formats()) {
        if (!format.writable()) continue;
        DOCTEST_CAPTURE(format.name);
        const std::string bytes = written_as(format.name, random_scene(3, 0, 2));
        const auto read = [&](const std::string& name) {
            return parse_scene(as_bytes(bytes), name).info.format;
        };
        DOCTEST_CHECK(read("a" + format.extensions.front()) == format.name);
        if (format.detect != nullptr) DOCTEST_CHECK(read("a.txt") == format.name);
        else DOCTEST_CHECK(error_of([&] { read("a.txt"); }));
    }
}

DOCTEST_TEST_CASE("the MIME database has one type per format and a pattern for every ending") {
    const std::string entries = scene_mime_entries();
    std::set<std::string> types;
    for (const std::string& type : scene_mime_types()) {
        DOCTEST_CHECK(types.insert(type).second);
        DOCTEST_CHECK(entries.find("<mime-type type=\"" + type + "\">") != std::string::npos);
    }
    std::vector<std::string> patterns;
    const std::regex pattern("glob pattern=\"\\*([^\"]+)\"");
    for (std::sregex_iterator at(entries.begin(), entries.end(), pattern), end; at != end; ++at)
        patterns.push_back((*at)[1]);
    for (const std::string& extension : readable_extensions()) {
        DOCTEST_CAPTURE(extension);
        DOCTEST_CHECK(std::count_if(patterns.begin(), patterns.end(), [&](const std::string& ending) {
                          return extension.ends_with(ending);
                      }) == 1);
    }
}

DOCTEST_TEST_CASE("README and guide name every scene format, and whether it is written") {
    const auto formats = table_rows(source_folder() / "README.md");
    const auto exports = table_rows(source_folder() / "assets/guide/exports.md");
    const auto row_of = [](const auto& rows, const io::SceneFormat& format) {
        return std::find_if(rows.begin(), rows.end(), [&](const auto& row) {
            return names(row[0], format.extensions.front()) || row[0].starts_with(" " + format.title + " ") ||
                   row[0].starts_with(" 3DGS " + format.title + " ");
        });
    };
    for (const io::SceneFormat& format : scene_formats()) {
        DOCTEST_CAPTURE(format.name);
        const auto row = row_of(formats, format);
        DOCTEST_REQUIRE(row != formats.end());
        DOCTEST_REQUIRE(row->size() == 3);
        DOCTEST_CHECK((*row)[1] != " no ");
        DOCTEST_CHECK(((*row)[2] != " no ") == format.writable());
        DOCTEST_CHECK((row_of(exports, format) != exports.end()) == format.writable());
        for (const std::string& file : format.file_names)
            DOCTEST_CHECK(std::any_of(formats.begin(), formats.end(),
                                      [&](const auto& line) { return names(line[0], file); }));
    }
}

DOCTEST_TEST_CASE(
    "no other source names the ending of a scene format: lists, filters, helps and texts follow") {
    std::vector<std::string> words;
    for (const std::string& name : readable_names())
        if (name != ".ply" && name != "meta.json") words.push_back(name);  // names of other files too
    for (const char* folder : {"app", "ui", "engine"})
        for (const auto& entry : std::filesystem::recursive_directory_iterator(source_folder() / folder)) {
            const std::string path = entry.path().string(), ending = entry.path().extension().string();
            if ((ending != ".cpp" && ending != ".h") || path.find("engine/io/formats/") != std::string::npos)
                continue;
            std::ifstream stream(entry.path());
            for (std::string line; std::getline(stream, line);)
                for (const std::string& word : words)
                    DOCTEST_CHECK_MESSAGE(!names(without_comment(line), word), path, ": ", line);
        }
}

}  // namespace gse::test
