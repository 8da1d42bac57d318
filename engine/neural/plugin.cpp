// Entry point of the networks' shared library.
#include <torch/torch.h>

#include <algorithm>
#include <thread>

#include "engine/neural/api/api.h"
#include "engine/neural/clip/text_segmenter.h"
#include "engine/neural/layers/buffer_cache.h"
#include "engine/neural/layers/devices.h"
#include "engine/neural/model.h"
#include "engine/neural/sam/sam_segmenter.h"

namespace gse::neural {
namespace {

class Plugin final : public Api {
public:
    std::unique_ptr<TextToImage> load_model(const std::filesystem::path& path,
                                            const ModelOptions& options) override {
        return neural::load_model(path, options);
    }
    std::unique_ptr<edit::Segmenter> load_segmenter(const std::filesystem::path& path,
                                                    const std::string& device) override {
        keep_buffers();
        prefer_one_blas_thread();  // views are segmented side by side
        return load_sam_segmenter(path, device);
    }
    std::unique_ptr<edit::TextSegmenter> load_text_segmenter(const std::filesystem::path& folder,
                                                             const std::string& device) override {
        keep_buffers();
        prefer_one_blas_thread();
        return neural::load_text_segmenter(folder, device);
    }
    void set_threads(int count) override { neural::set_threads(count); }
    NetworkUse use() const override { return thread_use(); }
};

}  // namespace
}  // namespace gse::neural

extern "C" gse::neural::Api* gse_neural_api() {
    static gse::neural::Plugin plugin;
    return &plugin;
}
