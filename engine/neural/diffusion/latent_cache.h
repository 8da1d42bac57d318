// Latents of pictures that are asked about more than once, by their contents.
#pragma once

#include <torch/torch.h>

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <unordered_map>

#include "engine/base/hash.h"
#include "engine/base/image.h"

namespace gse::neural {

class LatentCache {
public:
    /// Those of `picture`, by encode(picture) where they are not known; several threads may ask, for
    /// different pictures.
    template <class Encode> torch::Tensor of(const Image& picture, Encode&& encode) {
        Hash hash;
        hash.image(picture);
        {
            const std::lock_guard lock(mutex_);
            if (const auto found = known_.find(hash.value()); found != known_.end()) return found->second;
        }
        const torch::Tensor latents = encode(picture);
        const std::lock_guard lock(mutex_);
        if (known_.size() >= Most) known_.clear();
        return known_[hash.value()] = latents;
    }

private:
    static constexpr std::size_t Most = 256;  // 64 KB each of a picture of 512 pixels
    std::mutex mutex_;
    std::unordered_map<std::uint64_t, torch::Tensor> known_;
};

}  // namespace gse::neural
