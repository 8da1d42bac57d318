// Fills in a desktop template with the table of scene formats: gse_desktop_files TEMPLATE OUTPUT, when the
// package is built.
#include <cstdio>
#include <exception>
#include <string>

#include "engine/base/file.h"
#include "engine/io/formats/mime_types.h"

namespace {

std::string each_ended(const std::vector<std::string>& items) {
    std::string text;
    for (const std::string& item : items) text += item + ";";
    return text;
}

void fill(std::string& text, const std::string& mark, const std::string& value) {
    const std::size_t at = text.find(mark);
    if (at != std::string::npos) text.replace(at, mark.size(), value);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 3) return 2;
    try {
        std::string text = gse::read_file(argv[1]);
        fill(text, "@SCENE_MIME_ENTRIES@", gse::scene_mime_entries());
        fill(text, "@SCENE_MIME_TYPES@", each_ended(gse::scene_mime_types()));
        fill(text, "@SCENE_KEYWORDS@", each_ended(gse::scene_keywords()));
        gse::write_file(argv[2], text);
    } catch (const std::exception& failure) {
        std::fprintf(stderr, "%s\n", failure.what());
        return 1;
    }
    return 0;
}
