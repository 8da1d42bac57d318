// A second look at what a search found: from all around, by the picture encoder, and along its border.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/base/thread_pool.h"
#include "engine/edit/interfaces/model_traits.h"
#include "engine/edit/masks/view_evidence.h"
#include "engine/edit/search/confidence.h"
#include "engine/edit/search/locate.h"
#include "engine/edit/search/vocabulary_ranker.h"
#include "engine/edit/target_views/strategies/studio_background.h"
#include "engine/raster/rasterizer.h"
#include "engine/scene/scene.h"

namespace gse::edit {

/// A finding, and the scene that it was found in.
struct Finding {
    const GaussianSet& gaussians;
    const std::string& word;
    const Label& label;
    const std::vector<View>& views;             // from where it was found
    const std::vector<ViewEvidence>& evidence;  // of each
    OrbitParameters orbit;                      // of the views: up, field of view
    Vec3 front{0, 0, -1};
    raster::Settings settings;
    std::optional<StudioBackground> ground = {};  // that networks are shown below the scene
    ModelTraits traits = {};
};

struct SecondLookTools {
    raster::Rasterizer& rasterizer;
    VocabularyRanker* recognition = nullptr;  // null: no encoder looks
    ThreadPool* threads = nullptr;
};

/// Tells whether what was looked for goes on beyond the pictures in that share of the views.
bool is_cut_off(const LocateResult& result, double share);

/// How far the edges of the pictures cut the finding off; grounds go on beyond them and are not cut.
SecondLook look_along_border(const Finding& finding, ThreadPool* threads);

/// Tells whether the encoder knows such pictures: it reads the front off them surely. Scans that are unlike
/// all that it learned from get confident answers that mean nothing. True for encoders that cannot read a
/// front.
bool encoder_knows(const Finding& finding, VocabularyRanker& recognition);

/// Adds to that what the encoder says of pictures around the finding, framed as it knows things.
SecondLook second_look(const Finding& finding, const SecondLookTools& tools);

/// The result with the verdict after a second look (reconsider()).
void take_second_look(LocateResult& result, const SecondLook& look, double least);

/// Refuses to put something on a head that neither the shape of the wearer nor the encoder shows: the problem
/// is NoPlace then.
void require_head(LocateResult& result, const Finding& finding, const CheckedRequest& request,
                  const SecondLookTools& tools);

}  // namespace gse::edit
