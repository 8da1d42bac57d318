// Servers whose pictures do not go together.
#include "engine/remote/spread/further_server.h"

#include <fmt/format.h>

#include "engine/base/error.h"
#include "engine/base/printable.h"
#include "engine/remote/api/server_kind.h"

namespace gse::remote {

void check_alike(const NamedServer& first, const NamedServer& further) {
    constexpr auto hint = "name servers of one kind that have loaded one model";
    if (further.facts.kind != first.facts.kind)
        throw Error(
            ErrorCode::InvalidArgument,
            fmt::format("{} is a server of another kind ({}) than {} ({})", further.name,
                        server_kind_name(further.facts.kind), first.name, server_kind_name(first.facts.kind)),
            hint);
    const auto &one = first.facts.model, &other = further.facts.model;
    if (!one.empty() && !other.empty() && one != other)
        throw Error(ErrorCode::InvalidArgument,
                    fmt::format("{} draws with another model (\"{}\") than {} (\"{}\")", further.name,
                                printable(other), first.name, printable(one)),
                    hint);
}

}  // namespace gse::remote
