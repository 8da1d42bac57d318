// Check of a redrawn picture against the one that was sent: servers answer with others without a word.
#pragma once

#include <string>

#include "engine/remote/views/registration.h"
#include "engine/remote/views/view_frame.h"

namespace gse::remote {

/// Flaws for which a picture is not used.
enum class Flaw { None, WrongSize, Unrelated, Moved, Unedited };

/// Limits of what is accepted (METHOD.md, Acceptance of redrawn pictures).
inline constexpr double LeastPsnr = 15, GoodPsnr = 20;  // dB outside the mask
inline constexpr double MostShift = 0.02;               // of the side
inline constexpr double MostScale = 0.02;               // difference from 1
inline constexpr double LeastChange = 4.0 / 255;        // mean inside the mask
inline constexpr double SameAspect = 0.01;              // relative difference

/// Tells whether a picture's sides are the same, up to SameAspect.
bool is_square(const Image& picture);

/// Picture that came, as it can be used, and what was found about it.
struct CheckedPicture {
    Image picture;  // [S,S,3] moved back onto what was sent; empty where the size is of no use
    Flaw flaw = Flaw::None;
    std::string note;  // a sentence about the flaw, or about what is suspicious; empty = nothing
    double psnr = -1;  // dB outside the sent mask; -1 = nothing is outside
    double drift = 0;  // by which it had moved, share of the side
};

/// PSNR in dB of two pictures [S,S,3] over the pixels outside `mask`, 99 at most; -1 where none is outside.
double psnr_outside(const Image& sent, const Image& drawn, const Mask& mask);
/// Mean absolute difference of two pictures inside `mask`; 0 where nothing is.
double change_inside(const Image& before, const Image& after, const Mask& mask);

/// Correlation of the edges of two pictures of one size, -1 to 1; 0 where one of them is even. Colours do not
/// count: it tells whether two pictures show one thing from one side.
double edge_correlation(const Image& picture, const Image& other);

/// Checks size, displacement, surroundings and change of an answer to `frame`.
CheckedPicture check_answer(const ViewFrame& frame, Image answer);

}  // namespace gse::remote
