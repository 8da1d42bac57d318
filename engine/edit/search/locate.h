// From words to a label: attention maps, masks and votes over all views (METHOD.md, Label voting).
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/content_hash.h"
#include "engine/base/progress.h"
#include "engine/base/thread_pool.h"
#include "engine/edit/interfaces/interfaces.h"
#include "engine/edit/interfaces/voxels.h"
#include "engine/edit/masks/search_outcome.h"
#include "engine/edit/masks/view_evidence.h"
#include "engine/edit/request/checked_request.h"
#include "engine/edit/search/confidence.h"
#include "engine/edit/search/place_drawing.h"
#include "engine/edit/search/view_renders.h"
#include "engine/edit/search/vocabulary_ranker.h"
#include "engine/edit/target_views/strategies/studio_background.h"
#include "engine/raster/rasterizer.h"
#include "engine/scene/label_field.h"
#include "engine/scene/scene.h"

namespace gse::edit {

/// Views of a scene, and the request about them.
struct LocateInput {
    const GaussianSet& gaussians;
    const std::vector<View>& views;              // cameras at the size of the pictures
    const std::vector<std::string>& view_words;  // per view, or empty
    const CheckedRequest& request;
    raster::Settings settings;
    Vec3 up{0, -1, 0};     // world up; where the top of a thing is
    Vec3 front{0, 0, -1};  // where it looks; for things that go before a face
    /// [N] 0 or 1: the rows the edit is about, labelled by hand; nothing is looked for then. Null = the words
    /// say.
    const std::vector<std::uint8_t>* label = nullptr;
    std::vector<std::string> known = {};                 // words of the model; empty = it takes any
    std::vector<double> azimuths = {}, elevations = {};  // per view, as in EditView, or empty
    // Ground that the networks are shown where the scene has nothing; none = its background.
    std::optional<StudioBackground> ground = {};
    ModelTraits traits = {};
    /// [N] 0 or 1: rows of the thing that the word is a part of. Attention elsewhere does not count, and no
    /// other row is labelled. Null = anywhere.
    const std::vector<std::uint8_t>* within = nullptr;
    /// [N] 0 or 1, or empty: rows that a search from farther off told from the thing
    /// (LocateResult::beside). They are not labelled. Null = none.
    const std::vector<std::uint8_t>* beside = nullptr;
};

/// Renders of the views, kept from one search to the next over one scene and one set of views; empty = to be
/// filled.
struct LocateCache : ViewRenders {
    /// Views that were asked a second time, by sentence and word: at another threshold the same, so that no
    /// network is asked.
    std::map<std::string, std::vector<std::size_t>> asked_again = {};
    std::map<ContentKey, DrawnViews> drawn = {};  // by drawing_key()
};

/// The parts it calls. Both segmenters may be null: then the attention regions themselves are the masks.
struct LocateTools {
    raster::Rasterizer& rasterizer;
    AttentionSource& attention;
    Segmenter* segmenter = nullptr;
    TextSegmenter* text_segmenter = nullptr;
    JobControl job;
    // null: whether pictures show a word is judged by its attention alone.
    VocabularyRanker* recognition = nullptr;
    LocateCache* cache = nullptr;  // may be null
    // Views are segmented side by side: only for segmenters that allow it; may be null.
    ThreadPool* threads = nullptr;
    /// Told of every view as it is attended, and again once its mask is made; views of one search come in any
    /// order, and from several threads. May be empty.
    std::function<void(std::size_t view, const ViewEvidence& evidence)> seen = {};
    /// Draws what is added, to see where it goes: it is shown the scene
    /// (TextToImage::supports_scene_conditioning()). Null: attention alone says where.
    MultiViewEditor* drawing = nullptr;
    bool plain_ground = true;  // what stands in nothing is shown to it on a plain ground
};

struct LocateResult {
    EditMode mode = EditMode::Modify;
    std::string reason;  // why this mode, for the log and the report
    std::string word;    // the word that was looked for
    std::vector<ViewEvidence> views;
    FoundField found;    // what the views said of the thing the edit is about (in add mode: of the source)
    Label label;         // modify, replace: rows that may change; add: all zero
    Label source_label;  // rows of the source word
    VoxelRegion region;  // add mode: where the new thing goes
    GaussianData seeds;  // add mode: new rows
    VoxelRegion room;  // of what comes in the place of something else worn, elsewhere on its wearer (head.h);
                       // empty otherwise
    /// [N] 0 or 1: rows of parts beside the thing (thing_parts.h); empty = none were found.
    std::vector<std::uint8_t> beside = {};
    int failed_views = 0;
    std::size_t broken_attention = 0;  // values of the attention that were not finite, and count as none
    Confidence confidence;
    bool on_ground = false;  // LocateInput::ground was there
    SearchProblem problem = SearchProblem::None;
    std::string message, remedy;  // of the problem: what came of the search, and what to do
};

/// Labels the object of the request. A search without a result is a result too, with its evidence and
/// `problem` set. Its views are then those of the word that was not found. The label is empty, but for
/// `Unsure`, where it holds the uncertain finding. Throws Error only for unusable input, a stop, and failures
/// of the tools.
LocateResult locate(const LocateInput& input, const LocateTools& tools);

/// Throws Error (NotFound) with the message and the remedy of a search that came to nothing.
void require_found(const LocateResult& located);

/// The finding of a thing narrowed to `part` [N] of its rows: its label, what the views said of other rows,
/// and the masks. SearchProblem::NothingLabelled where the part is empty.
LocateResult part_of_finding(const LocateInput& input, raster::Rasterizer& rasterizer, LocateResult whole,
                             const std::vector<std::uint8_t>& part, const std::string& name);

}  // namespace gse::edit
