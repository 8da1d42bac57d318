// Attention maps: single-step probes or the paper's image-to-image run (METHOD.md, Attention maps).
#include "engine/neural/guidance/attention_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <sstream>

#include "engine/base/error.h"
#include "engine/edit/search/cached_attention.h"
#include "engine/neural/layers/images.h"
#include "engine/neural/layers/parallel_for_batches.h"
#include "engine/neural/layers/torch_errors.h"

namespace gse::neural {
namespace {

// Noise levels as shares of the schedule, unless the model states its own (METHOD.md, Attention maps).
const std::vector<double> PresentLevels{0.45};
const std::vector<double> AbsentLevels{0.85};
constexpr double AbsentStrength = 0.9;      // img2img must begin at least this noisy for an absent thing ...
constexpr double AbsentLowestLevel = 0.75;  // ... and only steps above this level are looked at
// 1024 x 1024 numbers per head and picture (METHOD.md, Attention maps)
constexpr std::int64_t LargestAffinitySide = 32;
constexpr int QueriesPerThread = 4;  // prepared together: a stop request waits for them
// Latent cells per UNet call: one SD image, 16 of the starter's.
constexpr std::int64_t BatchPixels = 64 * 64;

bool any_prefix(std::string_view name, const std::vector<std::string>& prefixes) {
    return std::any_of(prefixes.begin(), prefixes.end(),
                       [&](const auto& prefix) { return name.starts_with(prefix); });
}

/// "0.3 0.5 0.7"; none in an empty text. Throws Error (InvalidArgument) unless all are shares.
std::vector<double> levels_in(const std::string& text) {
    std::vector<double> levels;
    std::istringstream stream(text);
    for (std::string word; stream >> word;) {
        char* end = nullptr;
        const double level = std::strtod(word.c_str(), &end);
        if (*end != 0 || !(level >= 0 && level <= 1))
            throw Error(ErrorCode::InvalidArgument, fmt::format("\"{}\" is no noise level", word),
                        "write shares like 0.3 0.5 0.7");
        levels.push_back(level);
    }
    return levels;
}

/// Mean over the word's tokens [k,s,s], at the image's size.
Image word_map(const torch::Tensor& tokens, int width, int height) {
    auto map = tokens.mean(0).unsqueeze(0).unsqueeze(0);
    map = torch::upsample_bicubic2d(map, {height, width}, false).clamp_min(0);
    return to_image(map);
}

/// Picture beside the noisy one, for models that take one.
torch::Tensor shown_picture(const ModelBundle& bundle, const torch::Tensor& latents) {
    return takes_picture(bundle.unet->config()) ? latents / bundle.scaling_factor() : torch::Tensor();
}

}  // namespace

std::string with_view_words(const std::string& prompt, const std::string& view_words) {
    return view_words.empty() ? prompt : prompt + ", " + view_words;
}

AttentionAccumulator::AttentionAccumulator(std::int64_t size, std::int64_t columns)
    : sum_(torch::zeros({columns, size, size}, torch::kFloat32)) {}

void AttentionAccumulator::take(std::vector<AttentionCapture::Map>& maps) {
    for (const auto& map : maps) {
        // [hw,k].
        auto mean = map.probabilities.to(torch::kCPU, torch::kFloat32).mean(torch::IntArrayRef{0, 1});
        mean = mean.t().reshape({1, sum_.size(0), map.height, map.width});
        if (map.height != sum_.size(1) || map.width != sum_.size(2))
            mean = torch::upsample_bicubic2d(mean, {sum_.size(1), sum_.size(2)}, false).clamp_min(0);
        sum_ += mean[0];
        ++count_;
    }
    maps.clear();
}

void AttentionAccumulator::take_affinities(std::vector<AttentionCapture::Map>& affinities) {
    for (const auto& map : affinities) {
        if (map.height != map.width || map.height < affinity_height_) continue;
        const auto mean = map.probabilities.to(torch::kCPU, torch::kFloat32).mean(0);
        if (map.height > affinity_height_) {
            affinity_ = torch::zeros_like(mean);
            affinities_ = 0;
            affinity_height_ = map.height;
        }
        affinity_ += mean;
        ++affinities_;
    }
    affinities.clear();
}

torch::Tensor AttentionAccumulator::mean() const { return sum_ / std::max<std::int64_t>(count_, 1); }

torch::Tensor AttentionAccumulator::refined(int times) const {
    auto map = mean();
    if (times < 1 || affinities_ == 0) return map;
    const auto side = affinity_height_;
    if (map.size(1) != side) map = torch::adaptive_avg_pool2d(map.unsqueeze(0), {side, side})[0];
    const auto along = (affinity_ / affinities_).t();
    map = map.flatten(1);
    for (int i = 0; i < times; ++i) map = map.mm(along);
    return map.view({-1, side, side});
}

BundleAttentionSource::BundleAttentionSource(std::shared_ptr<const ModelBundle> bundle,
                                             AttentionParameters parameters)
    : bundle_(std::move(bundle)), parameters_(std::move(parameters)) {
    if (parameters_.method != "probes" && parameters_.method != "img2img")
        throw Error(ErrorCode::InvalidArgument,
                    fmt::format("there is no attention method \"{}\"", parameters_.method),
                    "use probes or img2img");
    levels_ = levels_in(parameters_.levels);
}

AttentionCapture BundleAttentionSource::make_capture() const {
    const auto& facts = bundle_->facts;
    const auto latent = bundle_->latent_size();
    auto layers = facts.attention_layers;
    auto sizes = facts.attention_sizes;
    // A model that names its layers was trained to ground words at full latent resolution. For all others:
    // DAAM, that is everything but the middle and the smallest maps (8x8 at 64x64).
    // Refined maps are as large as the affinities: larger ones would be shrunk again.
    if (sizes.empty() && layers.empty())
        sizes = parameters_.refinement > 0 && latent > LargestAffinitySide
                    ? std::vector{latent / 2, latent / 4}
                    : std::vector{latent, latent / 2, latent / 4};
    else if (sizes.empty()) sizes = {latent};
    if (layers.empty()) layers = {"down_blocks", "up_blocks"};
    AttentionCapture capture;
    capture.wants = [layers, sizes](std::string_view layer, std::int64_t height, std::int64_t) {
        return any_prefix(layer, layers) && std::find(sizes.begin(), sizes.end(), height) != sizes.end();
    };
    capture.stop_after_last = parameters_.method == "probes";
    capture.self_attention_side = parameters_.refinement > 0 ? LargestAffinitySide : 0;
    return capture;
}

void BundleAttentionSource::probe(const edit::AttentionQuery& query, const torch::Tensor& latents,
                                  const torch::Tensor& context, AttentionCapture& capture,
                                  AttentionAccumulator& sum) const {
    const auto& facts = bundle_->facts;
    auto levels = query.absent      ? facts.attention_absent_timesteps
                  : levels_.empty() ? facts.attention_timesteps
                                    : levels_;
    if (levels.empty()) levels = query.absent ? AbsentLevels : PresentLevels;
    std::vector<torch::Tensor> noises;
    std::vector<std::int64_t> timesteps;
    const auto last = bundle_->schedule.steps() - 1;
    for (int repeat = 0; repeat < std::max(1, query.repeats); ++repeat)
        for (const double level : levels) {
            const auto t = static_cast<std::int64_t>(level * static_cast<double>(bundle_->schedule.steps()));
            timesteps.push_back(std::clamp<std::int64_t>(t, 0, last));
            noises.push_back(
                seeded_noise(latents.sizes(), Random::stream(query.seed, timesteps.size()).next()));
        }
    const auto count = static_cast<std::int64_t>(timesteps.size());
    const auto shown = shown_picture(*bundle_, latents);
    const auto batch = std::max<std::int64_t>(1, BatchPixels / (latents.size(2) * latents.size(3)));
    const auto all_noise = torch::cat(noises).to(latents.device());
    const auto all_t = torch::tensor(timesteps, torch::kInt64);
    for (std::int64_t first = 0; first < count; first += batch) {
        const auto size = std::min(batch, count - first);
        const auto t = all_t.narrow(0, first, size);
        const auto start = latents.expand({size, -1, -1, -1});
        const auto noisy = bundle_->schedule.add_noise(start, all_noise.narrow(0, first, size), t);
        const auto words = context.expand({size, -1, -1});
        const double scale = bundle_->unet->config().time_cond_proj_dim > 0 ? UsualEmbeddedScale : 1;
        const Conditioning conditioning{torch::stack({words, words}, 1), scale,
                                        shown.defined() ? shown.expand({size, -1, -1, -1}) : shown};
        guided_output(bundle_->unet, noisy, t, conditioning, &capture);
        // Equal weight for every pass: a smaller last batch must not count as much as a full one.
        for (auto& map : capture.maps)
            for (std::int64_t row = 0; row < size; ++row) {
                std::vector<AttentionCapture::Map> one = {
                    {map.layer, map.height, map.width, map.probabilities.narrow(0, row, 1)}};
                sum.take(one);
            }
        capture.maps.clear();
        sum.take_affinities(capture.affinities);
    }
}

void BundleAttentionSource::run_img2img(const edit::AttentionQuery& query, const torch::Tensor& latents,
                                        const torch::Tensor& context, AttentionCapture& capture,
                                        AttentionAccumulator& sum) {
    const auto& schedule = bundle_->schedule;
    const auto negative = context_of("");
    const double lowest = query.absent ? AbsentLowestLevel * static_cast<double>(schedule.steps()) : 0;
    for (int repeat = 0; repeat < std::max(1, query.repeats); ++repeat) {
        const auto sampler = make_sampler(SamplerKind::Ddim, schedule, parameters_.steps);
        const auto seed = Random::stream(query.seed, static_cast<std::uint64_t>(repeat)).next();
        DenoiseJob job;
        job.sampler = sampler.get();
        job.first =
            first_step(sampler->step_count(),
                       query.absent ? std::max(AbsentStrength, parameters_.strength) : parameters_.strength);
        job.guidance_scale = parameters_.guidance_scale;
        job.context = torch::cat({negative, context});
        job.seed = seed;
        job.capture = &capture;
        job.picture = shown_picture(*bundle_, latents);
        job.image_guidance_scale = 1;
        capture.conditional_half_only =
            row_parts(bundle_->unet->config(), {{}, job.guidance_scale, {}, job.image_guidance_scale}) == 2;
        job.after_step = [&](std::int64_t step, const torch::Tensor&) {
            // With few steps none may be that high: then the first one counts.
            if (sampler->timestep(step) < lowest && step != job.first) {
                capture.maps.clear();
                capture.affinities.clear();
            }
            sum.take(capture.maps);
            sum.take_affinities(capture.affinities);
        };
        const auto noise = seeded_noise(latents.sizes(), seed).to(latents.device());
        denoise(*bundle_, sampler->start_from(latents, noise, job.first), job);
    }
}

torch::Tensor BundleAttentionSource::context_of(const std::string& sentence) {
    const std::lock_guard lock(mutex_);
    auto& context = contexts_[sentence];
    if (!context.defined()) context = bundle_->encode_prompts({sentence});
    return context;
}

torch::Tensor BundleAttentionSource::latents_of(const Image& picture) {
    return latents_.get(key_of(picture), [&] {
        return image_to_latents(*bundle_,
                                resize_square(to_tensor(picture, bundle_->device), bundle_->image_size()),
                                Codec::Quick);
    });
}

std::size_t BundleAttentionSource::at_once() const {
    const bool apart = is_small(bundle_->unet->config()) && bundle_->device.is_cpu();
    return apart ? static_cast<std::size_t>(QueriesPerThread * batch_threads()) : 1;
}

void BundleAttentionSource::prepare(std::span<const edit::AttentionQuery> queries) {
    if (at_once() == 1) return;
    prepared_.clear();  // what nobody came for
    std::vector<std::vector<Image>> answers(queries.size());
    guard_torch("finding the words in the images", [&] {
        parallel_for_batches(
            static_cast<std::int64_t>(queries.size()), true, [&](std::int64_t begin, std::int64_t end) {
                for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
                    try {
                        answers[i] = maps_of(queries[i]);
                    } catch (const Error&) {  // locate() says it where it is asked
                    }
                }
            });
    });
    for (std::size_t i = 0; i < queries.size(); ++i)
        if (!answers[i].empty()) prepared_[edit::key_of(queries[i])] = std::move(answers[i]);
}

