// Interface to a server that redraws one picture, whatever protocol it speaks. In plain types: implemented in
// engine/remote/protocols, by stand-ins in tests, and called by engine/remote/views.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "engine/base/image.h"
#include "engine/base/progress.h"
#include "engine/remote/api/server_lora.h"

namespace gse::remote {

/// Protocols that servers of picture models speak.
enum class ServerKind { Webui, OpenAi, SdCpp, Comfy };

/// Facts that a server tells of itself, and what its protocol can do.
struct ServerFacts {
    ServerKind kind = ServerKind::Webui;
    std::string product = {};                          // "sd-server", "Forge", "ComfyUI", ...; for people
    std::string version = {};                          // empty = not told
    std::string model = {};                            // name of the model that is loaded; empty = not told
    std::vector<std::string> models = {}, loras = {};  // names to choose from; empty = not told
    std::size_t references = 0;                        // pictures that it takes beside the one to redraw
    bool takes_mask = true;                            // a mask tells it where the picture may change
    bool repeats = true;                               // one seed gives one picture
    bool reports_progress = false;
    bool cancels = false;                 // a job of ours can be ended without hitting another's
    std::vector<std::string> notes = {};  // for people: which inputs of a workflow are set
    bool shows_previews = false;          // pictures in the making can be seen
    LoraNames lora_names = LoraNames::Listed;
};

/// One picture to redraw. Pictures are [H,W,3] in [0,1], sides multiples of `side_step`, all of one size.
struct RedrawOrder {
    Image picture;
    Image mask = {};                     // [H,W,1], 1 = change; empty = the whole picture
    std::vector<Image> references = {};  // at most ServerFacts::references; of any size
    std::string prompt = {}, negative_prompt = {};
    std::uint32_t seed = 0;         // below 2^31
    int steps = 20;                 // that are really run
    double guidance_scale = 7;      // classifier-free guidance
    double distilled_guidance = 0;  // of FLUX models; 0 = not sent
    double strength = 0.75;         // share of the noise levels that is run: 1 = from pure noise
    std::string sampler = {};       // empty = the server's choice
    /// Is shown the picture in the making, [h,w,3] in [0,1] and at most 4 times the pixels of `picture`,
    /// where the server has one; on the thread that waits. Empty = the server is not asked for it.
    std::function<void(const Image&)> preview = {};
    int side_step = 64;  // px, a multiple of 16
};

/// Stage of a job that is neither sent nor waits: its picture is being drawn.
constexpr const char* DrawingStage = "the server draws";

/// Hint of every error that says that a picture is too large for a server: a smaller one may do.
constexpr const char* TooLargeHint = "draw at a smaller size, or free memory at the server";

/// A picture as the server drew it: neither registered nor blended.
struct RedrawnPicture {
    Image picture;           // [H,W,3] in [0,1], of whatever size came
    std::string model = {};  // that drew it; empty = not told
};

/// A server that redraws pictures. One call at a time.
class ImageServer {
public:
    virtual ~ImageServer() = default;
    /// Asks what it is; draws nothing. Throws Error (Foreign) where nobody answers or the answer makes no
    /// sense, (Cancelled) on a stop request.
    virtual ServerFacts probe(const JobControl& job) = 0;
    /// Throws Error: (Cancelled) within 100 ms of a stop request, (Foreign) for what a server does wrong,
    /// (InvalidArgument) for what it will not take. The message says what happened and the hint what to do.
    /// Reports progress where the server tells it.
    virtual RedrawnPicture redraw(const RedrawOrder& order, const JobControl& job) = 0;
};

}  // namespace gse::remote
