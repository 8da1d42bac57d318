// Drawing of an object as if it stood alone on a plain ground (METHOD.md, Studio background). For scenes that
// are unlike all training pictures of a model.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "engine/edit/interfaces/interfaces.h"
#include "engine/edit/interfaces/model_traits.h"
#include "engine/edit/placement/upright_bounds.h"
#include "engine/raster/rasterizer.h"

namespace gse::edit {

/// A level ground under a thing, and nothing else.
struct StudioBackground {
    UprightBounds standing;       // of the labelled thing
    Vec3 up;                      // of the world, unit length
    std::array<float, 3> ground;  // colours
    std::array<float, 3> sky;
    double reach = 0;  // radius of the ground, world units
};

/// The ground for a sentence: the one of ModelTraits::plain_grounds that it names, else the first of them.
/// None where nothing stands, or what is labelled is itself as flat as a ground.
std::optional<StudioBackground> plain_ground(const std::string& sentence, const UprightBounds& standing,
                                             const Vec3& up, const ModelTraits& traits);

/// The plain ground under what a scene shows.
struct GroundUnder {
    StudioBackground plain;
    bool in_nothing = false;  // the scene has hardly any ground there (ground_cover()): the thing was cut out
                              // of its surroundings
};

/// Background for the rows that `bits` [N] label. None also if they label nothing, or are not of the scene's
/// size.
std::optional<GroundUnder> ground_under(const std::string& sentence, const GaussianSet& set,
                                        std::span<const std::uint8_t> bits, const Vec3& up, const Vec3& front,
                                        raster::Rasterizer& rasterizer, const ModelTraits& traits);

/// Ground below a whole scene that was cut out of its surroundings (ground_of_scene()). None if it has one,
/// or if some of the `views` would hardly show it, as those within a room.
std::optional<StudioBackground> ground_below(const std::string& sentence, const GaussianSet& set,
                                             const std::vector<View>& views, const Vec3& up,
                                             raster::Rasterizer& rasterizer, const ModelTraits& traits);

/// [H,W,1] share of each pixel that shows it, where nothing stands before it.
Image shown_of(const StudioBackground& plain, const Camera& camera);
/// [H,W,3] in [0,1], of the camera's size: a disc around the foot, as the
/// camera sees it.
Image picture_of(const StudioBackground& plain, const Camera& camera);
/// Puts the background behind a picture of the scene. `depth` [H,W,1] is 0 where the scene has nothing.
Image before_plain(const StudioBackground& plain, const Camera& camera, const Image& picture,
                   const Image& depth);

/// Puts the background behind a picture that was rendered without it and covers `alpha` [H,W,1] of it.
Image before_plain(const StudioBackground& plain, const Camera& camera, const Image& picture,
                   const Image& alpha, const std::array<float, 3>& background);

/// Part of the scene that a model is still shown.
enum class BeforePlain {
    Nothing,  // where something is drawn anew in the place of all that stands there
    Scene,    // where something is added: the ground and the sky show where the scene has nothing
};

/// Shows the model the plain ground in place of the scene, in two kinds of rounds; all others go through. One
/// is the first round that draws anew: the outlines that the model tells move its drawing before the scene.
/// Without outlines it is shown the scene after all. The other is a round that restyles the masks' contents
/// on that ground.
class OnPlainGround final : public MultiViewEditor {
public:
    /// `guidance` stays alive.
    OnPlainGround(MultiViewEditor& guidance, StudioBackground plain, BeforePlain shown)
        : guidance_(guidance), plain_(std::move(plain)), shown_(shown) {}
    EditedViews edit(const std::vector<EditView>& views, const EditViewsRequest& input,
                     const JobControl& job) override;
    bool supports_appearance_editing() const override { return guidance_.supports_appearance_editing(); }

private:
    EditedViews draw_anew(const std::vector<EditView>& views, const EditViewsRequest& input,
                          const JobControl& job);
    EditedViews restyle(const std::vector<EditView>& views, const EditViewsRequest& input,
                        const JobControl& job);

    MultiViewEditor& guidance_;
    StudioBackground plain_;
    BeforePlain shown_;
};

}  // namespace gse::edit
