// Checks and figures of an order that all protocols share.
#pragma once

#include "engine/remote/api/image_server.h"

namespace gse::remote {

/// Throws Error (InvalidArgument) for an order that no server must see:
/// - sizes that differ or are no multiples of 64;
/// - no prompt, a strength outside (0,1], a seed of 2^31 or more;
/// - more references than `facts` allow.
void check_order(const RedrawOrder& order, const ServerFacts& facts);

/// True for a mask that leaves nothing to change. Servers redraw everything then.
bool leaves_nothing(const RedrawOrder& order);

/// Most bytes of an answer with one picture in base64, and with pictures of ours that are sent back.
std::size_t picture_answer_bytes(const RedrawOrder& order, std::size_t echoed);

}  // namespace gse::remote
