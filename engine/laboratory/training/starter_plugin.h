// Loads the trainer of the starter model on first use.
#pragma once

#include "engine/laboratory/starter/starter_trainer.h"

namespace gse::training {

/// train_starter() of the plug-in. Throws Error as that does, and (NotFound, Foreign) where the plug-in
/// cannot be loaded.
void train_starter_in_plugin(const StarterTrainParameters& parameters, const StarterSource& source,
                             const std::filesystem::path& work, const std::filesystem::path& output,
                             const JobControl& job);

}  // namespace gse::training
