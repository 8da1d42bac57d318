// The table of scene formats. A format is declared and listed here, and nowhere else.
#include "engine/io/formats/scene_formats.h"

#include <algorithm>
#include <array>

namespace gse {
namespace io {

SceneFormat gaussian_ply_format();
SceneFormat compressed_ply_format();
SceneFormat splat_format();
SceneFormat ksplat_format();
SceneFormat spz_format();
SceneFormat sog_format();

int chosen_value(const FormatOption& option, const SaveOptions& options) {
    const auto found = options.choices.find(option.name);
    return found == options.choices.end() ? option.standard : found->second;
}

}  // namespace io

std::span<const io::SceneFormat> scene_formats() {
    static const std::array formats = {
        io::gaussian_ply_format(),    //
        io::compressed_ply_format(),  //
        io::splat_format(),           //
        io::ksplat_format(),          //
        io::spz_format(),             //
        io::sog_format(),             //
    };
    return formats;
}

const io::SceneFormat* find_format(std::string_view name) {
    const auto formats = scene_formats();
    const auto found = std::find_if(formats.begin(), formats.end(),
                                    [&](const io::SceneFormat& format) { return format.name == name; });
    return found == formats.end() ? nullptr : &*found;
}

const io::SceneFormat* format_written_to(const std::filesystem::path& path) {
    const std::string name = io::lower_case(path.filename().string());
    const io::SceneFormat* best = nullptr;
    std::size_t longest = 0;
    for (const io::SceneFormat& format : scene_formats())
        for (const std::string& extension : format.extensions)
            if (format.writable() && name.ends_with(extension) && extension.size() > longest) {
                best = &format;
                longest = extension.size();
            }
    return best;
}

std::filesystem::path with_ending(const std::filesystem::path& path, const io::SceneFormat& format) {
    std::string name = path.filename().string();
    const std::string lower = io::lower_case(name);
    if (format_written_to(path) == &format || name.empty()) return path;
    std::string ending = path.extension().string();
    for (const auto& known : readable_extensions())
        if (lower.ends_with(known) && known.size() > ending.size()) ending = known;
    name.resize(name.size() - ending.size());
    return path.parent_path() / (name + format.extensions.front());
}

std::string kept_text(const io::SceneFormat& format) {
    std::vector<std::string> kept{format.exact ? "every bit of the splats"
                                               : "the splats, with rounded values"},
        left_out;
    const auto tell = [&](bool keeps, const char* what) { (keeps ? kept : left_out).emplace_back(what); };
    tell(format.keeps_view_colour, "view-dependent colour");
    tell(format.keeps_labels, "labels");
    tell(format.keeps_columns, "other columns");
    tell(format.keeps_antialiasing, "antialiasing");
    tell(format.keeps_up, "which way is up");
    tell(format.keeps_offset, "the place in the world");
    std::string text = "Keeps " + in_words(kept, "and") + ".";
    if (!left_out.empty()) text += " Leaves out " + in_words(left_out, "and") + ".";
    return text;
}

std::vector<std::string> writable_formats() {
    std::vector<std::string> names;
    for (const io::SceneFormat& format : scene_formats())
        if (format.writable()) names.push_back(format.name);
    return names;
}

std::vector<std::string> readable_extensions() {
    std::vector<std::string> extensions;
    for (const io::SceneFormat& format : scene_formats())
        if (format.readable())
            extensions.insert(extensions.end(), format.extensions.begin(), format.extensions.end());
    return extensions;
}

std::vector<std::string> writable_extensions() {
    std::vector<std::string> extensions;
    for (const io::SceneFormat& format : scene_formats())
        if (format.writable())
            extensions.insert(extensions.end(), format.extensions.begin(), format.extensions.end());
    return extensions;
}

std::vector<std::string> readable_names() {
    std::vector<std::string> names = readable_extensions();
    for (const io::SceneFormat& format : scene_formats())
        names.insert(names.end(), format.file_names.begin(), format.file_names.end());
    return names;
}

std::vector<std::string> wrapper_extensions() { return {".zip", ".ssproj", ".gz"}; }

std::vector<std::string> extensions_that_keep(bool io::SceneFormat::*keeps) {
    std::vector<std::string> extensions;
    for (const io::SceneFormat& format : scene_formats())
        if (format.writable() && format.*keeps)
            extensions.insert(extensions.end(), format.extensions.begin(), format.extensions.end());
    return extensions;
}

std::vector<const io::FormatOption*> format_options() {
    std::vector<const io::FormatOption*> options;
    for (const io::SceneFormat& format : scene_formats())
        for (const io::FormatOption& option : format.options) options.push_back(&option);
    return options;
}

FormatChoices standard_choices() {
    FormatChoices choices;
    for (const io::FormatOption* option : format_options()) choices[option->name] = option->standard;
    return choices;
}

std::string in_words(std::span<const std::string> items, std::string_view last) {
    std::string text;
    for (std::size_t at = 0; at < items.size(); ++at) {
        if (at > 0) text += at + 1 == items.size() ? " " + std::string(last) + " " : ", ";
        text += items[at];
    }
    return text;
}

}  // namespace gse
