// Models available on this machine.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace gse::pipeline {

/// Facts of a file or folder, read from its headers. Networks are not loaded.
struct FoundModel {
    std::string name;
    std::string path;
    std::string structure;   // "Stable Diffusion 1.x", "starter", ...
    std::string prediction;  // "predicts velocity (by model.yaml)"; empty = not known
    std::uint64_t bytes = 0;
    bool usable = false;
    std::string problem;  // what is missing or not supported, and what to do; empty where nothing is
};

/// Facts of one. Throws nothing, as find_models().
FoundModel describe_model(const std::filesystem::path& path);

/// The starter model first. Then the models in GSE_MODELS (folders, separated by colons), in the usual
/// folders of other programs and at `also`. Throws nothing: an unreadable entry says so in its `problem`.
std::vector<FoundModel> find_models(const std::vector<std::string>& also);

}  // namespace gse::pipeline
