// Colours that a model has no word for.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/random.h"
#include "engine/edit/request/checked_request.h"
#include "engine/edit/request/vocabulary.h"
#include "engine/edit/target_views/strategies/colour_remap.h"
#include "engine/math/sh.h"

namespace dye_test {

namespace {

using namespace gse;

using Rgb = std::array<float, 3>;

const std::vector<std::string> Few{"a",   "bear",    "hat", "cat",   "grass", "on",
                                   "the", "wearing", "red", "white", "golden"};

edit::EditRequest request_of(const std::string& prompt, const std::string& target) {
    edit::EditRequest request;
    request.source = "bear";
    request.prompt = prompt;
    request.target = target;
    return request;
}

std::optional<edit::ColourRemap> dye(const std::string& prompt, const std::string& target,
                                     edit::EditMode mode = edit::EditMode::Modify,
                                     const std::vector<std::string>& known = Few) {
    return edit::dye_of(edit::check(request_of(prompt, target)).sentence(), mode, known);
}

using Words = std::vector<std::string>;

constexpr Rgb Red{0.85f, 0.07f, 0.07f};

Rgb dyed(const edit::ColourRemap& with, const Rgb& colour, float much = 1) {
    // Most of the thing is of a clear red.
    Image image(5, 1, 3), share(5, 1, 1, much);
    for (std::size_t p = 0; p < 5; ++p)
        std::copy_n(p == 0 ? colour.data() : Red.data(), 3, &image.data[3 * p]);
    std::fill(share.data.begin() + 1, share.data.end(), 1.0f);
    edit::apply_dye(with, std::span(&share, 1), std::span(&image, 1));
    return {image.data[0], image.data[1], image.data[2]};
}

Rgb mixed(const Rgb& a, const Rgb& b, float t) {
    return {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])};
}

double difference(const Rgb& a, const Rgb& b) {
    return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
}

constexpr double Rounding = 1e-5;  // some float operations on numbers up to 1

/// Draws all of a view red on white, and tells that its left half is new.
class RedViews final : public edit::MultiViewEditor {
public:
    edit::EditedViews edit(const std::vector<edit::EditView>& views, const edit::EditViewsRequest& input,
                           const JobControl&) override {
        told = input.sentence;
        edit::EditedViews targets;
        for (const auto& view : views) {
            Image picture(view.rendered.width, view.rendered.height, 3),
                outline(view.rendered.width, view.rendered.height, 1);
            for (std::size_t p = 0; p < outline.data.size(); ++p) {
                std::copy(Red.begin(), Red.end(), &picture.data[3 * p]);
                outline.data[p] = static_cast<int>(p) % outline.width < outline.width / 2 ? 1 : 0;
            }
            targets.images.push_back(picture);
            targets.outlines.push_back(outline);
        }
        return targets;
    }
    std::string told;
};

}  // namespace

DOCTEST_TEST_CASE("a colour that describes what is new is dyed, one that describes what is there is not") {
    DOCTEST_REQUIRE(dye("a pink bear", "pink"));
    DOCTEST_CHECK(dye("a pink bear", "pink")->words == Words{"pink"});
    DOCTEST_CHECK(dye("a dark red bear", "red")->words == Words{"dark", "red"});
    DOCTEST_CHECK(dye("a light pink bear", "pink")->words == Words{"light", "pink"});
    DOCTEST_CHECK(dye("a bear made of silver", "silver")->base == "golden");
    DOCTEST_CHECK(dye("a bear wearing a pink hat", "hat", edit::EditMode::Add)->words == Words{"pink"});
    DOCTEST_CHECK(dye("a pink cat on the grass", "cat", edit::EditMode::Replace)->words == Words{"pink"});
    DOCTEST_CHECK_FALSE(dye("a pink bear wearing a hat", "hat", edit::EditMode::Add));
    DOCTEST_CHECK_FALSE(dye("a red bear", "red"));  // the model's own word
    DOCTEST_CHECK_FALSE(
        dye("a bear wearing a peach", "peach", edit::EditMode::Add));  // a thing, not a colour
    DOCTEST_CHECK_FALSE(
        dye("a pink bear", "pink", edit::EditMode::Modify, {}));  // such a model takes any word
    DOCTEST_CHECK_FALSE(dye("a pink bear", "pink", edit::EditMode::Modify,
                            {"bear", "blue"}));  // it has nothing to draw it in
    DOCTEST_CHECK_FALSE(dye("a silver bear", "silver", edit::EditMode::Modify, {"bear", "red"}));
    DOCTEST_CHECK(edit::told_with(*dye("a dark red bear", "red"), "a dark red bear on the dark grass") ==
                  "a red bear on the dark grass");
}

