// Colours that a model of few words has no word for: what it draws in a colour that it knows is dyed in the
// picture.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/edit/interfaces/interfaces.h"
#include "engine/edit/placement/upright_bounds.h"
#include "engine/edit/words/dye_words.h"
#include "engine/language/sentence.h"
#include "engine/scene/surface_pattern.h"

namespace gse::edit {

/// Recipe of a colour (METHOD.md, Colours without a word). For a plain one the model draws `base` red, and
/// the red share of every pixel gets the colour. White, grey and black stay. For a metal it draws gold, whose
/// reflections get the metal's tones. A pattern is laid over the red, in space.
struct ColourRemap {
    std::vector<std::string> words;  // of the sentence, one after the other: "pink"; "dark", "red"
    std::string base;                // that the model is told instead: "red", "golden"
    std::array<float, 3> colour{};   // display values in [0,1]; of a metal where it is lit
    std::array<float, 3> shade{};    // of a metal where it mirrors what is dark
    bool metal = false;
    // Instead of one colour; it is laid over what the edit has come to, by dye_rows()
    std::optional<SurfacePattern> pattern = {};
};

/// Colour to lay over an edit: a colour name in its target, or right before it. The name is not in `known`,
/// or "dark" or its like stands before it. Objects that are added or replace others may be named like a
/// colour. None where there is none, or dye_words() is empty.
std::optional<ColourRemap> dye_of(const language::EditSentence& sentence, language::EditMode mode,
                                  const std::vector<std::string>& known);

/// The sentence (words as language::normalised_prompt() has them) with the dye's words replaced by its base,
/// wherever they stand.
std::string told_with(const ColourRemap& dye, const std::string& sentence);

/// Dyes pictures [H,W,3] of one thing where `shares` [H,W,1] say how much: what has a colour of its own (a
/// beak) keeps it.
void apply_dye(const ColourRemap& dye, std::span<const Image> shares, std::span<Image> pictures);

/// Place and direction of an object.
struct DyedThing {
    UprightBounds standing;
    Vec3 up, front;  // unit length
};

/// `set` with the dye's pattern over those of `rows` [N] that are red, at all their SH degrees; `seed`
/// chooses where it is cut out.
GaussianSet dye_rows(const ColourRemap& dye, const DyedThing& thing, std::span<const std::uint8_t> rows,
                     const GaussianSet& set, std::uint64_t seed);

/// Tells the model the base, and, but for patterns, dyes what it draws: inside the outlines that it tells,
/// else inside the masks.
class DyedViews final : public MultiViewEditor {
public:
    /// `guidance` stays alive.
    DyedViews(MultiViewEditor& guidance, ColourRemap dye) : guidance_(guidance), dye_(std::move(dye)) {}
    EditedViews edit(const std::vector<EditView>& views, const EditViewsRequest& input,
                     const JobControl& job) override;
    bool supports_appearance_editing() const override { return guidance_.supports_appearance_editing(); }
    /// The views of the last round as the model was shown the unedited scene, and as it drew them, before
    /// they were dyed.
    struct Drawn {
        Image original, undyed;
    };
    const std::vector<Drawn>& drawn() const { return drawn_; }

private:
    MultiViewEditor& guidance_;
    ColourRemap dye_;
    std::vector<Drawn> drawn_;
};

}  // namespace gse::edit
