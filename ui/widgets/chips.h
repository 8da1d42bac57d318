// A sentence as chips, one per word, that wrap and can be clicked.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "ui/model/context.h"

namespace gse::ui {

/// One word of a sentence.
struct Chip {
    std::string text;
    bool known = true;       // the model knows it
    bool read = true;        // the text encoder reads this far
    bool target = false;     // what the edit is about
    bool guessed = false;    // target because nothing was chosen
    bool source = false;     // what is looked for in the scene
    std::string suggestion;  // nearest known word, empty = none
};

struct ChipClick {
    int chosen = -1;       // left click: the word becomes the target
    bool extends = false;  // with Shift: the target reaches to the word
    int replaced = -1;     // its suggestion was taken
};

/// Draws the words and takes clicks. Unknown words are marked, with suggestions, only where `judged`.
ChipClick chips(Context& context, std::string_view name, std::span<const Chip> words, bool judged);

}  // namespace gse::ui
