// Orders that several servers draw at once.
#pragma once

#include <cstddef>
#include <exception>
#include <functional>
#include <optional>
#include <stop_token>
#include <vector>

#include "engine/remote/api/image_server.h"

namespace gse::remote {

/// Outcome of a list of orders for several servers.
struct SpreadDrawing {
    struct Drawn {
        std::size_t server = 0;  // that drew it
        RedrawnPicture redrawn;
    };
    std::vector<std::optional<Drawn>> drawn;   // per order; none = nobody drew it
    std::vector<std::exception_ptr> failures;  // per server; null = it drew all that it took
};

/// Receivers of news, on the thread that waits.
struct SpreadNews {
    std::function<void(std::size_t done)> drawn;  // pictures that are there
    /// Picture in the making at the first server; empty = it is not asked for them.
    std::function<void(const RedrawOrder& order, const Image& preview)> preview = {};
};

/// Has each server draw in a thread of its own: who is done takes the next order. A failure ends the thread
/// of its server and leaves the order undrawn; one of the first server, a stop request and an exception of a
/// receiver end them all. Returns when every thread has ended, and throws what a receiver threw.
SpreadDrawing draw_spread(const std::vector<ImageServer*>& servers, const std::vector<RedrawOrder>& orders,
                          const SpreadNews& news, const std::stop_token& stop);

}  // namespace gse::remote
