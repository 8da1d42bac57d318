// One round of views drawn by a server, in one of the ways that make them agree (METHOD.md, Views by a
// server).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/edit/interfaces/interfaces.h"
#include "engine/remote/drawing/partial_round.h"
#include "engine/remote/views/acceptance.h"
#include "engine/remote/views/agreement.h"
#include "engine/remote/views/family.h"
#include "engine/remote/views/picture_source.h"
#include "engine/remote/views/remote_prompt.h"

namespace gse::remote {

/// Picture of an artist's own, in place of a drawn one.
struct OwnPicture {
    std::string view;  // its name, or that name as files have it
    Image picture;     // [S,S,3] of the whole view
};

/// Settings of what is drawn.
struct RemoteDrawing {
    EditText text;
    ModelFamily family;
    Agreement agreement = Agreement::None;  // not Auto
    int side = 512;                         // px of the pictures that are sent: a multiple of 64
    std::vector<OwnPicture> own = {};       // of views that are not drawn: the others follow them
    std::string key_view = {};              // drawn first; empty = the one with the most to change
    std::string nickname = "the server";    // in words about the progress
    PartialRounds partial = {};             // rounds that end early
};

/// Picture of the view that the others are drawn like.
struct KeyPicture {
    Image picture;  // [S,S,3]; empty = none yet
};

/// Outcome of a round.
struct DrawnRound {
    std::vector<Image> pictures;             // per view [H,W,3]: redrawn inside the mask, else as rendered
    std::vector<std::uint8_t> rejected;      // per view: 1 = nothing of use came
    std::vector<std::string> notes;          // sentences about what came, each once
    double drift = 0;                        // mean over the views, share of the picture's side
    std::vector<std::string> warnings = {};  // about pictures of the artist's own
    std::vector<std::uint8_t> missing = {};  // per view: 1 = rejected, since the drawing ended before it
    double redrawn = 0;                      // views that disagreed, and were drawn once more
};

/// Share of what a picture [S,S,3] of a view's own changes that lies where nothing may change, in [0,1]:
/// beside the mask and a narrow rim. 0 where that is next to nothing.
double share_outside(const edit::EditView& view, const Image& own);

/// True where a name that an artist gave means this view.
bool is_named(const edit::EditView& view, const std::string& name);

/// Draws the views of one round. Refers to all it is given.
class RoundDrawing {
public:
    RoundDrawing(PictureSource& source, const RemoteDrawing& drawing,
                 const std::vector<edit::EditView>& views, const edit::EditViewsRequest& request,
                 const JobControl& job);

    /// Draws all views, or as many as RemoteDrawing::partial is content with. `key`: of an earlier call, for
    /// views that are drawn once more; a new one is left in it. Throws as ImageServer::redraw().
    DrawnRound draw(KeyPicture& key);

private:
    /// Several views in one picture.
    struct Sheet {
        std::vector<ViewFrame> frames;  // of its cells
        RedrawOrder order;
        std::size_t first = 0;  // cell that is to change; the ones before show the key
    };

    void draw_views(KeyPicture& key);
    PartialRound partial_round(const std::string& reason) const;
    /// Goes on with the views that are there, or throws `error`, with a word about them.
    void go_on_without_rest(const Error& error) const;
    bool is_drawn_early() const { return drawing_job_.stop_requested() && !job_.stop_requested(); }
    /// Takes what further servers have drawn of these views before their work ended.
    void take_kept(const std::vector<std::size_t>& views, const Image* key);
    /// Draws the views that disagree most with the others once more, like the key view: two of eight.
    void redraw_outliers(const KeyPicture& key);

    void take_own_pictures();
    void draw_each();
    void draw_sheets();
    void draw_with_reference(KeyPicture& key);
    void draw_by_warp();

    void draw_alone(std::size_t view);
    void draw_like(std::size_t view, const Image& key);
    Sheet sheet(const std::vector<std::size_t>& cells, const Image* key) const;
    void draw_sheet(const std::vector<std::size_t>& cells, const Image* key);
    void draw_warped(std::size_t view, const std::vector<std::size_t>& drawn);

    /// Has several servers draw these views at once, as draw_alone() asks for them, or draw_like() with a
    /// key.
    void draw_ahead(const std::vector<std::size_t>& views, const Image* key = nullptr);
    /// Has several servers draw orders of so many views each at once, as suit_to_server() leaves them.
    void ask_ahead(const std::vector<RedrawOrder>& orders, std::size_t views_each = 1);

    RedrawOrder order(std::string prompt) const;
    RedrawOrder order_for(std::size_t view) const;
    /// The order as it is sent; like the key, where there is one.
    RedrawOrder whole_order(std::size_t view, const Image* key) const;
    RedrawOrder order_like(std::size_t view, const Image& key) const;
    bool is_there(std::size_t view) const { return !squares_[view].data.empty(); }
    /// Asks for one frame, and once more with another seed where the answer is of no use. `may_stay`: what is
    /// drawn may look as the scene did.
    CheckedPicture ask(const ViewFrame& frame, RedrawOrder order, bool may_stay = false);
    Image ask_server(RedrawOrder order);
    void report_slow(const std::string& stage, int usual);
    std::vector<double> disagreements() const;
    bool is_own(std::size_t view) const;  // the artist's own picture
    /// True where the server copied the picture to follow.
    bool is_copy(std::size_t view, const Image& drawn, const Image& key) const;
    void take(std::size_t view, CheckedPicture checked);
    std::size_t key_view() const;
    std::vector<std::size_t> outwards_from(std::size_t view) const;

    PictureSource& source_;
    const RemoteDrawing& drawing_;
    const std::vector<edit::EditView>& views_;
    const edit::EditViewsRequest& request_;
    const JobControl& job_;
    std::stop_source ended_;  // the drawing, by the job or by RemoteDrawing::partial
    const JobControl drawing_job_;
    std::vector<ViewFrame> frames_;
    std::vector<Image> squares_;  // per view: as it was drawn, [S,S,3]; empty where nothing of use came
    DrawnRound round_;
    std::vector<bool> tried_;  // per view: a picture came, whatever it was
    bool offered_ = false;     // to RemoteDrawing::partial: the drawing may be ended
    std::size_t done_ = 0;     // views, for the progress
    int shown_ = 0;            // largest number of a view that was reported, from 0
    int told_slow_ = -1;       // number of the last view that was told to be slow, from 0
};

}  // namespace gse::remote
