// Texts for the desktop, made of the table of scene formats.
#include "engine/io/formats/mime_types.h"

#include <fmt/core.h>

#include <algorithm>

#include "engine/io/formats/scene_formats.h"

namespace gse {
namespace {

constexpr int UsualMagicPriority = 50, UsualWeight = 50;

bool contains(const std::vector<std::string>& items, const std::string& item) {
    return std::find(items.begin(), items.end(), item) != items.end();
}

/// Endings of all formats of the type, without those that end in another one.
std::vector<std::string> patterns_of(const std::string& type) {
    std::vector<std::string> endings;
    for (const io::SceneFormat& format : scene_formats())
        if (format.mime.type == type)
            endings.insert(endings.end(), format.extensions.begin(), format.extensions.end());
    std::vector<std::string> shortest;
    for (const std::string& ending : endings)
        if (std::none_of(endings.begin(), endings.end(), [&](const std::string& other) {
                return other != ending && ending.ends_with(other);
            }))
            shortest.push_back("*" + ending);
    return shortest;
}

std::string magic_entry(const io::MimeType& mime) {
    if (mime.magic.empty()) return {};
    std::string text = mime.magic_priority == UsualMagicPriority
                           ? std::string("    <magic>\n")
                           : fmt::format("    <magic priority=\"{}\">\n", mime.magic_priority);
    for (const std::string& start : mime.magic)
        text += fmt::format("      <match type=\"string\" offset=\"0\" value=\"{}\"/>\n", start);
    return text + "    </magic>\n";
}

std::string entry_of(const io::MimeType& mime) {
    std::string text =
        fmt::format("  <mime-type type=\"{}\">\n    <comment>{}</comment>\n", mime.type, mime.comment);
    if (!mime.acronym.empty())
        text += fmt::format("    <acronym>{}</acronym>\n    <expanded-acronym>{}</expanded-acronym>\n",
                            mime.acronym, mime.expanded_acronym);
    if (!mime.parent.empty()) text += fmt::format("    <sub-class-of type=\"{}\"/>\n", mime.parent);
    if (mime.own_icon) text += "    <icon name=\"gseditpro\"/>\n";
    text += magic_entry(mime);
    const std::string weight = mime.weight == UsualWeight ? "" : fmt::format(" weight=\"{}\"", mime.weight);
    for (const std::string& pattern : patterns_of(mime.type))
        text += fmt::format("    <glob pattern=\"{}\"{}/>\n", pattern, weight);
    if (!mime.alias.empty()) text += fmt::format("    <alias type=\"{}\"/>\n", mime.alias);
    return text + "  </mime-type>\n";
}

}  // namespace

std::vector<std::string> scene_mime_types() {
    std::vector<std::string> types;
    for (const io::SceneFormat& format : scene_formats())
        if (!contains(types, format.mime.type)) types.push_back(format.mime.type);
    return types;
}

std::string scene_mime_entries() {
    std::string text;
    std::vector<std::string> written;
    for (const io::SceneFormat& format : scene_formats()) {
        if (contains(written, format.mime.type)) continue;
        written.push_back(format.mime.type);
        text += entry_of(format.mime);
    }
    return text;
}

std::vector<std::string> scene_keywords() {
    std::vector<std::string> words;
    for (const std::string& extension : readable_extensions()) {
        const std::string word = extension.substr(extension.rfind('.') + 1);
        if (!contains(words, word)) words.push_back(word);
    }
    return words;
}

}  // namespace gse
