// Frames of labelled things, and edits that are remade at every change.
#include "app/session/edit/placing.h"

#include <fmt/format.h>

#include <utility>

#include "engine/scene/transform/transform_edits.h"

namespace gse::app {

Placing::Placing(DocumentState before, std::shared_ptr<const std::vector<std::uint8_t>> rows,
                 const Vec3& front)
    : before_(std::move(before)), rows_(std::move(rows)),
      thing_(edit::thing_frame(before_.current, *rows_, before_.info.up, front)) {}

bool Placing::is_of(const DocumentState& state,
                    const std::shared_ptr<const std::vector<std::uint8_t>>& rows) const {
    return rows == rows_ && state.current.shares_all_with(before_.current);
}

ui::PlacedThing Placing::shown() const {
    const auto& standing = thing_.standing;
    return {standing.foot,      thing_.frame.side, thing_.frame.up,
            thing_.frame.front, standing.height,   standing.width()};
}

DocumentState Placing::placed(const edit::RearrangeSettings& settings, std::uint64_t id) const {
    if (settings.copies > 1 && others_.empty())
        others_ = edit::other_points(before_.current, *rows_, thing_.frame);
    const auto places = edit::rearrangement(settings, thing_, nullptr, others_);
    EditNode node = transform_of(before_, *rows_, places.thing, id);
    if (!places.copies.empty()) {
        const EditNode copies = copies_of(before_, *rows_, places.copies, id);
        SceneDelta delta = *node.delta;
        delta.added = copies.delta->added;
        delta.added_rows = copies.delta->added_rows;
        node.delta = std::make_shared<const SceneDelta>(std::move(delta));
    }
    node.name = placing_text(settings);
    auto stack = before_.stack;
    stack.push_back(std::move(node));
    return with_stack(before_, std::move(stack));
}

std::string placing_text(const edit::RearrangeSettings& settings) {
    std::string text;
    const edit::RearrangeSettings standard;
    edit::RearrangeSettings::visit_fields(
        settings, [&](const char* name, const auto& value, const char*, auto...) {
            using Value = std::remove_cvref_t<decltype(value)>;
            Value usual{};
            edit::RearrangeSettings::visit_fields(
                standard, [&](const char* other, const auto& of, const char*, auto...) {
                    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(of)>, Value>)
                        if (std::string_view(other) == name) usual = of;
                });
            if (value == usual) return;
            std::string said(name);
            for (auto& letter : said)
                if (letter == '_') letter = ' ';
            if constexpr (std::is_same_v<Value, double>) said += fmt::format(" {:.3g}", value);
            else if constexpr (std::is_same_v<Value, int>) said += fmt::format(" {}", value);
            text += (text.empty() ? "Place: " : ", ") + said;
        });
    return text.empty() ? "Place" : text;
}

}  // namespace gse::app
