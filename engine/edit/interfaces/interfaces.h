// Interfaces of the edit to networks and segmenters, in plain types. They are implemented in engine/neural
// and here.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/image.h"
#include "engine/base/progress.h"
#include "engine/edit/interfaces/clean_plate.h"
#include "engine/scene/scene.h"

namespace gse::edit {

/// Inputs of a guidance in one iteration.
struct GuidanceInput {
    const Image& rendered;        // [H,W,3] in [0,1], the current render
    const View& view;             // where it was rendered from
    std::size_t view_index = 0;   // index into the edit's views
    std::string view_words = {};  // "front view", "side view", "back view" or empty: appended to the prompt
    int iteration = 0;
    int iteration_count = 1;
    std::uint64_t seed = 0;  // already mixed with the iteration: the only source of randomness
    /// The unedited scene from there [H,W,3], not clamped. One picture per view_index. Null = not known.
    const Image* original = nullptr;
};

/// Gradient of the guidance loss with respect to the image, and numbers for the log.
struct GuidanceOutput {
    Image gradient;                         // [H,W,3] dL/dImage
    std::map<std::string, double> scalars;  // "loss", "timestep", "gradient_norm", ...
};

/// Pulls the rendered image towards the goal of the edit.
class Guidance {
public:
    virtual ~Guidance() = default;
    /// Gradient for one picture. A value that is not finite means that there is none this time; the step is
    /// left out.
    virtual GuidanceOutput evaluate(const GuidanceInput& input) = 0;
};

/// One view of a round of view guidance. Pictures have one size; `rendered` and `original` are in [0,1].
struct EditView {
    Image rendered;  // [H,W,3] the scene as it is now
    Image original;  // [H,W,3] the unedited scene
    Image depth;     // [H,W,1] of the surface along the camera's z, world units; 0 = nothing there
    Mask mask;       // where the picture may change
    View view;
    std::string view_words = {};  // as in GuidanceInput
    // Azimuth of the camera from the thing's front, radians, positive to its left; nothing = not known.
    std::optional<double> azimuth = {};
    // Elevation of the camera above the thing's horizon, radians; 0 where the azimuth is not known.
    double elevation = 0;
    // The scene without what may change, its holes filled; empty unless the round draws anew.
    CleanPlate clean_plate = {};
};

/// Orders for a round.
struct EditViewsRequest {
    int round = 0, rounds = 1;
    int steps = 6;              // of the sampler
    double strength = 0.75;     // where it begins: 0 = the picture itself, 1 = pure noise
    std::uint64_t seed = 0;     // already mixed with the round: the only source of randomness
    bool anew = false;          // the inside of the masks becomes something else: nothing of it is to be kept
    std::string sentence = {};  // that the model is told; empty = the one that the guidance was made for
    // Steps at or below this noise level are led by the sentence alone, without the negative prompt.
    double guided_until = 0;
    bool keep = false;           // the answer is worth remembering: the same may be asked again
    bool tells_changes = false;  // EditedViews::changes are wanted where there are no outlines; they take a
                                 // decoder's pass per view
    // Standard deviation of the noise of a round that is `anew`; below 1 it draws nearer to the mean.
    double noise = 1;
};

/// Pictures as the model would have them, and numbers for the log.
struct EditedViews {
    std::vector<Image> images;  // per view, [H,W,3] in [0,1], of the size that came in
    /// Per view [H,W,1]: difference of the picture from the model's picture of the clean plate alone, in the
    /// channel that differs most. Empty if the model cannot tell, or was not asked.
    std::vector<Image> changes = {};
    /// Per view [H,W,1] in [0,1]: coverage of each pixel by the new object. Empty if the model cannot tell.
    std::vector<Image> outlines = {};
    /// Per view: 1 = nothing of use came, and the scene is not fitted to it. Empty = all can be used.
    std::vector<std::uint8_t> rejected = {};
    std::map<std::string, double> scalars = {};
    bool unfinished = false;  // what they lack is laid over the edited scene: pictures like the scene do not
                              // mean that nothing came
    std::vector<std::string> warnings = {};  // about the pictures, each a sentence with what would help
    /// Per view: 1 = it is rejected, because the drawing ended before it. Empty = every view was drawn.
    std::vector<std::uint8_t> missing = {};
};

/// Edits all views of a round in the picture. The scene is fitted to its results.
class MultiViewEditor {
public:
    virtual ~MultiViewEditor() = default;
    /// Throws Error (Cancelled) on a stop request.
    virtual EditedViews edit(const std::vector<EditView>& views, const EditViewsRequest& input,
                             const JobControl& job) = 0;
    /// True when a network that is shown the unedited views draws rounds that are not `anew`. It keeps their
    /// shapes, however much noise there is in the beginning.
    virtual bool supports_appearance_editing() const { return false; }
    /// True when all views of a round show a new thing in one colour, though the sentence names none.
    virtual bool agrees_on_colour() const { return false; }
};

/// Attention query: the places in the image of each of these words of the prompt.
struct AttentionQuery {
    const Image& image;              // [H,W,3] in [0,1]
    std::string prompt;              // must contain every word
    std::vector<std::string> words;  // one map each
    std::string view_words = {};     // as in GuidanceInput
    bool absent = false;             // the thing is not in the image yet: look at high timesteps
    int repeats = 3;
    std::uint64_t seed = 0;
};

/// Cross-attention of a text-to-image model (METHOD.md, Attention maps). Returns one single-channel image per
/// word, at the size of the input image. Values are non-negative, on one scale for all pictures, and zero if
/// the word drew no attention at all. A word that draws much less than in others has no object there.
class AttentionSource {
public:
    virtual ~AttentionSource() = default;
    virtual std::vector<Image> locate(const AttentionQuery& query) = 0;
    /// Announces the next queries of locate(). A source that is quicker with several queries works them out
    /// together. One that fails is left to locate(), which says why.
    virtual void prepare(std::span<const AttentionQuery> queries) { static_cast<void>(queries); }
    /// Number of queries worth preparing together. It takes no longer than a stop request may wait.
    virtual std::size_t at_once() const { return 1; }
    /// Binarisation threshold that suits the model best. 0.5 (the paper's) unless it states its own.
    virtual double threshold() const { return 0.5; }
    /// Side in pixels of the square images the model works at.
    virtual int image_size() const = 0;
};

/// A click: positive = inside the wanted region. Pixel coordinates, pixel centres at .5.
struct PointPrompt {
    double x = 0, y = 0;
    bool positive = true;
};

struct BoxPrompt {
    double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

/// Image and clicks (or a box) to a mask.
class Segmenter {
public:
    virtual ~Segmenter() = default;
    /// Mask of the object. `hint` (may be empty) is a coarse map in [0,1] of its probable place, at the
    /// image's size.
    virtual Mask segment(const Image& image, const std::vector<PointPrompt>& points,
                         const std::optional<BoxPrompt>& box, const Image& hint) = 0;
    /// True when its masks are better than the attention they come from. Attention outside of them does not
    /// count then.
    virtual bool trusted() const { return false; }
    virtual std::string name() const = 0;
};

/// Image and noun to a mask with a confidence in [0,1]. Absent without weights.
class TextSegmenter {
public:
    virtual ~TextSegmenter() = default;
    virtual std::pair<Mask, double> segment(const Image& image, const std::string& noun) = 0;
};

}  // namespace gse::edit
