// Names of protocols, there and back.
#include <doctest/doctest.h>

#include "engine/base/error.h"
#include "engine/remote/api/server_kind.h"

namespace gse::remote {
namespace {

DOCTEST_TEST_CASE("every protocol has a name that leads back to it") {
    for (const auto kind : {ServerKind::Webui, ServerKind::OpenAi, ServerKind::SdCpp, ServerKind::Comfy})
        DOCTEST_CHECK(server_kind_of(server_kind_name(kind)) == kind);
    DOCTEST_CHECK_THROWS_AS(server_kind_of("gradio"), Error);
}

}  // namespace
}  // namespace gse::remote
