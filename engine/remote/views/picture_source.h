// Pictures of a server, taken from the answer cache where one was drawn before.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "engine/base/answer_cache.h"
#include "engine/remote/api/image_server.h"
#include "engine/remote/drawing/picture_times.h"
#include "engine/remote/spread/further_server.h"
#include "engine/remote/spread/spread_drawing.h"

namespace gse::remote {

/// Count of what a server was asked.
struct ServerUse {
    std::size_t requests = 0;  // pictures that it drew
    std::size_t cached = 0;    // that the cache had
    double megapixels = 0;     // drawn
    double seconds = 0;        // waited for
    std::size_t not_kept = 0;  // pictures that the disk did not take
    int smaller_side = 0;      // px at which it is asked since its memory did not do; 0 = as ordered
};

/// Stage of a job whose picture takes much longer than those before it.
constexpr const char* SlowStage = "it takes longer than the views before";

/// Picture that is drawn now, as far as it is, or the end of one.
struct DrawingNews {
    std::shared_ptr<const Image> sent = {};     // [S,S,3]; null = nothing is drawn any more
    std::shared_ptr<const Image> preview = {};  // [h,w,3], of any size
    ServerUse use = {};                         // so far
};

/// Receiver of previews and of each picture's end, on the thread that waits for the server.
using DrawingWatch = std::function<void(const DrawingNews&)>;

/// Asks a server for pictures and keeps each as it comes, so that an edit that was cancelled asks only for
/// what is missing. An answer is kept under kind, model, all values and pictures of its order; no address.
/// A picture that is too large for the server is asked for once at 3/4 of its side. All later ones are asked
/// for at that side, and what comes is brought back to the size of the order. Further servers draw at once
/// with it what prefetch() is given; all else is asked of the first.
class PictureSource {
public:
    /// `facts`: as the server told them. `identity`: what the pictures follow from beside the order, such as
    /// a workflow. `cache` may be null. All stay alive.
    PictureSource(ImageServer& server, ServerFacts facts, std::string identity, AnswerCache* cache,
                  PictureTimes times = PictureTimes());

    /// Picture [H,W,3] of 8 bits per channel. While a picture takes much longer than those before it, the
    /// progress is SlowStage, with the usual time in seconds as its step. Throws as ImageServer::redraw();
    /// for a picture that is too large at 3/4 of its side, too, the error says so.
    Image ask(const RedrawOrder& order, const JobControl& job);
    /// True where ask() needs no server for it.
    bool is_kept(const RedrawOrder& order) const;
    /// Servers of the same kind with the same model, which stay alive.
    void spread_over(std::vector<FurtherServer> further) { further_ = std::move(further); }
    /// True where a further server is there that has not failed.
    bool is_spread() const;
    /// Has all servers draw these orders at once, so that ask() finds them drawn; nothing without further
    /// servers. Each picture that comes is reported. A further server that fails is left out from then on,
    /// with a warning. Throws as ImageServer::redraw() of the first; a stop request only ends it.
    void prefetch(const std::vector<RedrawOrder>& orders, const JobControl& job);
    /// Who is told of what is drawn; empty = nobody, and the server is asked for no previews.
    void watch(DrawingWatch watch) { watch_ = std::move(watch); }

    const ServerFacts& facts() const { return facts_; }
    const ServerUse& use() const { return use_; }
    const std::vector<FurtherServer>& further() const { return further_; }
    /// Model that drew last, as the server told it; empty = not told.
    const std::string& model() const { return model_; }
    /// How often another model has answered than before.
    std::size_t model_changes() const { return model_changes_; }

private:
    Image ask_as_ordered(const RedrawOrder& order, const JobControl& job);
    Image ask_smaller(const RedrawOrder& order, const JobControl& job);
    RedrawnPicture drawn(const RedrawOrder& order, const JobControl& job);
    RedrawnPicture shown_while_drawn(RedrawOrder order, const JobControl& job);
    RedrawOrder as_asked(const RedrawOrder& order) const;
    std::vector<RedrawOrder> not_drawn(const std::vector<RedrawOrder>& orders) const;
    void take_spread(const std::vector<RedrawOrder>& orders, SpreadDrawing spread,
                     const std::vector<FurtherServer*>& team);
    void take_failures(const std::vector<std::exception_ptr>& failures,
                       const std::vector<FurtherServer*>& team);
    void count(const RedrawnPicture& redrawn);
    void keep(const RedrawOrder& order, const RedrawnPicture& redrawn);
    std::string question_of(const RedrawOrder& order) const;
    void note_model(const std::string& model);

    ImageServer& server_;
    const ServerFacts facts_;
    const std::string identity_;
    AnswerCache* cache_;
    ServerUse use_;
    DrawingWatch watch_ = {};
    PictureTimes times_;
    std::string model_;
    std::size_t model_changes_ = 0;
    std::vector<FurtherServer> further_;
    std::map<std::string, std::string>
        ahead_;  // bytes of pictures by their questions, until they are asked for
};

}  // namespace gse::remote
