// A second look at what was found: the encoder as a witness, and labels that the pictures' edges cut.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <cmath>
#include <memory>

#include "engine/edit/search/picture_words.h"
#include "engine/edit/search/second_look.h"
#include "engine/language/words.h"
#include "tests/unit/edit/locate_scenes.h"

namespace second_look_test {

namespace {

using namespace locate_scenes;

const std::vector<std::string> Vocabulary{"a",       "the",   "with", "on",     "bear", "duck",
                                          "chair",   "tiled", "red",  "wooden", "hat",  "sunglasses",
                                          "glasses", "grass", "snow", "tiles"};
const std::vector<std::string> Said{"bear", "duck",    "chair", "red",  "wooden",
                                    "hat",  "glasses", "grass", "snow", "tiles"};
constexpr double Least = 0.2;
const std::string Word = "chair";

/// A picture says how much of each of Said it shows; sentences name them. Sunglasses are glasses.
class WordScore : public edit::ImageTextEncoder {
public:
    std::vector<float> image(const Image& picture) override { return picture.data; }
    std::vector<float> text(const std::string& sentence) override {
        std::vector<float> vector;
        for (const auto& word : Said)
            vector.push_back(language::has_phrase(sentence, word) ||
                                     (word == "glasses" && language::has_phrase(sentence, "sunglasses"))
                                 ? 1.0f
                                 : 0.0f);
        return vector;
    }
};

/// Reads a front off views that go once around, each picture one step on; `clearness` 0 = sees no sides.
class TurningScore : public WordScore {
public:
    explicit TurningScore(double clearness) : clearness_(clearness) {}
    std::vector<float> viewpoint(const Image&) override {
        constexpr std::size_t Sectors = 12;
        std::vector<float> shares(Sectors, static_cast<float>((1 - clearness_) / Sectors));
        shares[next_++ % Sectors] += static_cast<float>(clearness_);
        return shares;
    }

private:
    double clearness_;
    std::size_t next_ = 0;
};

Image showing(const std::vector<std::pair<std::string, float>>& shown) {
    Image picture(static_cast<int>(Said.size()), 1, 1);
    for (const auto& [word, much] : shown)
        picture.data[static_cast<std::size_t>(std::find(Said.begin(), Said.end(), word) - Said.begin())] =
            much;
    return picture;
}

edit::WordLead lead(const std::string& word, const std::vector<std::pair<std::string, float>>& shown) {
    edit::VocabularyRanker recognition(std::make_unique<WordScore>(), Vocabulary);
    return edit::lead_of(recognition, word, {showing(shown), showing(shown)}).value();
}

edit::SearchVerdict sure(double value) { return {{value, {}}}; }

edit::SecondLook said(double lead) {
    edit::SecondLook look;
    look.lead = lead;
    look.better = lead < 0 ? "bear" : "";
    return look;
}

edit::SecondLook cut_by(double share) {
    edit::SecondLook look;
    look.cut = share, look.cut_views = 9, look.views = 12;
    return look;
}

/// The red ball as the views of an orbit see it, labelled as far as they show it.
struct Seen {
    Fixture fixture;
    std::vector<edit::ViewEvidence> evidence;
    Label label;
    std::string word = "ball";

