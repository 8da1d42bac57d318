// Entry point of gseditpro, the artist's program.
#include "app/main/program_main.h"

int main(int argc, char** argv) {
    using namespace gse::app;
    Program program{
        "gseditpro",
        "GSEditPro: text-driven editing of 3D Gaussian Splatting scenes",
        {add_scene_commands, add_transform_command, add_merge_command, add_edit_commands, add_plan_command,
         add_project_command, add_server_command, add_models_command, add_laboratory_pointers}};
#ifdef GSE_WINDOW
    program.commands.insert(program.commands.begin(), add_window_command);
    program.without_command = run_default_window;
    program.command_of_files = "open";
#endif
    return program_main(program, argc, argv);
}
