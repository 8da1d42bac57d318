// Pictures of a server, taken from the answer cache where one was drawn before.
#pragma once

#include <cstddef>
#include <string>

#include "engine/base/answer_cache.h"
#include "engine/remote/api/image_server.h"

namespace gse::remote {

/// Count of what a server was asked.
struct ServerUse {
    std::size_t requests = 0;  // pictures that it drew
    std::size_t cached = 0;    // that the cache had
    double megapixels = 0;     // drawn
    double seconds = 0;        // waited for
};

/// Asks a server for pictures and keeps each as it comes, so that an edit that was cancelled asks only for
/// what is missing. An answer is kept under kind, model, all values and pictures of its order; no address.
class PictureSource {
public:
    /// `facts`: as the server told them. `identity`: what the pictures follow from beside the order, such as
    /// a workflow. `cache` may be null. All stay alive.
    PictureSource(ImageServer& server, ServerFacts facts, std::string identity, AnswerCache* cache);

    /// Picture [H,W,3] of 8 bits per channel. Throws as ImageServer::redraw().
    Image ask(const RedrawOrder& order, const JobControl& job);

    const ServerFacts& facts() const { return facts_; }
    const ServerUse& use() const { return use_; }
    /// Model that drew last, as the server told it; empty = not told.
    const std::string& model() const { return model_; }
    /// How often another model has answered than before.
    std::size_t model_changes() const { return model_changes_; }

private:
    std::string question_of(const RedrawOrder& order) const;
    void note_model(const std::string& model);

    ImageServer& server_;
    const ServerFacts facts_;
    const std::string identity_;
    AnswerCache* cache_;
    ServerUse use_;
    std::string model_;
    std::size_t model_changes_ = 0;
};

}  // namespace gse::remote