DOCTEST_TEST_CASE("what is drawn besides can be made and not found") {
    const auto made = edit::with_dyes({"rabbit"}, Few);
    std::string hint;
    const auto refused = [&](const std::string& source, const std::string& prompt,
                             const std::string& target) {
        auto request = request_of(prompt, target);
        request.source = source;
        try {
            edit::require_known_words(edit::check(request), Few, made, false);
        } catch (const Error& error) {
            DOCTEST_CHECK(error.hint().size() < 200);  // not the names of all colours
            hint = error.hint();
            return error.message();
        }
        return std::string();
    };
    DOCTEST_CHECK(refused("bear", "a pink bear", "pink").empty());
    DOCTEST_CHECK(refused("bear", "a rabbit", "rabbit").empty());
    DOCTEST_CHECK(refused("rabbit", "a red rabbit", "red") ==
                  "the model can draw \"rabbit\" but not find it");
    DOCTEST_CHECK(refused("bear", "a sign", "sign") ==
                  "the model does not know the word \"sign\" and cannot make it");
    // The words that it draws besides are named, colours in one phrase.
    DOCTEST_CHECK(hint.find("rabbit") != std::string::npos);
    DOCTEST_CHECK(hint.find("navy") == std::string::npos);
    DOCTEST_CHECK(hint.find("a colour or pattern by its name") != std::string::npos);
    DOCTEST_CHECK(edit::with_dyes({}, {}).empty());
    DOCTEST_CHECK(std::find(made.begin(), made.end(), "red") == made.end());  // it has that word itself
}

DOCTEST_TEST_CASE("red becomes the colour, in light and shade; white, grey, black and other colours stay") {
    Random random(5);
    for (const auto* word : {"pink", "brown", "navy", "ivory", "turquoise", "gray"}) {
        const auto with = dye("a " + std::string(word) + " bear", word);
        DOCTEST_REQUIRE(with);
        DOCTEST_CAPTURE(word);
        DOCTEST_CHECK(difference(dyed(*with, Red), with->colour) < Rounding);
        for (int i = 0; i < 100; ++i) {
            // Less light on it, a share of grey, and a highlight: the same of the colour.
            const auto light = static_cast<float>(random.uniform(0.1, 1)),
                       grey = static_cast<float>(random.uniform(0, 1)),
                       share = static_cast<float>(random.uniform(0, 1));
            const Rgb lit{Red[0] * light, Red[1] * light, Red[2] * light},
                wanted{with->colour[0] * light, with->colour[1] * light, with->colour[2] * light};
            DOCTEST_CHECK(difference(dyed(*with, mixed(lit, {grey, grey, grey}, share)),
                                     mixed(wanted, {grey, grey, grey}, share)) < 10 * Rounding);
            const Rgb neutral{grey, grey, grey};
            DOCTEST_CHECK(dyed(*with, neutral) == neutral);
        }
        for (const Rgb& other :
             {Rgb{1, 0.5f, 0.03f}, Rgb{0.1f, 0.8f, 0.1f}, Rgb{0.1f, 0.2f, 0.9f}, Rgb{0.9f, 0.9f, 0.1f}})
            DOCTEST_CHECK(dyed(*with, other) == other);
        DOCTEST_CHECK(dyed(*with, Red, 0) == Red);
    }
}

