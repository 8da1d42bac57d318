// Entry point of gseditpro-lab: measuring, training and generated scenes, for developers.
#include "app/laboratory/laboratory.h"
#include "app/main/program_main.h"

int main(int argc, char** argv) {
    using namespace gse::app;
    return program_main(
        {"gseditpro-lab",
         "The laboratory of GSEditPro: generated scenes, measurements, training of the starter model",
         {add_synth_command, add_eval_command, add_bench_command, add_figures_command, add_training_command}},
        argc, argv);
}
