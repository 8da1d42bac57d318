// Two pictures of each view, and the part in which they differ.
#include "engine/remote/views/difference_source.h"

#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/base/random.h"
#include "engine/localize/clusters.h"
#include "engine/remote/views/acceptance.h"
#include "engine/remote/views/painted_part.h"
#include "engine/remote/views/view_frame.h"

namespace gse::remote {
namespace {

constexpr std::uint64_t SecondSeed = 72000;
// Share of the noise levels at which two sentences are compared, as in DiffEdit: less keeps the picture.
constexpr double ComparedStrength = 0.5;

bool has_side(const Image& picture, int side) { return picture.width == side && picture.height == side; }

}  // namespace

DifferenceSource::DifferenceSource(PictureSource& source, DifferenceEdit edit, JobControl job)
    : source_(source), edit_(std::move(edit)), job_(std::move(job)) {
    if (edit_.drawing.family.inpaints)
        throw Error(ErrorCode::InvalidArgument,
                    "a model that fills masks does not show where a thing is: it redraws what it is told to",
                    "use a model that edits by instructions, or label the thing (--at, --cut-out)");
    if (edit_.paints && !edit_.drawing.family.instructed())
        throw Error(ErrorCode::InvalidArgument,
                    "a model that is told what pictures show cannot be told to paint a thing",
                    "use --server-search differences, or a model that edits by instructions");
}

std::vector<Image> DifferenceSource::locate(const edit::AttentionQuery& query) {
    std::vector<Image> maps;
    for (const auto& word : query.words) {
        maps.emplace_back(query.image.width, query.image.height, 1);
        if (word != edit_.thing || query.absent) continue;
        const auto part = part_of(query);
        if (part.found == ChangeFound::Part)
            maps.back() = localize::resize_image(part.map, query.image.width, query.image.height);
        else
            log::info("the server changed {} in a view, which does not vote",
                      part.found == ChangeFound::Nothing ? "nothing" : "everything");
    }
    return maps;
}

ChangedPart DifferenceSource::painted(const Image& sent, std::uint64_t seed) {
    const auto& colour = rarest_colour(sent);
    EditText text;
    text.instruction = fmt::format("paint the {} completely in flat, unshaded {}, every part of it",
                                   edit_.thing, colour.words);
    const auto& family = edit_.drawing.family;
    const Image drawn = ask(order(sent, prompt_for_view(family, text, "", false), seed, family.strength));
    return painted_part(sent, aligned(sent, drawn), colour);
}

ChangedPart DifferenceSource::part_of(const edit::AttentionQuery& query) {
    const auto& text = edit_.drawing.text;
    const auto& family = edit_.drawing.family;
    const Image sent = at_side(query.image, edit_.drawing.side);
    if (edit_.paints) return painted(sent, query.seed);
    const auto prompt = prompt_for_view(family, text, query.view_words, false);
    if (!family.instructed()) {
        const auto [as_it_is, edited] = ask_both({order(sent, edit_.before, query.seed, ComparedStrength),
                                                  order(sent, prompt, query.seed, ComparedStrength)});
        return changed_part(as_it_is, std::span(&edited, 1));
    }
    const std::uint64_t other = Random::stream(query.seed, SecondSeed).next();
    const auto [first, second] = ask_both(
        {order(sent, prompt, query.seed, family.strength), order(sent, prompt, other, family.strength)});
    return changed_part(sent, std::array{aligned(sent, first), aligned(sent, second)});
}

RedrawOrder DifferenceSource::order(const Image& picture, const std::string& prompt, std::uint64_t seed,
                                    double strength) const {
    auto order = order_of(edit_.drawing.family);
    order.picture = picture;
    order.prompt = prompt;
    if (edit_.drawing.family.negative) order.negative_prompt = edit_.drawing.text.negative;
    order.seed = server_seed(seed);
    order.strength = strength;
    suit_to_server(order, source_.facts(), edit_.drawing.family);
    return order;
}

std::array<Image, 2> DifferenceSource::ask_both(const std::array<RedrawOrder, 2>& orders) {
    source_.prefetch({orders.begin(), orders.end()}, {{}, job_.stop});
    auto first = ask(orders[0]);
    return {std::move(first), ask(orders[1])};
}

/// Picture of the sent one's size; the sent one itself where what came has another shape.
Image DifferenceSource::ask(const RedrawOrder& order) {
    if (job_.stop_requested()) throw Error(ErrorCode::Cancelled, "the search was stopped");
    const auto& picture = order.picture;
    const Image drawn = source_.ask(order, {{}, job_.stop});
    if (has_side(drawn, picture.width)) return drawn;
    if (is_square(drawn)) return at_side(drawn, picture.width);
    log::info("the server sent a picture of another shape, which does not count");
    return picture;
}

}  // namespace gse::remote