DOCTEST_TEST_CASE(
    "what a model calls red may be as brown as a thing makes it; what is much yellower than most of the "
    "thing stays") {
    const auto pink = dye("a pink bear", "pink");
    DOCTEST_REQUIRE(pink);
    const Rgb brown{0.6f, 0.34f, 0.1f};  // 29 degrees from red
    const Rgb yellow{0.9f, 0.89f, 0.1f};
    Image image(6, 1, 3), share(6, 1, 1, 1.0f);
    for (std::size_t p = 0; p < 6; ++p)
        std::copy_n(p == 0 ? yellow.data() : brown.data(), 3, &image.data[3 * p]);
    edit::apply_dye(*pink, std::span(&share, 1), std::span(&image, 1));
    DOCTEST_CHECK(std::equal(yellow.begin(), yellow.end(), image.data.begin()));
    DOCTEST_CHECK(image.data[5] > image.data[4]);  // pink: more blue than green
    DOCTEST_CHECK(image.data[3] > image.data[5]);
}

DOCTEST_TEST_CASE("gold becomes another metal: what is brighter stays brighter, what is blue stays") {
    const auto silver = dye("a silver bear", "silver");
    DOCTEST_REQUIRE(silver);
    float last = -1;
    for (float light = 0.3f; light <= 1; light += 0.1f) {
        const auto shown = dyed(*silver, {light, 0.68f * light, 0.1f * light});
        DOCTEST_CHECK(std::abs(shown[0] - shown[2]) < 0.1f);  // no colour of its own
        DOCTEST_CHECK(shown[1] > last);
        last = shown[1];
    }
    const Rgb blue{0.1f, 0.2f, 0.9f}, black{0, 0, 0};
    DOCTEST_CHECK(dyed(*silver, blue) == blue);
    DOCTEST_CHECK(dyed(*silver, black) == black);
}

DOCTEST_TEST_CASE(
    "views are told the base, and dyed where they may change and, drawn anew, where something new is") {
    RedViews red;
    const auto pink = dye("a pink cat", "cat", edit::EditMode::Replace);
    DOCTEST_REQUIRE(pink);
    edit::DyedViews views(red, *pink);
    edit::EditView view;
    view.rendered = view.original = Image(8, 8, 3);
    view.mask = Mask(8, 8);
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 8; ++x) view.mask.at(x, y) = 1;
    edit::EditViewsRequest input;
    input.sentence = "a pink cat on the grass";
    for (const bool anew : {true, false}) {
        input.anew = anew;
        const auto targets = views.edit({view}, input, {});
        DOCTEST_CHECK(red.told == "a red cat on the grass");
        for (int y = 0; y < 8; ++y)
            for (int x = 0; x < 8; ++x) {
                const Rgb shown{targets.images[0].at(x, y, 0), targets.images[0].at(x, y, 1),
                                targets.images[0].at(x, y, 2)};
                const bool changes = y < 4 && (!anew || x < 4);
                DOCTEST_CHECK(difference(shown, changes ? pink->colour : Red) < Rounding);
            }
        DOCTEST_REQUIRE(views.drawn().size() == 1);
        DOCTEST_CHECK(views.drawn()[0].undyed.at(0, 0, 0) == Red[0]);
        DOCTEST_CHECK_FALSE(targets.unfinished);
    }
    const auto striped = dye("a striped cat", "cat", edit::EditMode::Replace);
    DOCTEST_REQUIRE(striped);
    edit::DyedViews patterned(red, *striped);
    DOCTEST_CHECK(patterned.edit({view}, input, {}).unfinished);  // red still, as the scene may be
}

