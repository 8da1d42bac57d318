// Splats that the artist does not want to see at present; the document never changes.
#include "app/session/hidden_splats.h"

#include <algorithm>

namespace gse::app {

std::vector<std::uint8_t> HiddenSplats::of_document() const {
    return rows_.rows(*workspace_.document.state().row_ids);
}

void HiddenSplats::hide_label(bool others) {
    const NamedLabel* label = workspace_.active_label();
    if (label == nullptr || !label->bits) return;
    if (std::none_of(label->bits->begin(), label->bits->end(), [](auto bit) { return bit != 0; })) return;
    const auto& ids = *workspace_.document.state().row_ids;
    if (others) rows_.isolate(ids, *label->bits);
    else rows_.hide(ids, *label->bits);
    change();
}

void HiddenSplats::show_all() {
    rows_.show_all();
    if (!workspace_.document.empty()) change();
}

void HiddenSplats::follow_document() {
    if (any()) change();
}

void HiddenSplats::change() {
    seen_.clear();
    ++number_;
    ++workspace_.content;
    const auto rows = of_document();
    count_ = static_cast<std::size_t>(std::count(rows.begin(), rows.end(), std::uint8_t{1}));
}

}  // namespace gse::app
