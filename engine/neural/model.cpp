// Loads a model bundle and hands out its guidance and attention.
#include "engine/neural/model.h"

#include <torch/torch.h>

#include <algorithm>
#include <thread>

#include "engine/neural/torch_errors.h"

namespace gse::neural {

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

void set_threads(int count) {
    const int cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    torch::set_num_threads(count > 0 ? count : cores);
}

std::unique_ptr<TextToImage> load_model(const std::filesystem::path& path, const std::string&) {
    throw Error(ErrorCode::Unsupported, "loading a model is not implemented yet", {}, path);
}

}  // namespace gse::neural
