// Keys, bytes, counts.
#include "engine/remote/views/picture_source.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <set>
#include <utility>

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
    return picture.width == picture.height ? picture.width * 3 / 4 / order.side_step * order.side_step : 0;
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

PictureSource::PictureSource(ImageServer& server, ServerFacts facts, std::string identity, AnswerCache* cache,
                             PictureTimes times)
    : server_(server), facts_(std::move(facts)), identity_(std::move(identity)), cache_(cache),
      times_(std::move(times)) {}

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

bool PictureSource::is_kept(const RedrawOrder& order) const {
    const auto question = question_of(as_asked(order));
    return ahead_.contains(question) || (cache_ != nullptr && cache_->find(question));
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

/// The order at the side at which the server is asked.
RedrawOrder PictureSource::as_asked(const RedrawOrder& order) const {
    const int side = use_.smaller_side;
    RedrawOrder smaller = order;
    if (side == 0 || side >= order.picture.width) return smaller;
    smaller.picture = at_side(order.picture, side);
    if (!order.mask.data.empty()) smaller.mask = at_side(order.mask, side);
    for (auto& reference : smaller.references)
        if (is_square(reference) && reference.width > side) reference = at_side(reference, side);
    return smaller;
}

Image PictureSource::ask_smaller(const RedrawOrder& order, const JobControl& job) {
    const int side = use_.smaller_side;
    try {
        auto picture = ask_as_ordered(as_asked(order), job);
        const bool usable = is_square(picture);
        return usable ? with_eight_bits(at_side(picture, order.picture.width)) : picture;
    } catch (const Error& error) {
        if (error.hint() != TooLargeHint) throw;
        throw Error(error.code(), fmt::format("{}, also at {} x {} pixels", error.message(), side, side),
                    error.hint());
    }
}

void PictureSource::count(const RedrawnPicture& redrawn) {
    ++use_.requests;
    use_.megapixels += static_cast<double>(redrawn.picture.pixel_count()) / 1e6;
}

/// Counts it. The watch is told of the end, whatever it is.
RedrawnPicture PictureSource::drawn(const RedrawOrder& order, const JobControl& asked) {
    const double begin = wall_seconds();
    JobControl job{{}, asked.stop};
    if (asked.progress)  // a server is asked for its progress where somebody listens
        job.progress = [&](std::string_view stage, int step, int total) {
            const auto usual = times_.usual_of_slow();
            if (!usual || stage != DrawingStage) return asked.report(stage, step, total);
            asked.report(SlowStage, std::max(1, static_cast<int>(std::lround(*usual))), 0);
        };
    times_.begin();
    auto redrawn = watch_ ? shown_while_drawn(order, job) : server_.redraw(order, job);
    times_.end();
    use_.seconds += wall_seconds() - begin;
    count(redrawn);
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
    if (const auto ahead = ahead_.extract(question))
        if (auto drawn_before = picture_in(ahead.mapped())) return std::move(drawn_before->picture);
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

// Further servers

bool PictureSource::is_spread() const {
    return std::any_of(further_.begin(), further_.end(), [](const auto& one) { return !one.left_out; });
}

/// Those that are neither kept nor there twice, as a server is asked for them.
std::vector<RedrawOrder> PictureSource::not_drawn(const std::vector<RedrawOrder>& orders) const {
    std::vector<RedrawOrder> missing;
    std::set<std::string> known;
    for (const auto& order : orders) {
        auto asked = as_asked(order);
        const auto question = question_of(asked);
        const bool kept = cache_ != nullptr && cache_->find(question);
        if (!kept && known.insert(question).second) missing.push_back(std::move(asked));
    }
    return missing;
}

void PictureSource::prefetch(const std::vector<RedrawOrder>& orders, const JobControl& job) {
    ahead_.clear();
    if (!is_spread()) return;
    const auto missing = not_drawn(orders);
    if (missing.size() < 2) return;
    std::vector<ImageServer*> servers{&server_};
    std::vector<FurtherServer*> team;
    for (auto& one : further_)
        if (!one.left_out) servers.push_back(one.server), team.push_back(&one);
    const int total = static_cast<int>(missing.size());
    job.report("", 0, total);
    SpreadNews news{[&](std::size_t done) { job.report("", static_cast<int>(done), total); }};
    if (watch_)
        news.preview = [&](const RedrawOrder& order, const Image& preview) {
            watch_(
                {std::make_shared<const Image>(order.picture), std::make_shared<const Image>(preview), use_});
        };
    const double begin = wall_seconds();
    auto spread = draw_spread(servers, missing, news, job.stop);
    use_.seconds += wall_seconds() - begin;
    const auto failures = spread.failures;
    take_spread(missing, std::move(spread), team);
    if (watch_) watch_({{}, {}, use_});
    take_failures(failures, team);
}

/// Pictures of the first server come first: they tell the model that the others have to have.
void PictureSource::take_spread(const std::vector<RedrawOrder>& orders, SpreadDrawing spread,
                                const std::vector<FurtherServer*>& team) {
    const auto take = [&](std::size_t i) {
        auto& redrawn = spread.drawn[i]->redrawn;
        count(redrawn);
        redrawn.picture = with_eight_bits(std::move(redrawn.picture));
        keep(orders[i], redrawn);
    };
    for (std::size_t i = 0; i < orders.size(); ++i)
        if (spread.drawn[i] && spread.drawn[i]->server == 0) {
            note_model(spread.drawn[i]->redrawn.model);
            take(i);
        }
    for (std::size_t i = 0; i < orders.size(); ++i) {
        if (!spread.drawn[i] || spread.drawn[i]->server == 0) continue;
        auto& one = *team[spread.drawn[i]->server - 1];
        const auto& model = spread.drawn[i]->redrawn.model;
        if (!model.empty() && !model_.empty() && model != model_) {
            if (!std::exchange(one.left_out, true))
                log::warning("{} draws with \"{}\", not with \"{}\", and is left out", one.name,
                             printable(model), printable(model_));
            spread.drawn[i].reset();
            continue;
        }
        ++one.drawn;
        take(i);
    }
    for (std::size_t i = 0; i < orders.size(); ++i)
        if (const auto& drawn = spread.drawn[i])
            ahead_[question_of(orders[i])] = bytes_of(drawn->redrawn.picture, drawn->redrawn.model);
}

/// A picture that is too large for the first server is left to ask(), which asks for a smaller one.
void PictureSource::take_failures(const std::vector<std::exception_ptr>& failures,
                                  const std::vector<FurtherServer*>& team) {
    for (std::size_t i = 1; i < failures.size(); ++i) {
        if (!failures[i]) continue;
        try {
            std::rethrow_exception(failures[i]);
        } catch (const Error& error) {
            if (error.code() == ErrorCode::Cancelled) continue;
            if (std::exchange(team[i - 1]->left_out, true)) continue;
            log::warning("{} is left out: {}", team[i - 1]->name, printable(error.message()));
        }
    }
    if (!failures.front()) return;
    try {
        std::rethrow_exception(failures.front());
    } catch (const Error& error) {
        if (error.code() != ErrorCode::Cancelled && error.hint() != TooLargeHint) throw;
    }
}

}  // namespace gse::remote
