// Pictures to and from the bytes that servers exchange.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "engine/base/image.h"

namespace gse::remote {

/// PNG of 8-bit red, green and blue from [H,W,3] in [0,1].
std::string picture_png(const Image& picture);

/// Grey PNG of 0 and 255 from [H,W,1]: above one half is 255, which means change.
std::string mask_png(const Image& mask);

/// PNG whose colour is the mask and whose alpha is its opposite: right for servers that read the colour, and
/// for those to which transparent means change.
std::string two_way_mask_png(const Image& mask);

/// PNG of the picture whose alpha is the opposite of the mask.
std::string picture_with_mask_png(const Image& picture, const Image& mask);

/// Picture [H,W,3] in [0,1] from a server's PNG, JPEG or WebP. Depths become 8 bits; grey becomes colour;
/// transparent pixels show `sent` where the sizes are equal, black elsewhere. Throws Error (Malformed) for
/// what read_picture_header() refuses, for more than 4 times the pixels of `sent`, and for damage.
Image received_picture(std::span<const std::byte> bytes, const Image& sent);

/// Picture from base64; see above.
Image received_picture(const std::string& base64, const Image& sent);

}  // namespace gse::remote
