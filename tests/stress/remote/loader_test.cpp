// The plug-in as the program loads it.
#include <doctest/doctest.h>

#include "engine/pipeline/models/remote_loader.h"
#include "tests/stress/remote/stand_in.h"
#include "tests/test_paths.h"

namespace gse::remote {
namespace {

DOCTEST_TEST_CASE("the plug-in asks servers, and its errors are ours") {
    if (!can_stand_in()) return;
    if (pipeline::remote_library().empty()) return test::skip_missing("this build has no libgse_remote.so");
    auto& api = pipeline::remote_api();
    auto& stand_in = shared_stand_in("forge");
    const auto server = api.connect(stand_in.address(), {});
    DOCTEST_CHECK(server->probe({}).product == "Forge");
    DOCTEST_CHECK(server->redraw(small_order(), {}).picture.width == 64);
    ServerAddress address;
    address.url = "ftp://host";
    DOCTEST_CHECK(caught([&] { api.connect(address, {}); }).is(ErrorCode::InvalidArgument));
    DOCTEST_CHECK(api.keep_credentials("http://host:1/x/") == "http://host:1/x");
}

}  // namespace
}  // namespace gse::remote
