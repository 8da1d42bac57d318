// Folders in which programs that draw pictures keep their models.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace gse::pipeline {

struct ModelPlace {
    std::filesystem::path folder;
    std::string program;  // "ComfyUI"; empty where the user names it
};

/// Usual folders, whether they are there or not. In order: GSE_MODELS (separated by colons) and our own;
/// those of ComfyUI, krita-ai-diffusion, A1111, Forge and SD.Next below the home folder and at COMFYUI_PATH,
/// SD_DATADIR and SD_MODELSDIR; folders that an extra_model_paths.yaml of ComfyUI names. Throws nothing.
std::vector<ModelPlace> model_places();

/// Folders of models below a folder: those of an installation of such a program, else the folder itself.
std::vector<ModelPlace> places_below(const std::filesystem::path& folder);

/// Folders that the text of an extra_model_paths.yaml names; `folder` holds the file. Lines that are no
/// "key: value" are passed over.
std::vector<std::filesystem::path> extra_model_folders(const std::string& yaml,
                                                       const std::filesystem::path& folder);

}  // namespace gse::pipeline
