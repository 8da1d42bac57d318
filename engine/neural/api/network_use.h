// Counts of what is asked of the networks.
#pragma once

#include <cstdint>

namespace gse::neural {

/// Passes of each network over one picture, and the arithmetic of the forward passes; gradients come on top.
struct NetworkUse {
    std::uint64_t unet = 0;
    std::uint64_t encoder = 0;  // of the VAE
    std::uint64_t decoder = 0;
    double flop = 0;           // 2 per multiply-add of convolutions, linear layers and attention
    std::uint64_t cached = 0;  // answers that were read from the disk instead

    NetworkUse& operator+=(const NetworkUse& other) {
        unet += other.unet;
        encoder += other.encoder;
        decoder += other.decoder;
        flop += other.flop;
        cached += other.cached;
        return *this;
    }
    friend NetworkUse operator-(const NetworkUse& a, const NetworkUse& b) {
        return {a.unet - b.unet, a.encoder - b.encoder, a.decoder - b.decoder, a.flop - b.flop,
                a.cached - b.cached};
    }
};

/// Counts of the calling thread since it began. A run works on one thread: the difference of two readings is
/// its own.
NetworkUse& thread_use();

}  // namespace gse::neural
