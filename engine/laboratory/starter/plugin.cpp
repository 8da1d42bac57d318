// Entry point of the laboratory's plug-in, so that the laboratory starts without torch.
#include <torch/torch.h>

#include "engine/laboratory/starter/starter_trainer.h"
#include "engine/neural/layers/devices.h"
#include "engine/neural/layers/torch_errors.h"

extern "C" void gse_train_starter(const gse::training::StarterTrainParameters& parameters,
                                  const gse::training::StarterSource& source,
                                  const std::filesystem::path& work, const std::filesystem::path& output,
                                  const gse::JobControl& job) {
    gse::neural::set_blas_threads(torch::get_num_threads());  // batches, unlike edits, are worth it
    gse::neural::guard_torch("training the starter model",
                             [&] { gse::training::train_starter(parameters, source, work, output, job); });
}
