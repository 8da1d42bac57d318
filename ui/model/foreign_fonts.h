// Characters that the fonts of the panels lack, painted from whatever font of the system has them.
#pragma once

#include <memory>
#include <optional>

#include "ui/model/glyphs.h"

namespace gse::ui {

class ForeignFonts {
public:
    ForeignFonts();
    ~ForeignFonts();
    ForeignFonts(const ForeignFonts&) = delete;
    ForeignFonts& operator=(const ForeignFonts&) = delete;

    /// Nothing when no installed font has an outline or a picture of it.
    std::optional<ui::PaintedGlyph> paint(char32_t character, float size_px);

private:
    struct State;
    std::unique_ptr<State> state_;  // made when the first character is asked for
};

}  // namespace gse::ui
