// A diffusers folder put together from several cases: another UNet and scheduler with the small VAE, text
// encoder and tokenizer.
#pragma once

#include "engine/neural/diffusion/model_bundle.h"
#include "tests/golden/neural/golden_case.h"

namespace gse::test {

struct BundleFolder {
    /// Skips (present = false) where one of the cases is not there.
    BundleFolder(const std::string& unet_case, const std::string& scheduler_case,
                 const std::string& scheduler_file) {
        const GoldenCase unet(unet_case), vae("vae"), text("clip_text_sd1"), pipeline("pipeline_sd1"),
            scheduler(scheduler_case);
        present = unet.present && vae.present && text.present && pipeline.present && scheduler.present;
        if (!present) return;
        const auto link = [&](const std::filesystem::path& from, const char* name) {
            std::filesystem::create_symlink(std::filesystem::canonical(from), scratch.path() / name);
        };
        link(unet.folder, "unet");
        link(vae.folder, "vae");
        link(text.folder, "text_encoder");
        link(pipeline.folder / "tokenizer", "tokenizer");
        write_file(scratch.path() / "model_index.json", "{}");
        write_file(scratch.path() / "scheduler/scheduler_config.json",
                   read_file(scheduler.folder / scheduler_file));
    }
    neural::ModelBundle load(const std::string& taesd = {}) const {
        return neural::load_bundle(scratch.path(), torch::kCPU, taesd);
    }

    ScratchFolder scratch;
    bool present = false;
};

}  // namespace gse::test
