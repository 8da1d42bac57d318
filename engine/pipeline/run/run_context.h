// Context of every stage of a run: the scene, the model, and their answers so far.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/thread_pool.h"
#include "engine/edit/search/cached_attention.h"
#include "engine/edit/search/locate.h"
#include "engine/edit/search/second_look.h"
#include "engine/neural/api/api.h"
#include "engine/neural/api/network_use.h"
#include "engine/pipeline/models/segmenters.h"
#include "engine/pipeline/models/view_server.h"
#include "engine/pipeline/run/views.h"
#include "engine/pipeline/scene/scene_tools.h"

namespace gse::pipeline {

/// Cost of drawing the place of an added object.
struct PlaceCost {
    std::size_t views = 0;
    double seconds = 0;
    neural::NetworkUse use;
};

/// Told of each view of a search as it is attended and again once its mask is made: its number, how many
/// there are, and what is known of it. A search begins with other views where it moves in. Calls may come
/// from several threads.
using ViewWatch = std::function<void(const View& view, std::size_t index, std::size_t count,
                                     const edit::ViewEvidence& evidence)>;

/// Scene and model of a run. What they have answered is remembered: that changes how long a stage takes,
/// never what comes of it.
class RunContext {
public:
    /// Context of a scene. The up axis and the rasterizer of the job count. Null in `segmenters` = the one
    /// without weights. Throws Error (InvalidArgument) for a scene of which nothing can be seen, and for a
    /// rasterizer that is not available.
    RunContext(Scene scene, std::shared_ptr<neural::TextToImage> model, const JobParameters& job,
               Segmenters segmenters = {});

    const Scene& scene() const { return scene_; }
    /// The scene without what cannot be drawn; such splats stay as they are and count nowhere.
    const GaussianSet& drawn() const { return drawn_; }
    std::size_t unusable() const { return unusable_; }
    neural::TextToImage& model() const { return *model_; }
    const std::shared_ptr<neural::TextToImage>& shared_model() const { return model_; }
    Painter& painter() { return painter_; }

    /// Server that draws the views of the edit; null = the model does.
    ViewServer* server() const { return server_.get(); }
    const std::shared_ptr<ViewServer>& shared_server() const { return server_; }
    void draw_with(std::shared_ptr<ViewServer> server) { server_ = std::move(server); }

    /// From here on another model of the same kind answers; what the one before answered is forgotten.
    void take_model(std::shared_ptr<neural::TextToImage> model);
    /// Forgets what networks answered and asks with these settings from here on.
    void ask_anew(const neural::AttentionParameters& attention);
    /// Searches take what the server changes for attention until ask_anew(). Needs a server. Throws Error as
    /// ViewServer::differences().
    void ask_server(const CheckedRecipe& recipe, const JobControl& control);
    /// True while they do.
    bool asks_server() const { return differences_ != nullptr; }
    /// Context of this scene without answers.
    void ask(const neural::AttentionParameters& attention);
    /// Who is told of the views of searches from here on; empty = nobody.
    void watch_views(ViewWatch watch) { watch_ = std::move(watch); }
    const edit::ModelTraits& traits() const { return traits_; }
    /// Looks whether the scene was cut out of its surroundings (edit::ground_below()). Only the first call
    /// looks; models that are not shown scenes need none.
    void look_for_ground(const std::vector<View>& views);
    /// The ground that the model is shown below and behind such a scene, for a sentence that says what the
    /// scene shows; none before look_for_ground().
    std::optional<edit::StudioBackground> ground(const std::string& sentence) const;
    /// Arguments of locate(), for these views before this ground. The views must stay while they are used.
    /// Needs ask() or ask_anew().
    edit::LocateTools tools(const Views& views, const std::optional<edit::StudioBackground>& ground,
                            const JobControl& control);
    /// Tools of edit::second_look(). Needs ask() or ask_anew().
    edit::SecondLookTools second_look() {
        return {painter_.rasterizer(), asks_server() ? nullptr : recognition_.get(), &threads_};
    }
    /// Editor that draws the place of an addition, if the model can
    /// (TextToImage::supports_scene_conditioning()), else null. Its cost is counted. It is not the artist's
    /// guidance, which belongs to the loop. A server draws what the model has no word for.
    std::unique_ptr<edit::MultiViewEditor> place_drawing(const CheckedRecipe& recipe);
    const PlaceCost& place_cost() const { return place_cost_; }
    edit::VocabularyRanker& recognition() { return *recognition_; }
    edit::Segmenter& segmenter() { return *segmenters_.clicks; }
    /// Renders in [0,1], before a ground where there is one. Throws Error (Cancelled) on a stop request.
    std::vector<Image> pictures(const std::vector<View>& views, const raster::Settings& settings,
                                const std::optional<edit::StudioBackground>& ground,
                                const JobControl& control);
    /// Pictures that the networks were asked about so far.
    std::size_t questions() const { return attention_ ? attention_->asked() : 0; }
    /// The threshold the model states for its attention; 0 before it was asked anything.
    double stated_threshold() const {
        return differences_ ? differences_->threshold() : attention_ ? attention_->threshold() : 0;
    }

private:
    Scene scene_;
    GaussianSet drawn_;
    std::size_t unusable_ = 0;
    edit::ModelTraits traits_;
    std::optional<edit::StudioBackground> ground_;  // of any sentence
    bool looked_for_ground_ = false;
    std::shared_ptr<neural::TextToImage> model_;
    std::shared_ptr<ViewServer> server_;
    Painter painter_;
    ThreadPool threads_;
    std::unique_ptr<edit::CachedAttention> attention_;
    std::unique_ptr<edit::CachedAttention> differences_;  // that stand in for it; null = the model is asked
    std::unique_ptr<edit::VocabularyRanker> recognition_;
    Segmenters segmenters_;
    edit::LocateCache renders_;  // of the views with this key
    std::string renders_key_;
    ViewWatch watch_;
    PlaceCost place_cost_;
};

}  // namespace gse::pipeline