DOCTEST_TEST_CASE("a pattern takes the colour beside it, and lies over what is red of the rows") {
    DOCTEST_REQUIRE(dye("a striped bear", "striped"));
    DOCTEST_CHECK(dye("a striped bear", "striped")->words == Words{"striped"});
    const auto blue = dye("a blue striped bear", "striped");
    DOCTEST_REQUIRE(blue);
    DOCTEST_CHECK(blue->words == Words{"blue", "striped"});
    DOCTEST_CHECK(blue->base == "red");
    DOCTEST_CHECK(dye("a bear wearing a pink spotted hat", "hat", edit::EditMode::Add)->words ==
                  Words{"pink", "spotted"});
    DOCTEST_CHECK(dye("a marble bear", "marble")->words == Words{"marble"});
    DOCTEST_CHECK_FALSE(dye("a bear wearing a zebra", "zebra", edit::EditMode::Add));  // a thing

    Random random(4);
    GaussianData data;
    data.sh_degree = 1;
    constexpr std::size_t Rows = 400;
    std::vector<std::uint8_t> rows(Rows);
    for (std::size_t row = 0; row < Rows; ++row) {
        rows[row] = row % 4 != 0 ? 1 : 0;
        const bool white = row % 4 == 1;
        for (int axis = 0; axis < 3; ++axis)
            data.position.push_back(static_cast<float>(random.uniform(-1, 1)));
        for (const float value : {-3.0f, -3.0f, -3.0f}) data.log_scale.push_back(value);
        for (const float value : {1.0f, 0.0f, 0.0f, 0.0f}) data.rotation.push_back(value);
        data.opacity_logit.push_back(2);
        for (std::size_t c = 0; c < 3; ++c)
            data.sh.push_back(static_cast<float>(sh_from_colour(white ? 0.9 : 0.6 * Red[c])));
        for (int k = 0; k < 3; ++k) {  // more or less light from other sides
            const double light = random.uniform(-0.2, 0.2);
            for (std::size_t c = 0; c < 3; ++c)
                data.sh.push_back(static_cast<float>(light * (white ? 0.9 : 0.6 * Red[c]) / ShC0));
        }
    }
    data.position[3 * 6] = std::numeric_limits<float>::quiet_NaN();  // nowhere: no pattern is there
    const GaussianSet set(data);
    const edit::DyedThing thing{{{0, 1, 0}, 2, 2, 2}, {0, -1, 0}, {0, 0, -1}};
    const auto dyed_set = edit::dye_rows(*blue, thing, rows, set, 1);
    DOCTEST_REQUIRE(dyed_set.size() == Rows);
    std::size_t first = 0, second = 0;
    for (std::size_t row = 0; row < Rows; ++row) {
        const float *was = &set.sh()[row * 12], *is = &dyed_set.sh()[row * 12];
        const bool stays = row % 4 <= 1 || row == 6;
        DOCTEST_CHECK(std::equal(was, was + 12, is) == stays);
        if (stays) continue;
        Rgb shown;
        for (std::size_t c = 0; c < 3; ++c) shown[c] = static_cast<float>(colour_from_sh(is[c]) / 0.6);
        const Vec3 colour[] = {blue->pattern->first, blue->pattern->second};
        const auto off = [&](const Vec3& wanted) {
            return difference(shown, {static_cast<float>(wanted.x), static_cast<float>(wanted.y),
                                      static_cast<float>(wanted.z)});
        };
        const bool is_first = off(colour[0]) < off(colour[1]);
        (is_first ? first : second) += 1;
        DOCTEST_CHECK(off(colour[is_first ? 0 : 1]) < 0.01);
        // From other sides the same share of light.
        for (std::size_t k = 3; k < 12; ++k) {
            const double light = was[k / 3 * 3] / (0.6 * Red[0]);
            DOCTEST_CHECK(is[k] == doctest::Approx(light * 0.6 * shown[k % 3]).epsilon(0.02));
        }
    }
    DOCTEST_CHECK(first > Rows / 8);
    DOCTEST_CHECK(second > Rows / 8);
}

}  // namespace dye_test
