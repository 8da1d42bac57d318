// Keys, bytes, counts.
#include "engine/remote/views/picture_source.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>

#include <fmt/format.h>

#include "engine/base/clock.h"
#include "engine/base/content_hash.h"
#include "engine/base/log.h"
#include "engine/base/printable.h"
#include "engine/remote/api/server_kind.h"

namespace gse::remote {
namespace {

constexpr int MostSide = 16384;  // px of a kept picture; a larger number is damage

/// Values as a PNG of 8 bits has them: a kept picture is the one that came.
Image with_eight_bits(Image picture) {
    for (auto& value : picture.data) value = std::round(std::clamp(value, 0.0f, 1.0f) * 255) / 255;
    return picture;
}

/// Width, height, model's length, model, bytes of the pixels.
std::string bytes_of(const Image& picture, const std::string& model) {
    const std::uint32_t sizes[3] = {static_cast<std::uint32_t>(picture.width),
                                    static_cast<std::uint32_t>(picture.height),
                                    static_cast<std::uint32_t>(model.size())};
    std::string bytes(reinterpret_cast<const char*>(sizes), sizeof sizes);
    bytes += model;
    for (const float value : picture.data) bytes += static_cast<char>(std::lround(value * 255));
    return bytes;
}

std::optional<RedrawnPicture> picture_in(const std::string& bytes) {
    std::uint32_t sizes[3];
    if (bytes.size() < sizeof sizes) return std::nullopt;
    std::memcpy(sizes, bytes.data(), sizeof sizes);
    const auto [width, height, name] = sizes;
    if (width == 0 || height == 0 || width > MostSide || height > MostSide) return std::nullopt;
    const std::size_t first = sizeof sizes + name, values = std::size_t{3} * width * height;
    if (bytes.size() != first + values) return std::nullopt;
    RedrawnPicture kept{Image(static_cast<int>(width), static_cast<int>(height), 3),
                        bytes.substr(sizeof sizes, name)};
    for (std::size_t i = 0; i < values; ++i)
        kept.picture.data[i] = static_cast<float>(static_cast<unsigned char>(bytes[first + i])) / 255;
    return kept;
}

}  // namespace

PictureSource::PictureSource(ImageServer& server, ServerFacts facts, std::string identity, AnswerCache* cache)
    : server_(server), facts_(std::move(facts)), identity_(std::move(identity)), cache_(cache) {}

std::string PictureSource::question_of(const RedrawOrder& order) const {
    ContentHash hash;
    hash.texts({std::string(server_kind_name(facts_.kind)), facts_.product, facts_.model, identity_});
    if (model_changes_ > 0) hash.text(model_);
    hash.texts({order.prompt, order.negative_prompt, order.sampler});
    hash.numbers(order.seed, order.steps, order.guidance_scale, order.distilled_guidance, order.strength);
    hash.image(order.picture);
    hash.image(order.mask);
    hash.numbers(order.references.size());
    for (const auto& reference : order.references) hash.image(reference);
    return "redrawn by a server\n" + hash.key().hex();
}

void PictureSource::note_model(const std::string& model) {
    if (model.empty() || model == model_) return;
    if (!model_.empty()) {
        ++model_changes_;
        log::warning("the server has changed its model from \"{}\" to \"{}\"", printable(model_),
                     printable(model));
    }
    model_ = model;
}

Image PictureSource::ask(const RedrawOrder& order, const JobControl& job) {
    const auto question = question_of(order);
    if (cache_ != nullptr)
        if (const auto answer = cache_->find(question))
            if (auto kept = picture_in(*answer)) {
                ++use_.cached;
                return std::move(kept->picture);
            }
    const double begin = wall_seconds();
    auto redrawn = server_.redraw(order, job);
    ++use_.requests;
    use_.seconds += wall_seconds() - begin;
    use_.megapixels += static_cast<double>(redrawn.picture.pixel_count()) / 1e6;
    redrawn.picture = with_eight_bits(std::move(redrawn.picture));
    note_model(redrawn.model);
    if (cache_ != nullptr) cache_->keep(question_of(order), bytes_of(redrawn.picture, redrawn.model));
    return std::move(redrawn.picture);
}

}  // namespace gse::remote
