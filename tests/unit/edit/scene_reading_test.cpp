// Which word of a sentence is new, and from where a scene is known best, by encoders whose answers are known.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <cmath>
#include <memory>

#include "engine/edit/search/scene_reading.h"
#include "engine/language/words.h"
#include "tests/unit/edit/requests.h"

namespace scene_reading_test {

namespace {

using namespace gse;

const std::vector<std::string> Said{"golden", "bear", "hat", "snow"};

/// A picture says yes or no to each of Said: its pixels are its vector. Sentences say yes to what they name.
class WordScore : public edit::ImageTextEncoder {
public:
    explicit WordScore(int& asked) : asked_(asked) {}
    std::vector<float> image(const Image& picture) override {
        ++asked_;
        return picture.data;
    }
    std::vector<float> text(const std::string& sentence) override {
        std::vector<float> vector;
        for (const auto& word : Said) vector.push_back(language::has_phrase(sentence, word) ? 1.0f : 0.0f);
        return vector;
    }

private:
    int& asked_;
};

Image showing(float golden, float bear, float hat, float snow) {
    Image picture(4, 1, 1);
    picture.data = {golden, bear, hat, snow};
    return picture;
}

edit::CheckedRequest request_for(const std::string& prompt) { return test::asked("bear", prompt, "hat"); }

edit::SceneReading read(const std::vector<std::vector<Image>>& pictures,
                        const std::vector<std::string>& targets = {"hat", "golden", "snow"}) {
    int asked = 0;
    edit::VocabularyRanker recognition(std::make_unique<WordScore>(asked), {});
    auto reading = edit::read_scene(recognition, request_for("a golden bear wearing a hat on the snow"),
                                    targets, pictures);
    std::size_t all = 0;
    for (const auto& group : pictures) all += group.size();
    DOCTEST_CHECK(asked == static_cast<int>(all));  // each picture once, whatever it is compared with
    return reading;
}

}  // namespace

DOCTEST_TEST_CASE("the word that the pictures do not show is new") {
    DOCTEST_CHECK(read({{showing(0, 1, 1, 1)}}).target == "golden");
    DOCTEST_CHECK(read({{showing(1, 1, 0, 1)}}).target == "hat");
    DOCTEST_CHECK(read({{showing(1, 1, 1, 0)}}).target == "snow");
    // Of several pictures most decide.
    DOCTEST_CHECK(read({{showing(0, 1, 1, 1), showing(0.01f, 1, 1, 1), showing(1, 0.9f, 0, 1)}}).target ==
                  "golden");
    // Nothing is new.
    DOCTEST_CHECK(read({{showing(1, 1, 1, 1)}}).target == "hat");
    DOCTEST_CHECK(read({{showing(0, 1, 1, 1)}}, {"snow"}).target == "snow");
}

DOCTEST_TEST_CASE("a word that the encoder is not told is new where the pictures show all else") {
    const auto read_pink = [](const Image& picture) {
        int asked = 0;
        edit::VocabularyRanker recognition(std::make_unique<WordScore>(asked), {});
        return edit::read_scene(recognition, request_for("a pink bear wearing a hat"), {"hat", "pink"},
                                {{picture}}, {"a", "bear", "wearing", "hat"})
            .target;
    };
    DOCTEST_CHECK(read_pink(showing(0, 1, 1, 0)) == "pink");
    DOCTEST_CHECK(read_pink(showing(0, 1, 0, 0)) == "hat");
}

DOCTEST_TEST_CASE("distances whose pictures fit nearly as well as the best are kept, in their order") {
    const auto reading = read({{showing(0.9f, 1, 0.5f, 0.2f)},
                               {showing(0, 1, 0.9f, 1)},
                               {showing(0, 1, 1, 1)},
                               {showing(0.3f, 0, 1, 1)}});
    DOCTEST_CHECK(reading.target == "golden");
    DOCTEST_CHECK(reading.fit == doctest::Approx(1));
    DOCTEST_CHECK(reading.distances == std::vector<std::size_t>{1, 2});
}

}  // namespace scene_reading_test
