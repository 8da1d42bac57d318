// Keys, bytes, counts.
#include "engine/remote/views/picture_source.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>

#include <fmt/format.h>

#include "engine/base/clock.h"
#include "engine/base/content_hash.h"
#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/base/printable.h"
#include "engine/remote/api/server_kind.h"
#include "engine/remote/views/acceptance.h"
#include "engine/remote/views/view_frame.h"

namespace gse::remote {
namespace {

constexpr int MostSide = 16384;  // px of a kept picture; a larger number is damage

/// Values as a PNG of 8 bits has them: a kept picture is the one that came.
Image with_eight_bits(Image picture) {
    for (auto& value : picture.data) value = std::round(std::clamp(value, 0.0f, 1.0f) * 255) / 255;
    return picture;
}

/// 3/4 of a square order's side, as a side that servers take; 0 where there is none.
int smaller_side(const RedrawOrder& order) {
    const auto& picture = order.picture;
    return picture.width == picture.height ? picture.width * 3 / 4 / SideStep * SideStep : 0;
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

/// A full disk is said once: the edit goes on, and only a second run asks again.
void PictureSource::keep(const RedrawOrder& order, const RedrawnPicture& redrawn) {
    if (cache_ == nullptr) return;
    const auto question = question_of(order);
    cache_->keep(question, bytes_of(redrawn.picture, redrawn.model));
    if (cache_->find(question)) return;
    if (use_.not_kept++ == 0)
        log::warning("pictures of the server cannot be kept on the disk: another run asks for them again");
}

Image PictureSource::ask(const RedrawOrder& order, const JobControl& job) {
    if (use_.smaller_side > 0 && use_.smaller_side < order.picture.width) return ask_smaller(order, job);
    try {
        return ask_as_ordered(order, job);
    } catch (const Error& error) {
        const int side = smaller_side(order);
        if (error.hint() != TooLargeHint || side == 0) throw;
        log::warning("{}: pictures are asked for at {} x {} pixels in place of {} x {}", error.message(),
                     side, side, order.picture.width, order.picture.height);
        use_.smaller_side = side;
    }
    return ask_smaller(order, job);
}

Image PictureSource::ask_smaller(const RedrawOrder& order, const JobControl& job) {
    const int side = use_.smaller_side;
    RedrawOrder smaller = order;
    smaller.picture = at_side(order.picture, side);
    if (!order.mask.data.empty()) smaller.mask = at_side(order.mask, side);
    for (auto& reference : smaller.references)
        if (is_square(reference) && reference.width > side) reference = at_side(reference, side);
    try {
        auto picture = ask_as_ordered(smaller, job);
        const bool usable = is_square(picture);
        return usable ? with_eight_bits(at_side(picture, order.picture.width)) : picture;
    } catch (const Error& error) {
        if (error.hint() != TooLargeHint) throw;
        throw Error(error.code(), fmt::format("{}, also at {} x {} pixels", error.message(), side, side),
                    error.hint());
    }
}

/// Counts it. The watch is told of the end, whatever it is.
RedrawnPicture PictureSource::drawn(const RedrawOrder& order, const JobControl& job) {
    const double begin = wall_seconds();
    auto redrawn = watch_ ? shown_while_drawn(order, job) : server_.redraw(order, job);
    ++use_.requests;
    use_.seconds += wall_seconds() - begin;
    use_.megapixels += static_cast<double>(redrawn.picture.pixel_count()) / 1e6;
    if (watch_) watch_({{}, {}, use_});
    return redrawn;
}

RedrawnPicture PictureSource::shown_while_drawn(RedrawOrder order, const JobControl& job) {
    const auto sent = std::make_shared<const Image>(order.picture);
    order.preview = [&](const Image& preview) {
        watch_({sent, std::make_shared<const Image>(preview), use_});
    };
    try {
        return server_.redraw(order, job);
    } catch (...) {
        watch_({{}, {}, use_});
        throw;
    }
}

Image PictureSource::ask_as_ordered(const RedrawOrder& order, const JobControl& job) {
    const auto question = question_of(order);
    if (cache_ != nullptr)
        if (const auto answer = cache_->find(question))
            if (auto kept = picture_in(*answer)) {
                ++use_.cached;
                return std::move(kept->picture);
            }
    auto redrawn = drawn(order, job);
    redrawn.picture = with_eight_bits(std::move(redrawn.picture));
    note_model(redrawn.model);
    keep(order, redrawn);
    return std::move(redrawn.picture);
}

}  // namespace gse::remote
