// Trains the starter model (VAE, text encoder, UNet in the structure of Stable Diffusion) on captioned
// pictures. No torch type appears here: a picture source goes in, a diffusers folder comes out.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/fields.h"
#include "engine/base/progress.h"

namespace gse::training {

/// Parts that a caption's word may name; the order of the coverage maps of a StarterPicture.
enum class StarterPart : int { Ground = 0, Object = 1, Accessory = 2 };
inline constexpr int StarterPartCount = 3;

/// One training picture. `coverage` holds, per part, how much of each latent cell the part covers (0..255).
struct StarterPicture {
    std::vector<std::uint8_t> rgb;       // [S,S,3] display values
    std::vector<std::uint8_t> coverage;  // [3,G,G], G = S / 4
    /// The accessory map is that of the twin scene: the picture itself shows no accessory. Captions asked for
    /// with `insertion` then name the accessory, so the words learn where it belongs before it is there.
    bool bare_twin = false;
    /// Coverage of each pixel by what is new (restyled part, else accessory, else object), [S,S], 0..255.
    /// Empty where the source does not tell.
    std::vector<std::uint8_t> outline = {};
};

/// A caption and which of its words name which part (`occurrence` counts equal words from 0).
struct StarterCaption {
    struct Grounding {
        std::string word;
        int occurrence = 0;
        StarterPart part = StarterPart::Object;
    };
    std::string text;
    std::vector<Grounding> groundings;
    /// A picture taken from between two sides has two sentences: the other one, and how much it holds, in
    /// [0,1].
    std::string next_text = {};
    double next_share = 0;
};

/// Camera of a picture.
struct StarterCamera {
    double azimuth = 0;    // radians from the scene's front, positive to the left
    double elevation = 0;  // radians above the horizontal
    double front = 0;      // azimuth at which the thing shows its front: it may be turned in the scene
};

class ContrastivePairs;

/// Source of training pictures; every method is const, deterministic and callable from several threads.
class StarterSource {
public:
    virtual ~StarterSource() = default;
    virtual StarterPicture picture(std::uint64_t index, int size) const = 0;
    /// A caption of picture `index`; `seed` varies the wording.
    virtual StarterCaption caption(std::uint64_t index, std::uint64_t seed, bool insertion) const = 0;
    virtual std::vector<std::string> vocabulary() const = 0;
    /// Number of pictures of each scene: picture s * views_of_scene() + v is view v of scene s. Captions of
    /// one scene that are asked for with one seed differ in the side only.
    virtual int views_of_scene() const { return 1; }
    virtual StarterCamera camera(std::uint64_t index) const {
        return static_cast<void>(index), StarterCamera{};
    }
    /// Views of these scenes before the caption's edit: without the accessory, else without the object. The
    /// object's coverage then is that of its placement volume. null = there are none.
    virtual const StarterSource* before() const { return nullptr; }
    /// Part that the caption's edit gives another colour, material or ground. Pictures of before() show it as
    /// it was, and there is no placement volume. nullopt = something new comes.
    virtual std::optional<StarterPart> restyled(std::uint64_t index) const {
        return static_cast<void>(index), std::nullopt;
    }
    /// Tells whether all pictures have their outline.
    virtual bool has_outlines() const { return false; }
    /// Changes when the same index would give another picture (names the picture cache).
    virtual std::string identity() const = 0;
    /// Pictures for the image-text encoder; null = there are none.
    virtual const ContrastivePairs* contrastive_pairs() const { return nullptr; }
    /// Pictures for the upscaler: framed as what an edit draws.
    virtual const StarterSource& drawn_pictures() const { return *this; }
};

/// A sentence and what it states: bit k is fact k ("the object is a bear", "there is no accessory").
struct StarterClaim {
    std::string text;
    std::uint64_t facts = 0;
};

/// Groups of pictures of one scene from one place that differ in a word or two. Picture g * group_size() + m
/// is member m of group g. Coverage is not needed and may be zero.
class ContrastivePairs : public StarterSource {
public:
    virtual int group_size() const = 0;
    /// Everything that is true of a picture.
    virtual std::uint64_t facts(std::uint64_t index) const = 0;
    /// True sentence of a picture. `full`: it states nearly every fact, in one form for equal seeds.
    /// Sentences of a group then differ in nothing but what they state.
    virtual StarterClaim claim(std::uint64_t index, std::uint64_t seed, bool full) const = 0;
    /// Sentences that are false of the picture: claim() of the same arguments with one word replaced. May be
    /// empty.
    virtual std::vector<std::string> false_claims(std::uint64_t index, std::uint64_t seed,
                                                  bool full) const = 0;
};

/// Everything that decides the result of a training run.
struct StarterTrainParameters {
    std::string initial;
    std::string average;
    int image_size = 64;
    int pictures = 24000;
    double vae_minutes = 20;
    double unet_minutes = 90;
    double clip_minutes = 12;
    int vae_steps = 0;
    int unet_steps = 0;
    int clip_steps = 0;
    double upscaler_minutes = 0;
    int upscaler_steps = 0;
    int upscaler_pictures = 4000;
    int upscaler_batch = 16;
    double upscaler_lr = 1e-3;
    int threads = 0;
    int vae_batch = 8;
    int unet_batch = 16;
    int clip_batch = 32;
    int clip_pictures = 24000;
    double vae_lr = 1.5e-3;
    double unet_lr = 8e-4;
    double clip_lr = 1e-3;
    int vae_channels = 16;
    int unet_channels = 80;
    int text_width = 128;
    int clip_width = 128;
    double direction_weight = 0.5;
    double false_weight = 1;
    double grounding_weight = 0.1;
    double spread_weight = 0.03;
    double insertion_share = 0.3;
    double caption_dropout = 0.1;
    double restyled_share = 0;
    double more_share = 0;
    bool more_looks = false;
    bool bf16 = false;
    std::string device = "cpu";
    std::uint64_t seed = 1;

    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        f("initial", self.initial,
          "Starter folder to go on from; parts with neither minutes nor steps stay as they are there.");
        f("average", self.average,
          "Second starter folder, whose text encoder and UNet are averaged with the initial ones.");
        f("image_size", self.image_size, "Side of the training pictures in pixels.", Range{32, 256});
        f("pictures", self.pictures, "Number of training pictures rendered first.", Range{8, 1e6});
        f("vae_minutes", self.vae_minutes, "Time for the VAE, unless steps are set.", Range{0, 1e5});
        f("unet_minutes", self.unet_minutes, "Time for the UNet and its text encoder, unless steps are set.",
          Range{0, 1e5});
        f("clip_minutes", self.clip_minutes, "Time for the image-text encoder, unless steps are set.",
          Range{0, 1e5});
        f("vae_steps", self.vae_steps, "Steps of the VAE; 0 = go by time.", Range{0, 1e8});
        f("unet_steps", self.unet_steps, "Steps of the UNet; 0 = go by time.", Range{0, 1e8});
        f("clip_steps", self.clip_steps, "Steps of the image-text encoder; 0 = go by time.", Range{0, 1e8});
        visit_upscaler_fields(self, f);
        f("threads", self.threads, "Single-threaded replicas whose gradients are averaged; 0 = one per core.",
          Range{0, 64});
        f("vae_batch", self.vae_batch, "Pictures per replica and VAE step.", Range{1, 4096});
        f("unet_batch", self.unet_batch, "Pictures per replica and UNet step.", Range{1, 4096});
        f("clip_batch", self.clip_batch,
          "Groups of twin pictures per replica and step of the image-text encoder.", Range{2, 4096});
        f("clip_pictures", self.clip_pictures, "Twin pictures rendered for the image-text encoder.",
          Range{8, 1e6});
        f("vae_lr", self.vae_lr, "Peak learning rate of the VAE (cosine to zero).", Range{0, 1});
        f("unet_lr", self.unet_lr, "Peak learning rate of the UNet (cosine to zero).", Range{0, 1});
        f("clip_lr", self.clip_lr, "Peak learning rate of the image-text encoder (cosine to zero).",
          Range{0, 1});
        f("vae_channels", self.vae_channels, "Channels of the VAE at full resolution.", Range{8, 512});
        f("unet_channels", self.unet_channels, "Channels of the UNet at latent resolution.", Range{16, 1024});
        f("text_width", self.text_width, "Width of the text encoder.", Range{32, 1024});
        f("clip_width", self.clip_width, "Width of the image encoder of the image-text encoder.",
          Range{32, 1024});
        f("direction_weight", self.direction_weight,
          "Weight of the loss that makes picture changes point where sentence changes point.", Range{0, 10});
        f("false_weight", self.false_weight,
          "Weight of the loss that tells a sentence from one with a word replaced.", Range{0, 10});
        f("grounding_weight", self.grounding_weight,
          "Weight of the loss that makes the words of a part attend to that part.", Range{0, 10});
        f("spread_weight", self.spread_weight,
          "Weight of the loss that spreads each word evenly over its part.", Range{0, 10});
        f("insertion_share", self.insertion_share,
          "Share of pictures without accessory that are shown with a caption naming one (attention only).",
          Range{0, 1});
        f("caption_dropout", self.caption_dropout, "Share of empty captions (classifier-free guidance).",
          Range{0, 1});
        f("restyled_share", self.restyled_share,
          "Share of the scenes of --pictures-only in which a part gets another look and nothing is added.",
          Range{0, 1});
        f("more_share", self.more_share,
          "Share of the scenes of --pictures-only with words that the network for finding is not trained on.",
          Range{0, 1});
        f("more_looks", self.more_looks, "Take only materials, colours and grounds of those words.");
        f("bf16", self.bf16,
          "Compute convolutions and matrix products of text encoder and UNet in bfloat16.");
        f("device", self.device, "cpu or cuda.");
        f("seed", self.seed, "Seed of pictures, weights, wording and noise.");
    }
    template <class Self, class F> static void visit_upscaler_fields(Self& self, F&& f) {
        f("upscaler_minutes", self.upscaler_minutes, "Time for the upscaler, unless steps are set.",
          Range{0, 1e5});
        f("upscaler_steps", self.upscaler_steps, "Steps of the upscaler; 0 = go by time.", Range{0, 1e8});
        f("upscaler_pictures", self.upscaler_pictures, "Pictures rendered for the upscaler, at both sizes.",
          Range{8, 1e6});
        f("upscaler_batch", self.upscaler_batch, "Sections of pictures per replica and step of the upscaler.",
          Range{1, 4096});
        f("upscaler_lr", self.upscaler_lr, "Peak learning rate of the upscaler (cosine to zero).",
          Range{0, 1});
    }
};

/// Trains in `work` (pictures, checkpoints, log.tsv; an interrupted run resumes there) and writes the
/// finished model as a diffusers folder in fp16 to `output`. Throws Error; on a stop request the last
/// checkpoint stays and Cancelled is thrown.
void train_starter(const StarterTrainParameters& parameters, const StarterSource& source,
                   const std::filesystem::path& work, const std::filesystem::path& output,
                   const JobControl& job);

}  // namespace gse::training

/// The one symbol of the laboratory's plug-in (libgse_starter.so): train_starter().
extern "C" void gse_train_starter(const gse::training::StarterTrainParameters& parameters,
                                  const gse::training::StarterSource& source,
                                  const std::filesystem::path& work, const std::filesystem::path& output,
                                  const gse::JobControl& job);
