// Views redrawn by a server in place of a network of ours.
#pragma once

#include <map>
#include <string>

#include "engine/edit/interfaces/interfaces.h"
#include "engine/remote/views/round_drawing.h"

namespace gse::remote {

/// Has the views of a round drawn by a server. What it sends back is registered, checked and blended with our
/// own masks; views of which nothing of use came are rejected.
class RemoteViewEditor final : public edit::MultiViewEditor {
public:
    /// The source stays alive.
    RemoteViewEditor(PictureSource& source, RemoteDrawing drawing)
        : source_(source), drawing_(std::move(drawing)) {}

    /// Throws Error (Cancelled) on a stop request, (InvalidArgument) for names of views that are not among
    /// the first ones, (Model) where no view is of use, and as
    /// ImageServer::redraw().
    edit::EditedViews edit(const std::vector<edit::EditView>& views, const edit::EditViewsRequest& request,
                           const JobControl& job) override;
    /// Models that are told what to do keep shapes; strength means nothing to them.
    bool supports_appearance_editing() const override { return drawing_.family.instructed(); }
    bool agrees_on_colour() const override {
        return drawing_.family.instructed() || drawing_.agreement == Agreement::Reference ||
               drawing_.agreement == Agreement::Sheet;
    }

private:
    DrawnRound draw(const std::vector<edit::EditView>& views, const edit::EditViewsRequest& request,
                    const JobControl& job);
    void check_names(const std::vector<edit::EditView>& views);
    void add_outlines(const std::vector<edit::EditView>& views, const DrawnRound& drawn,
                      edit::EditedViews& edited) const;

    PictureSource& source_;
    const RemoteDrawing drawing_;
    KeyPicture key_;
    bool names_checked_ = false;
};

}  // namespace gse::remote
