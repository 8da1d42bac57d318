// Names, and the choice for a family.
#include "engine/remote/views/agreement.h"

#include <array>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "engine/base/error.h"
#include "engine/base/printable.h"

namespace gse::remote {
namespace {

constexpr std::array<std::pair<Agreement, std::string_view>, 5> AgreementNames{
    {{Agreement::Auto, "auto"},
     {Agreement::None, "none"},
     {Agreement::Sheet, "sheet"},
     {Agreement::Reference, "reference"},
     {Agreement::Warp, "warp"}}};

}  // namespace

std::string_view agreement_name(Agreement agreement) {
    for (const auto& [known, name] : AgreementNames)
        if (known == agreement) return name;
    return {};
}

Agreement agreement_of(std::string_view name) {
    for (const auto& [agreement, known] : AgreementNames)
        if (known == name) return agreement;
    throw Error(ErrorCode::InvalidArgument,
                fmt::format("\"{}\" is no way to make views agree", printable(name)),
                "name one of auto, none, sheet, reference, warp");
}

Agreement suited_agreement(Agreement asked, const ModelFamily& family, const ServerFacts& facts,
                           bool follows) {
    // The picture to redraw is one of them for servers that edit by references alone.
    const bool shows_another = family.references > 0 && facts.references > 1;
    if (asked == Agreement::Reference && facts.references == 0)
        throw Error(ErrorCode::InvalidArgument,
                    "this server takes no picture beside the one to redraw, so none can be a reference",
                    "let views agree in another way: --server-agreement sheet, warp or none");
    if (asked != Agreement::Auto) return asked;
    if (family.instructed()) return shows_another ? Agreement::Reference : Agreement::Sheet;
    return family.inpaints || follows ? Agreement::Warp : Agreement::None;
}

}  // namespace gse::remote
