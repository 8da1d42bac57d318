// Ways to use a file of weights: loaded here, through a server, or not at all.
#pragma once

#include <filesystem>
#include <string>

#include "engine/neural/api/files/weight_kind.h"

namespace gse::neural {

enum class WeightPlace {
    Here,     // loaded by this program
    Server,   // loaded by a server that draws the views
    Nowhere,  // of no use to an edit
};

struct WeightUse {
    WeightPlace place = WeightPlace::Nowhere;
    std::string how = {};  // option that takes it: "--model"; empty unless it is loaded here
    std::string why = {};  // reason, a sentence without its stop; empty where it is loaded here
};

/// Use of weights by their kind alone; files beside them may be missing.
WeightUse weight_use(const WeightKind& kind);

/// Throws Error (InvalidArgument) for weights that are known and cannot be a model here; the hint names the
/// server. Does nothing for a whole checkpoint that is loaded here, and where the file cannot be understood.
void refuse_foreign_model(const std::filesystem::path& path);

}  // namespace gse::neural