std::vector<Image> BundleAttentionSource::locate(const edit::AttentionQuery& query) {
    if (!prepared_.empty())
        if (auto known = prepared_.extract(edit::key_of(query))) return std::move(known.mapped());
    std::vector<Image> maps;
    parallel_for_batches(1, at_once() > 1, [&](std::int64_t, std::int64_t) {
        maps = maps_of(query);
    });  // as prepare() would have it, bit by bit
    return maps;
}

std::vector<Image> BundleAttentionSource::maps_of(const edit::AttentionQuery& query) {
    const auto prompt = bundle_->model_prompt(with_view_words(query.prompt, query.view_words));
    std::vector<std::vector<std::int64_t>> columns;
    AttentionCapture capture = make_capture();
    for (const auto& word : query.words) {
        columns.push_back(bundle_->tokenizer.find_word(prompt, word, bundle_->token_count()));
        capture.columns.insert(capture.columns.end(), columns.back().begin(), columns.back().end());
    }
    if (columns.empty()) return {};
    return guard_torch("finding the words in the image", [&] {
        const torch::NoGradGuard no_grad;
        const auto latents = latents_of(query.image);
        const auto context = context_of(prompt);
        AttentionAccumulator sum(latents.size(2), static_cast<std::int64_t>(capture.columns.size()));
        if (parameters_.method == "probes") probe(query, latents, context, capture, sum);
        else run_img2img(query, latents, context, capture, sum);
        const auto mean = checked(sum);
        std::vector<Image> images;
        std::int64_t column = 0;
        for (const auto& tokens : columns) {
            const auto count = static_cast<std::int64_t>(tokens.size());
            images.push_back(word_map(mean.narrow(0, column, count), query.image.width, query.image.height));
            column += count;
        }
        return images;
    });
}

torch::Tensor BundleAttentionSource::checked(const AttentionAccumulator& sum) const {
    if (sum.count() == 0)
        throw Error(ErrorCode::Model,
                    "the model has no cross-attention layer of the kind that its facts name",
                    "correct attention_layers and attention_sizes in gseditpro.json", bundle_->path);
    auto mean = sum.refined(parameters_.refinement);
    if (!torch::isfinite(mean).all().item<bool>())
        throw Error(ErrorCode::Model, "the attention maps hold values that are not finite numbers",
                    "the model's weights are damaged or the image holds non-finite pixels", bundle_->path);
    return mean;
}

}  // namespace gse::neural
