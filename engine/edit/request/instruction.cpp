// From a description to an order.
#include "engine/edit/request/instruction.h"

#include <algorithm>
#include <array>

#include "engine/edit/request/words.h"

namespace gse::edit {
namespace {

constexpr std::array<const char*, 3> LeadingArticles{"a", "an", "the"};

}  // namespace

std::string instruction_of(const EditRequest& request) {
    if (!request.instruction.empty()) return request.instruction;
    auto words = words_of(without_identifier(request.prompt));
    const bool led = !words.empty() && std::find(LeadingArticles.begin(), LeadingArticles.end(),
                                                 words.front()) != LeadingArticles.end();
    if (led) words.erase(words.begin());
    const auto result = joined(words);
    return request.source.empty() ? "make it " + result : "turn the " + request.source + " into " + result;
}

}  // namespace gse::edit
