// Files of weights on this machine: kind of each, and the way to use it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "engine/base/progress.h"
#include "engine/neural/api/files/weight_use.h"

namespace gse::pipeline {

/// A file of weights, or a model's folder in diffusers layout. Only headers are read.
struct ModelFile {
    std::filesystem::path path = {};
    std::uint64_t bytes = 0;
    std::string kind = {};       // "LoRA of SDXL, fp16"
    neural::WeightUse use = {};  // its reason says what is wrong with a broken file
    std::string server_family =
        {};               // by which a server's model is driven (--server-family); empty = not known
    bool broken = false;  // the file cannot be understood
};

/// A folder that was looked at.
struct LookedAt {
    std::filesystem::path folder;
    std::string program;
    bool found = false;
};

struct ModelInventory {
    std::vector<LookedAt> folders;
    std::vector<ModelFile> files;  // by folder, then by name; no file twice
    bool cut_short = false;        // there were more files than MostListedFiles or too many folders
};

constexpr std::size_t MostListedFiles = 5000;

/// Facts of one file or folder. Throws nothing: what cannot be read says so.
ModelFile describe_model_file(const std::filesystem::path& path);

/// Everything in these folders (installations of ComfyUI and others among them) or files, or in the usual
/// places (model_places()) where none is named. Throws Error (NotFound) for a named one that is not there,
/// and (Cancelled).
ModelInventory list_models(const std::vector<std::filesystem::path>& named, const JobControl& job);

}  // namespace gse::pipeline
