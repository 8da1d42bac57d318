// Keys of the networks' parameters in each layout of Stable Diffusion weights.
#pragma once

#include "engine/neural/api/config.h"
#include "engine/neural/weights/safetensors.h"
#include "engine/neural/weights/weights.h"

namespace gse::neural {

/// Layout of the text encoder in a single-file checkpoint.
enum class SingleFileText {
    Transformers,      // cond_stage_model.transformer.text_model.* (SD 1.x)
    TransformersBare,  // cond_stage_model.transformer.* without "text_model."
    OpenClip,          // cond_stage_model.model.* (SD 2.x)
};

/// Names of a VAE's tensors.
enum class VaeNames {
    Folder,      // diffusers
    Checkpoint,  // first_stage_model.*
    Bare,        // as in a checkpoint, without "first_stage_model."
};

/// Plans for the files of a diffusers folder. The VAE has two sets of names: today's and those of the
/// SD 1.x/2.x repositories (query, key, value, proj_attn); which one, the file's keys tell.
LoadPlan unet_plan();
LoadPlan vae_plan(const SafetensorsFile& file);
LoadPlan vae_plan(bool legacy_names);
LoadPlan text_encoder_plan();

/// Plans for one file with everything (ldm names). Keys of the other parts, schedule buffers and averaged
/// copies are left alone.
LoadPlan single_file_unet_plan(const UNetConfig& config);
LoadPlan single_file_vae_plan(const VaeConfig& config, VaeNames names = VaeNames::Checkpoint);
LoadPlan single_file_text_plan(const TextEncoderConfig& config, SingleFileText layout);

/// True when the keys are those of a single-file checkpoint.
bool is_single_file(const SafetensorsFile& file);
/// Tells whether the file holds a VAE under these names (Checkpoint, Bare).
bool has_vae(const SafetensorsFile& file, VaeNames names);
/// Names in a file that holds a VAE alone. Throws Error (Model) when it is none.
VaeNames vae_names_of(const SafetensorsFile& file);
/// Throws Error (Model) when the file has no known text encoder (SDXL, SD3, a LoRA, ...).
SingleFileText single_file_text_layout(const SafetensorsFile& file);

/// Sizes that the tensors' shapes tell; heads and norm groups are those of SD 1.x and 2.x.
UNetConfig infer_unet_config(const SafetensorsFile& file, SingleFileText layout);
VaeConfig infer_vae_config(const SafetensorsFile& file, VaeNames names = VaeNames::Checkpoint);
TextEncoderConfig infer_text_config(const SafetensorsFile& file, SingleFileText layout);

}  // namespace gse::neural
