// A thing drawn as if it stood alone on a plain ground, where the scene around it is unlike all that a model has learned from.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "engine/edit/interfaces.h"
#include "engine/edit/standing.h"

namespace gse::edit {

/// A level ground under a thing, and nothing else.
struct PlainGround {
    Standing standing;             // of the labelled thing
    Vec3 up;                       // of the world, unit length
    std::array<float, 3> ground;   // colours
    std::array<float, 3> sky;
};

/// The ground for a sentence: of the colour of the one that it names, of sand where it names none that the bundled model has learned. None
/// where nothing stands, or what is labelled is itself as flat as a ground.
std::optional<PlainGround> plain_ground(const std::string& sentence, const Standing& standing, const Vec3& up, const std::array<float, 3>& sky);

/// [H,W,3] in [0,1], of the camera's size: a disc around the foot, three figures' heights in radius, as the camera sees it.
Image picture_of(const PlainGround& plain, const Camera& camera);

/// Shows the model the plain ground instead of the scene: in the first round of those that draw anew nothing else (what it draws is cut out
/// of its pictures by the outlines that it tells; where it tells none, it is shown the scene after all), in rounds that restyle what the masks hold
/// on it. All others go through.
class OnPlainGround final : public ViewGuidance {
public:
    /// `guidance` stays alive.
    OnPlainGround(ViewGuidance& guidance, PlainGround plain) : guidance_(guidance), plain_(std::move(plain)) {}
    RoundTargets edit(const std::vector<RoundView>& views, const RoundInput& input, const JobControl& job) override;
    bool restyles() const override { return guidance_.restyles(); }

private:
    RoundTargets draw_anew(const std::vector<RoundView>& views, const RoundInput& input, const JobControl& job);
    RoundTargets restyle(const std::vector<RoundView>& views, const RoundInput& input, const JobControl& job);

    ViewGuidance& guidance_;
    PlainGround plain_;
};

}  // namespace gse::edit
