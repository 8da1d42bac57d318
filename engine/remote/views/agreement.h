// Ways to make a server draw views that agree with each other.
#pragma once

#include <string_view>

#include "engine/remote/api/image_server.h"
#include "engine/remote/views/family.h"

namespace gse::remote {

/// None: one seed for all. Sheet: several views in one picture. Reference: the view drawn first is shown
/// beside every other one. Warp: what is drawn already is carried over by depth, the rest is filled in.
enum class Agreement { Auto, None, Sheet, Reference, Warp };

/// Name on the command line and in recipes.
std::string_view agreement_name(Agreement agreement);
/// Throws Error (InvalidArgument) for another name.
Agreement agreement_of(std::string_view name);

/// Way that suits a family and a server, for Auto. Other values are returned as they are, but for Reference
/// where the server takes no pictures beside the one to redraw: throws Error (InvalidArgument). `follows`:
/// views are to follow an artist's picture.
Agreement suited_agreement(Agreement asked, const ModelFamily& family, const ServerFacts& facts,
                           bool follows = false);

}  // namespace gse::remote