    explicit Seen(const OrbitParameters& orbit) {
        fixture.views = orbit_views(orbit, 12, Side, Side);
        std::vector<std::uint8_t> in_view(fixture.scene.set.size(), 0);
        for (const auto& view : fixture.views) {
            edit::ViewEvidence one;
            one.render = Image(1, 1, 3, static_cast<float>(evidence.size()));
            one.mask =
                test::true_mask(fixture.scene.set, fixture.scene.first, view.camera, *fixture.rasterizer);
            evidence.push_back(std::move(one));
            for (std::size_t row = 0; row < in_view.size(); ++row) {
                const float* at = &fixture.scene.set.position()[row * 3];
                const Vec3 p = view.camera.to_camera({at[0], at[1], at[2]});
                const double y = view.camera.fy * p.y / p.z + view.camera.cy;
                if (fixture.scene.first[row] != 0 && p.z > 0 && y >= 0 && y < Side) in_view[row] = 1;
            }
        }
        label = make_label(word, std::vector<float>(in_view.begin(), in_view.end()), 0.5f);
    }
    edit::Finding finding(const OrbitParameters& orbit) const {
        return {fixture.scene.set, word, label, fixture.views, evidence, orbit, {0, 0, -1}, {}};
    }
};

}  // namespace

DOCTEST_TEST_CASE("the verdict is monotone in the agreement of the second witness, and never surer") {
    for (const double value : {0.21, 0.4, 0.9}) {
        double before = -1;
        bool was_sure = false;
        for (double lead = -0.2; lead <= 0.2; lead += 0.005) {
            const auto verdict = edit::reconsider(sure(value), Word, said(lead), Least);
            DOCTEST_CHECK(verdict.confidence.value >= before);
            DOCTEST_CHECK(verdict.confidence.value <= value);
            DOCTEST_CHECK(verdict.sure() == (verdict.confidence.value >= Least));
            DOCTEST_CHECK((verdict.sure() || !was_sure));
            before = verdict.confidence.value, was_sure = verdict.sure();
        }
        DOCTEST_CHECK(was_sure);
        DOCTEST_CHECK(before == value);
        const auto refused = edit::reconsider(sure(value), Word, said(-0.2), Least);
        DOCTEST_CHECK(refused.problem == edit::SearchProblem::Unsure);
        DOCTEST_CHECK(refused.message.find("bear") != std::string::npos);
        DOCTEST_CHECK(refused.remedy.find("bear") != std::string::npos);
        DOCTEST_CHECK(edit::reconsider(sure(value), Word, said(-0.2), 0).sure());  // whoever knows better
        DOCTEST_CHECK(edit::reconsider(sure(value), Word, {}, Least).confidence.value ==
                      value);  // nobody can tell
    }
}

DOCTEST_TEST_CASE("a label that the pictures cut off is not sure, and keeps its first reason otherwise") {
    DOCTEST_CHECK(edit::reconsider(sure(0.9), Word, cut_by(0), Least).sure());
    DOCTEST_CHECK(edit::reconsider(sure(0.9), Word, cut_by(edit::MostCut), Least).sure());
    const auto cut = edit::reconsider(sure(0.9), Word, cut_by(0.4), Least);
    DOCTEST_CHECK(cut.problem == edit::SearchProblem::Unsure);
    DOCTEST_CHECK(cut.message.find("9 of 12 views") != std::string::npos);
    DOCTEST_CHECK(!cut.remedy.empty());
    DOCTEST_CHECK(cut.confidence.part("border_cut") == doctest::Approx(0.4));
    auto unsure = sure(0.1);
    unsure.problem = edit::SearchProblem::Unsure;
    unsure.message = "as it was";
    DOCTEST_CHECK(edit::reconsider(unsure, Word, cut_by(0.4), Least).message == "as it was");
}

DOCTEST_TEST_CASE("a vocabulary's words are told apart by what they say of a thing") {
    const auto kinds = edit::kinds_of(Vocabulary);
    DOCTEST_CHECK(kinds.things == std::vector<std::string>{"bear", "duck", "chair"});
    DOCTEST_CHECK(kinds.looks == std::vector<std::string>{"tiled", "red", "wooden"});
    DOCTEST_CHECK(kinds.worn == std::vector<std::string>{"hat", "sunglasses", "glasses"});
    DOCTEST_CHECK(kinds.grounds == std::vector<std::string>{"grass", "snow", "tiles"});
}

DOCTEST_TEST_CASE("a word leads where the pictures show it, whatever else they show") {
    for (const std::string look : {"red", "wooden"})
        for (const std::string ground : {"grass", "snow"}) {
            const std::vector<std::pair<std::string, float>> bear{
                {"bear", 1.0f}, {look, 1.0f}, {ground, 1.0f}, {"duck", 0.3f}};
            DOCTEST_CHECK(lead("bear", bear).lead > 0);
            DOCTEST_CHECK(lead("bear", bear).best == "bear");
            DOCTEST_CHECK(lead("a red bear", bear).lead > 0);
            DOCTEST_CHECK(lead("chair", bear).lead < lead("duck", bear).lead);
            DOCTEST_CHECK(lead("duck", bear).lead < 0);
            DOCTEST_CHECK(lead("duck", bear).best == "bear");
        }
    edit::VocabularyRanker recognition(std::make_unique<WordScore>(), Vocabulary);
    DOCTEST_CHECK(!edit::lead_of(recognition, "grass", {showing({{"bear", 1.0f}})}));   // no thing
    DOCTEST_CHECK(!edit::lead_of(recognition, "guitar", {showing({{"bear", 1.0f}})}));  // nobody told it
}

DOCTEST_TEST_CASE("something worn is there where the sentence without it fits less") {
    const std::vector<std::pair<std::string, float>> bare{{"bear", 1.0f}, {"red", 1.0f}, {"snow", 1.0f}};
    auto worn = bare;
    worn.emplace_back("glasses", 1.0f);
    DOCTEST_CHECK(lead("sunglasses", worn).lead > 0);  // "glasses" is no rival of it
    DOCTEST_CHECK(lead("hat", worn).lead < 0);
    DOCTEST_CHECK(lead("sunglasses", bare).lead < 0);
    DOCTEST_CHECK(lead("hat", bare).lead < 0);
    DOCTEST_CHECK(lead("hat", bare).best.empty());
}

DOCTEST_TEST_CASE("a finding that the pictures' edges cut is seen along its border, a whole one is not") {
    OrbitParameters whole, near;
    whole.radius = 3;
    near.radius = 0.9, near.centre = {-0.55, 0.3, 0};
    const Seen all(whole), part(near);
    DOCTEST_CHECK(edit::look_along_border(all.finding(whole), nullptr).cut == 0);
    const auto look = edit::look_along_border(part.finding(near), nullptr);
    DOCTEST_CHECK(look.cut_views > look.views / 2);
    DOCTEST_CHECK(look.cut > edit::MostCut);
    Seen ground(near);
    ground.word = "grass";  // goes on beyond any picture
    DOCTEST_CHECK(edit::look_along_border(ground.finding(near), nullptr).cut == 0);
}

DOCTEST_TEST_CASE("an encoder that cannot read the front of what it sees is no witness") {
    OrbitParameters whole;
    whole.radius = 3;
    const Seen all(whole);
    const auto knows = [&](double clearness) {
        edit::VocabularyRanker recognition(std::make_unique<TurningScore>(clearness), Vocabulary);
        return edit::encoder_knows(all.finding(whole), recognition);
    };
    DOCTEST_CHECK(knows(1));
    DOCTEST_CHECK(!knows(0.1));
    DOCTEST_CHECK(!knows(0));
    edit::VocabularyRanker blind(std::make_unique<WordScore>(), Vocabulary);
    DOCTEST_CHECK(edit::encoder_knows(all.finding(whole), blind));  // it never read one
}

DOCTEST_TEST_CASE("without an encoder a second look tells the border alone") {
    OrbitParameters whole;
    whole.radius = 3;
    const Seen all(whole);
    DOCTEST_CHECK(!edit::second_look(all.finding(whole), {*all.fixture.rasterizer}).lead);
}

}  // namespace second_look_test
