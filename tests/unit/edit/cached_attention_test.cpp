// A question is asked once; any difference in it makes another question.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "engine/edit/search/cached_attention.h"

namespace cached_attention_test {

namespace {

using namespace gse;

/// Answers with a map that holds the number of the call.
class CountingSource : public edit::AttentionSource {
public:
    std::vector<Image> locate(const edit::AttentionQuery& query) override {
        return std::vector<Image>(query.words.size(), Image(2, 2, 1, static_cast<float>(++calls_)));
    }
    int image_size() const override { return 2; }

private:
    int calls_ = 0;
};

}  // namespace

DOCTEST_TEST_CASE("the same question is answered from memory, another one is not") {
    edit::CachedAttention attention(std::make_unique<CountingSource>());
    Image image(4, 4, 3, 0.5f);
    const edit::AttentionQuery query{image, "a bear", {"bear"}, "front view", false, 3, 7};
    DOCTEST_CHECK(attention.locate(query)[0].data[0] == 1);
    DOCTEST_CHECK(attention.locate(query)[0].data[0] == 1);
    edit::AttentionQuery seed = query;
    seed.seed = 8;
    DOCTEST_CHECK(attention.locate(seed)[0].data[0] == 2);
    edit::AttentionQuery words = query;
    words.words = {"bear", "hat"};
    DOCTEST_CHECK(attention.locate(words).size() == 2);
    Image other = image;
    other.data[17] = 0.5001f;
    const edit::AttentionQuery picture{other, "a bear", {"bear"}, "front view", false, 3, 7};
    DOCTEST_CHECK(attention.locate(picture)[0].data[0] == 4);
    DOCTEST_CHECK(attention.locate(query)[0].data[0] == 1);
    DOCTEST_CHECK(attention.asked() == 4);
}

}  // namespace cached_attention_test
