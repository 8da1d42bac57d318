// Maps of a thing in views by what a server changes in them: a search without attention (METHOD.md, Search by
// differences).
#pragma once

#include <array>
#include <string>

#include "engine/edit/interfaces/interfaces.h"
#include "engine/remote/views/change_map.h"
#include "engine/remote/views/picture_source.h"
#include "engine/remote/views/round_drawing.h"

namespace gse::remote {

/// Edit that shows where a thing is: a server that changes the thing alone tells its place.
struct DifferenceEdit {
    RemoteDrawing drawing;  // with the text of the edit
    std::string before;     // sentence about the pictures as they are; for models that are told descriptions
    std::string thing;      // word whose place the change tells
    bool paints = false;    // in place of the edit, the thing is painted in one flat colour
};

/// Has a view redrawn twice and takes the difference for the map of one word. Models that are told what to do
/// draw with two seeds, and what both change counts against the picture that was sent. Others draw the
/// sentences before and after the edit with one seed, and the two pictures are compared. A painted thing
/// needs one picture: its colour tells.
class DifferenceSource final : public edit::AttentionSource {
public:
    /// `source` stays alive. Throws Error (InvalidArgument) for families that fill masks, and for those that
    /// are told no instructions where the thing is to be painted.
    DifferenceSource(PictureSource& source, DifferenceEdit edit, JobControl job);

    /// Map of the thing; all zero for other words, and where the server changed nothing or everything. Throws
    /// as ImageServer::redraw().
    std::vector<Image> locate(const edit::AttentionQuery& query) override;
    double threshold() const override { return 0.5; }
    int image_size() const override { return edit_.drawing.side; }

private:
    ChangedPart painted(const Image& sent, std::uint64_t seed);
    ChangedPart part_of(const edit::AttentionQuery& query);
    RedrawOrder order(const Image& picture, const std::string& prompt, std::uint64_t seed,
                      double strength) const;
    /// Pictures of two orders, which several servers draw at once.
    std::array<Image, 2> ask_both(const std::array<RedrawOrder, 2>& orders);
    Image ask(const RedrawOrder& order);

    PictureSource& source_;
    const DifferenceEdit edit_;
    const JobControl job_;
};

}  // namespace gse::remote
