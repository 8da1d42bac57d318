// Sentences that a server is told.
#include "engine/remote/views/remote_prompt.h"

#include <cctype>

#include <fmt/format.h>

namespace gse::remote {
namespace {

constexpr std::string_view KeepTheRest =
    "Keep the camera, framing, pose, lighting and everything else exactly the same.";

std::string as_sentence(std::string text) {
    while (!text.empty() && (text.back() == '.' || text.back() == ' ')) text.pop_back();
    if (text.empty()) return text;
    text.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(text.front())));
    return text + ".";
}

std::string described(const EditText& text, const std::string& view_words) {
    return view_words.empty() ? text.description : text.description + ", " + view_words;
}

}  // namespace

std::string prompt_for_view(const ModelFamily& family, const EditText& text, const std::string& view_words,
                            bool again) {
    if (!family.instructed()) return described(text, view_words);
    return fmt::format("{} {}{}", as_sentence(text.instruction),
                       again ? "Where this is done already, make it sharp and keep it. " : "", KeepTheRest);
}

std::string prompt_for_sheet(const ModelFamily& family, const EditText& text) {
    if (!family.instructed())
        return fmt::format("four pictures of the same object from four sides, each shows {}",
                           text.description);
    return fmt::format(
        "{} The picture shows the same object from several sides. Make exactly the same change in all of "
        "them. {}",
        as_sentence(text.instruction), KeepTheRest);
}

std::string prompt_with_reference(const ModelFamily& family, const EditText& text,
                                  const std::string& view_words) {
    if (!family.instructed()) return described(text, view_words);
    const auto word = family.picture_word.empty() ? std::string_view("image") : family.picture_word;
    return fmt::format(
        "{0} Make the same change to {1} 1 that was made to the object in {1} 2. Take colours, material and "
        "details from {1} 2, but keep the camera, pose and framing of {1} 1. {2}",
        as_sentence(text.instruction), word, KeepTheRest);
}

}  // namespace gse::remote
