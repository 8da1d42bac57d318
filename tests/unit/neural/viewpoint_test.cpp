// From where a picture shows a thing: shares of azimuths, and files that must be refused.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/neural/clip/viewpoint_model.h"
#include "engine/neural/weights/safetensors.h"
#include "tests/test_paths.h"

namespace {

using namespace gse::neural;

constexpr float SumTolerance = 1e-5f;  // of shares in fp32

/// A folder with an untrained classifier.
struct TinyFolder {
    TinyFolder() {
        torch::manual_seed(5);
        const auto config = ViewpointConfig::from_json(json, "config.json");
        ViewpointModel model(config, WeightOptions{});
        NamedTensors weights;
        for (const auto& parameter : model->named_parameters())
            weights.emplace_back(parameter.key(), torch::randn(parameter.value().sizes()) * 0.3);
        gse::write_file(path() / "config.json", json.dump());
        write_safetensors(path() / "model.safetensors", weights);
    }
    std::filesystem::path path() const { return scratch.path(); }

    Json json{{"image_size", 16}, {"sectors", 8}, {"widths", {8, 16}}, {"hidden", 12}, {"groups", 4}};
    gse::test::ScratchFolder scratch;
};

gse::Image stripes(int width, int height, int left) {
    gse::Image image(width, height, 3);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c) image.at(x, y, c) = static_cast<float>(((x - left) / 3 + c) % 3) / 2;
    return image;
}

bool refused(const TinyFolder& folder, gse::ErrorCode code) {
    try {
        ViewpointReader reader(folder.path(), torch::kCPU);
    } catch (const gse::Error& error) { return error.code() == code; }
    return false;
}

}  // namespace

DOCTEST_TEST_CASE("pictures of any size get shares of all sectors") {
    const TinyFolder folder;
    const ViewpointReader reader(folder.path(), torch::kCPU);
    for (const auto& [width, height] : {std::pair{16, 16}, {64, 64}, {90, 50}, {3, 7}, {1, 1}}) {
        const auto shares = reader.shares(stripes(width, height, 0));
        DOCTEST_REQUIRE(shares.size() == 8);
        DOCTEST_CHECK(std::abs(std::accumulate(shares.begin(), shares.end(), 0.0f) - 1) < SumTolerance);
        DOCTEST_CHECK(*std::min_element(shares.begin(), shares.end()) >= 0);
    }
    DOCTEST_CHECK(reader.shares(stripes(24, 24, 0)) != reader.shares(stripes(24, 24, 1)));
    // The middle of a wide one.
    DOCTEST_CHECK(reader.shares(stripes(24, 24, -3)) == reader.shares(stripes(30, 24, 0)));
}

DOCTEST_TEST_CASE("a classifier that is not whole is refused") {
    for (const char* file : {"config.json", "model.safetensors"}) {
        const TinyFolder folder;
        std::filesystem::remove(folder.path() / file);
        DOCTEST_CHECK(refused(folder, gse::ErrorCode::NotFound));
    }
    const std::vector<std::pair<std::function<void(Json&)>, gse::ErrorCode>> changes{
        {[](Json& json) {
             json["widths"] = {8, 18};
         },
         gse::ErrorCode::Model},  // no whole groups
        {[](Json& json) { json["widths"] = Json::array(); }, gse::ErrorCode::Model},
        {[](Json& json) { json["widths"] = "wide"; }, gse::ErrorCode::Malformed},
        {[](Json& json) { json["image_size"] = 18; }, gse::ErrorCode::Model},  // cannot be halved twice
        {[](Json& json) { json["image_size"] = 1 << 30; }, gse::ErrorCode::Model},
        {[](Json& json) { json["sectors"] = 0; }, gse::ErrorCode::Model},
        {[](Json& json) { json["groups"] = 0; }, gse::ErrorCode::Model},
        {[](Json& json) { json["hidden"] = -1; }, gse::ErrorCode::Model},
        {[](Json& json) { json["hidden"] = 24; }, gse::ErrorCode::Model}};  // not what the weights are
    for (std::size_t i = 0; i < changes.size(); ++i) {
        TinyFolder folder;
        changes[i].first(folder.json);
        gse::write_file(folder.path() / "config.json", folder.json.dump());
        DOCTEST_CHECK_MESSAGE(refused(folder, changes[i].second), i);
    }
}
