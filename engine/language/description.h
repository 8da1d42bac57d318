// Colours of things in sentences: whether one is named, and putting one in.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace gse::language {

/// Tells whether the sentence describes the object ("white wings"), or does not name it. "In flames" and "on
/// fire" are states, whose colour is their own.
bool is_described(std::string_view sentence, const std::string& thing);

/// "a bear with wings" with "white" wings; the article before it follows ("a hat", "an orange hat"). The
/// sentence is a normalised prompt.
std::string described_as(const std::string& sentence, const std::string& thing, const std::string& colour);

/// Sentence of an object that replaces or is added, in its usual colour if the sentence tells none ("a frog":
/// "a green frog"). A model that learned it in all colours draws it in any. The sentence is a normalised
/// prompt; it is unchanged if no such colour is among `sayable`. `usual_colours`: by object.
std::string with_usual_colour(const std::string& sentence, const std::string& thing,
                              const std::vector<std::string>& sayable,
                              const std::map<std::string, std::string>& usual_colours);

}  // namespace gse::language
