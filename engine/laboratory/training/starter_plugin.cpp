// libgse_starter.so, beside the laboratory's program.
#include "engine/laboratory/training/starter_plugin.h"

#include "engine/base/plugin.h"

namespace gse::training {
namespace {

constexpr PluginName Trainer{"libgse_starter.so",          "gse_train_starter",
                             "the trainer's library",      "this build trains no models",
                             "build with -DGSE_NEURAL=ON", "install libtorch1.13"};

}  // namespace

void train_starter_in_plugin(const StarterTrainParameters& parameters, const StarterSource& source,
                             const std::filesystem::path& work, const std::filesystem::path& output,
                             const JobControl& job) {
    static const auto train = reinterpret_cast<decltype(&gse_train_starter)>(load_plugin(Trainer));
    train(parameters, source, work, output, job);
}

}  // namespace gse::training
