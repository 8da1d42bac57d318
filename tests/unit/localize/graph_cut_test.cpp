// The cut finds the least energy, closes holes of one colour and stops at colour edges.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <tuple>
#include <vector>

#include "engine/base/random.h"
#include "engine/localize/graph_cut.h"
#include "engine/localize/propagate_labels.h"

namespace graph_cut_test {

#ifdef GSE_HAVE_OPENCV

namespace {

using namespace gse;

constexpr double EnergyTolerance = 1e-9;  // sums of a few dozen doubles

struct Rows {
    GaussianData data;
    LabelField field;
    explicit Rows(std::size_t count) {
        data.resize(count);
        field.probability.assign(count, 0);
        field.coverage.assign(count, 5);
    }
    void colour(std::size_t row, float red, float green, float blue) {
        data.sh[row * 3] = red;
        data.sh[row * 3 + 1] = green;
        data.sh[row * 3 + 2] = blue;
    }
    std::vector<std::uint8_t> bits() const { return localize::bits(field, 0.5, 0.5); }
    std::vector<std::uint8_t> cut(const localize::CutParameters& parameters = {}) const {
        return localize::cut_label(spans(data), parameters, field);
    }
    /// How many rows the cut decides otherwise than their own probability does.
    std::ptrdiff_t changed(const localize::CutParameters& parameters = {}) const {
        const auto own = bits(), common = cut(parameters);
        return std::inner_product(own.begin(), own.end(), common.begin(), std::ptrdiff_t{0}, std::plus{},
                                  std::not_equal_to{});
    }
};

/// Two crossed bits of the same thing: a red sheet on the left, a blue one on the right, both of 20 x 20
/// rows.
struct Sheets : Rows {
    static constexpr std::size_t Side = 20;
    Sheets() : Rows(2 * Side * Side) {
        Random random(5);
        for (std::size_t row = 0; row < 2 * Side * Side; ++row) {
            const std::size_t x = row / Side, y = row % Side;
            data.position[row * 3] = static_cast<float>(x);
            data.position[row * 3 + 1] = static_cast<float>(y);
            const auto tint = static_cast<float>(random.uniform(-0.1, 0.1));
            if (red(row)) colour(row, 1 + tint, 0, 0);
            else colour(row, 0, 0, 1 + tint);
            field.probability[row] = red(row) ? 0.8f : 0.2f;
        }
    }
    static bool red(std::size_t row) { return row / Side < Side; }
};

}  // namespace

DOCTEST_TEST_CASE("the cut has the least energy of all labels") {
    constexpr std::size_t count = 11;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        Random random(seed);
        Rows rows(count);
        for (auto& value : rows.data.position) value = static_cast<float>(random.uniform(0, 1));
        for (auto& value : rows.data.sh) value = static_cast<float>(random.uniform(0, 1));
        for (auto& value : rows.field.probability) value = static_cast<float>(random.uniform(0, 1));
        for (auto& value : rows.field.coverage) value = random.uniform(0.6, 5);
        rows.field.probability[0] = 0.9f;
        localize::CutParameters parameters;
        parameters.neighbours = 3;
        const double found =
            localize::label_energy(spans(rows.data), parameters, rows.field, rows.cut(parameters));
        std::vector<std::uint8_t> label(count);
        double least = std::numeric_limits<double>::max();
        for (unsigned bits = 0; bits < 1u << count; ++bits) {
            for (std::size_t row = 0; row < count; ++row) label[row] = bits >> row & 1u;
            least = std::min(least, localize::label_energy(spans(rows.data), parameters, rows.field, label));
        }
        DOCTEST_CHECK(found == doctest::Approx(least).epsilon(EnergyTolerance));
    }
}

DOCTEST_TEST_CASE("the energy is what its definition says, with every distance measured") {
    constexpr std::size_t count = 60, neighbours = 4;
    Random random(8);
    Rows rows(count);
    for (auto& value : rows.data.position) value = static_cast<float>(random.uniform(0, 1));
    for (auto& value : rows.data.sh) value = static_cast<float>(random.uniform(0, 1));
    rows.field.probability.assign(count, 0.9f);  // all take part, and have one opinion
    localize::CutParameters parameters;
    parameters.neighbours = neighbours;
    const auto squared = [&](const std::vector<float>& values, std::size_t a, std::size_t b) {
        double sum = 0;
        for (std::size_t c = 0; c < 3; ++c) sum += std::pow(double{values[a * 3 + c]} - values[b * 3 + c], 2);
        return sum;
    };
    std::vector<std::pair<std::size_t, std::size_t>> pairs;  // from either end
    double mean = 0;
    for (std::size_t a = 0; a < count; ++a) {
        std::vector<std::pair<double, std::size_t>> others;
        for (std::size_t b = 0; b < count; ++b)
            if (b != a) others.emplace_back(squared(rows.data.position, a, b), b);
        std::sort(others.begin(), others.end());
        for (std::size_t k = 0; k < neighbours; ++k) {
            pairs.emplace_back(a, others[k].second);
            mean += squared(rows.data.sh, a, others[k].second) / (count * neighbours);
        }
    }
    std::vector<std::uint8_t> none(count, 0), some(count, 0);
    double cut = 0;
    for (std::size_t row = 0; row < count; ++row) some[row] = rows.data.position[row * 3] > 0.5f ? 1 : 0;
    for (const auto& [a, b] : pairs)
        if (some[a] != some[b])
            cut += 0.5 * parameters.smoothness * std::exp(-squared(rows.data.sh, a, b) / mean);
    const auto energy = [&](const std::vector<std::uint8_t>& label) {
        return localize::label_energy(spans(rows.data), parameters, rows.field, label);
    };
    const std::vector<std::uint8_t> all(count, 1);
    const double labelled = static_cast<double>(std::count(some.begin(), some.end(), 1)) / count;
    // One opinion: the same for every row.
    const double opinions = labelled * energy(all) + (1 - labelled) * energy(none);
    DOCTEST_CHECK(cut > 1);
    DOCTEST_CHECK(energy(some) == doctest::Approx(opinions + cut).epsilon(EnergyTolerance));
}

DOCTEST_TEST_CASE("a hole is closed and a crumb goes, but the other colour stays what it is") {
    Sheets sheets;
    for (std::size_t x = 0; x < 6; ++x)
        for (std::size_t y = 0; y < 6; ++y)
            sheets.field.probability[x * Sheets::Side + y] = 0.35f;  // a corner is missed
    sheets.field.probability[(Sheets::Side + 9) * Sheets::Side + 9] = 0.7f;
    DOCTEST_CHECK(sheets.changed() == 37);
    const auto label = sheets.cut();
    for (std::size_t row = 0; row < label.size(); ++row)
        DOCTEST_CHECK(label[row] == (Sheets::red(row) ? 1 : 0));
}

DOCTEST_TEST_CASE("a part of another colour that the views are sure of is kept") {
    Sheets sheets;
    for (std::size_t x = 8; x < 11; ++x)
        for (std::size_t y = 8; y < 11; ++y) sheets.colour(x * Sheets::Side + y, 0, 1, 0);
    const auto label = sheets.cut();
    for (std::size_t row = 0; row < label.size(); ++row)
        DOCTEST_CHECK(label[row] == (Sheets::red(row) ? 1 : 0));
}

DOCTEST_TEST_CASE("any number of threads gives the same bits") {
    constexpr std::size_t count = 20000;  // several of the chunks that threads take
    Random random(11);
    Rows rows(count);
    for (auto& value : rows.data.position) value = static_cast<float>(random.uniform(0, 1));
    for (auto& value : rows.data.sh) value = static_cast<float>(random.uniform(0, 1));
    for (std::size_t row = 0; row < count; ++row) {
        rows.field.probability[row] = rows.data.position[row * 3] > 0.5f ? 0.7f : 0.3f;
        rows.field.coverage[row] = random.uniform(0, 1) < 0.4 ? 0 : random.uniform(0.6, 5);
        if (random.uniform(0, 1) < 0.2) rows.field.probability[row] = 1 - rows.field.probability[row];
    }
    ThreadPool pool(3);
    const auto one = localize::propagate_labels_knn(spans(rows.data), {}, rows.field),
               three = localize::propagate_labels_knn(spans(rows.data), {}, rows.field, &pool);
    DOCTEST_CHECK(three.probability == one.probability);
    DOCTEST_CHECK(three.inferred == one.inferred);
    rows.field = one;
    DOCTEST_CHECK(localize::cut_label(spans(rows.data), {}, one, &pool) == rows.cut());
    DOCTEST_CHECK(rows.changed() > static_cast<std::ptrdiff_t>(count / 20));
}

DOCTEST_TEST_CASE("a part is cut as it is in the cut of everything") {
    constexpr std::size_t count = 6000;
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
        DOCTEST_CAPTURE(seed);
        Random random(seed);
        Rows rows(count);
        for (auto& value : rows.data.position) value = static_cast<float>(random.uniform(0, 1));
        for (auto& value : rows.data.sh) value = static_cast<float>(random.uniform(0, 0.3));
        const double size = random.uniform(0.05, 0.4);  // of a ball, most of whose rows prefer the label
        for (std::size_t row = 0; row < count; ++row) {
            const float* p = &rows.data.position[row * 3];
            const bool thing = std::hypot(p[0] - 0.5, p[1] - 0.5, p[2] - 0.5) < size;
            rows.field.probability[row] =
                static_cast<float>(random.uniform(0, 1) < 0.9 ? (thing ? 0.8 : 0.2) : random.uniform(0, 1));
            rows.field.coverage[row] = random.uniform(0.6, 5);
        }
        for (const double smoothness : {0.5, 1.5, 6.0}) {
            DOCTEST_CAPTURE(smoothness);
            localize::CutParameters parameters;
            parameters.smoothness = smoothness;
            parameters.margin_share = 1;
            parameters.reach = 0;
            const auto label = rows.cut(parameters);
            const double least = localize::label_energy(spans(rows.data), parameters, rows.field, label);
            for (const int reach : {1, 3}) {
                DOCTEST_CAPTURE(reach);
                parameters.reach = reach;
                const auto found = rows.cut(parameters);
                DOCTEST_CHECK(localize::label_energy(spans(rows.data), parameters, rows.field, found) ==
                              doctest::Approx(least).epsilon(EnergyTolerance));
                DOCTEST_CHECK(found == label);
            }
        }
    }
}

DOCTEST_TEST_CASE(
    "what only the label holds takes it, where that is asked for: no bridge, no ground, nothing large") {
    // A labelled block of 6^3 rows, ground far beyond it on all sides below, of which the cut sees a piece,
    // and beside it a bumper of another colour.
    constexpr int Block = 6, Ground = 30;
    const auto scene = [](int bumper_layers, int bridge, double lift) {
        std::vector<std::array<double, 3>> places;
        Random random(8);
        const auto put = [&](double x, double y, double z) {
            places.push_back({x + random.uniform(-0.05, 0.05), y + random.uniform(-0.05, 0.05),
                              z + random.uniform(-0.05, 0.05)});
        };
        for (int i = 0; i < Block * Block * Block; ++i)
            put(i % Block, i / Block % Block, i / (Block * Block));
        const std::size_t block = places.size();
        for (int layer = 0; layer < bumper_layers; ++layer)
            for (int i = 0; i < 10; ++i) put(Block - 0.8 + 0.2 * layer, lift + 0.2 * (i % 2), 0.25 * (i / 2));
        const std::size_t bumper = places.size();
        for (int i = 0; i < bridge; ++i) put(Block - 0.6, lift - 0.2 * (i + 1), 0.5);
        for (int i = 0; i < Ground * Ground; ++i) put(i % Ground - 12, -0.8, i / Ground - 12);
        Rows rows(places.size());
        for (std::size_t row = 0; row < places.size(); ++row) {
            for (std::size_t axis = 0; axis < 3; ++axis)
                rows.data.position[row * 3 + axis] = static_cast<float>(places[row][axis]);
            rows.colour(row, row < block ? 1 : 0, row >= bumper ? 1 : 0, 0);
            rows.field.probability[row] = row < block ? 0.9f : 0.05f;
        }
        return std::tuple(rows, block, bumper);
    };
    const auto labelled = [](Rows& rows, double share, std::size_t begin, std::size_t end) {
        localize::CutParameters parameters;
        parameters.island_share = share;
        const auto bits = rows.cut(parameters);
        return std::count(bits.begin() + static_cast<std::ptrdiff_t>(begin),
                          bits.begin() + static_cast<std::ptrdiff_t>(end), 1);
    };
    constexpr double High = 3;  // of the bumper above the block's foot
    for (const double share :
         {0.0, 0.05, 0.2, 0.8}) {  // the bumper has 20 rows of 216, the piece of ground some 50
        DOCTEST_CAPTURE(share);
        auto [rows, block, bumper] = scene(2, 0, High);
        DOCTEST_CHECK_EQ(labelled(rows, share, block, bumper), share >= 0.2 ? 20 : 0);
        DOCTEST_CHECK_EQ(labelled(rows, share, 0, block), static_cast<std::ptrdiff_t>(block));
        DOCTEST_CHECK_EQ(labelled(rows, share, bumper, rows.field.probability.size()), 0);  // the ground
    }
    auto [held, block, bumper] = scene(2, 22, High);  // it stands on the ground by itself
    DOCTEST_CHECK_EQ(labelled(held, 0.2, block, held.field.probability.size()), 0);
    auto [low, low_block, low_bumper] = scene(2, 0, 0.3);  // the ground is near it, but it has nearer ones
    DOCTEST_CHECK_EQ(labelled(low, 0.2, low_block, low.field.probability.size()), 20);
    // Between two parts of the label, away from both, it is not its affair.
    auto [far, far_block, far_bumper] = scene(2, 0, High + 40);
    for (std::size_t row = 0; row < far_block / 2; ++row) far.data.position[row * 3 + 1] += 80;
    DOCTEST_CHECK_EQ(labelled(far, 0.2, far_block, far_bumper), 0);
}

DOCTEST_TEST_CASE("rows without a place, a colour or a view have no neighbours; no smoothness means no cut") {
    Sheets sheets;
    constexpr std::size_t lost = 5 * Sheets::Side + 5, colourless = lost + 1, unseen = lost + 2;
    sheets.data.position[lost * 3] = std::numeric_limits<float>::quiet_NaN();
    sheets.data.sh[colourless * 3] = std::numeric_limits<float>::infinity();
    sheets.field.coverage[unseen] = 0;
    for (const auto row : {lost, colourless, unseen}) sheets.field.probability[row] = 0.4f;
    DOCTEST_CHECK(sheets.changed() == 0);
    sheets.field.probability[0] = 0.3f;
    DOCTEST_CHECK(sheets.changed() == 1);
    localize::CutParameters off;
    off.smoothness = 0;
    DOCTEST_CHECK(sheets.changed(off) == 0);
}

DOCTEST_TEST_CASE(
    "a cut leaves the field alone, and a probability is moved only where the label says otherwise") {
    Sheets sheets;
    sheets.field.probability[0] = 0.3f;
    const auto before = sheets.field.probability;
    DOCTEST_CHECK(sheets.cut()[0] == 1);
    DOCTEST_CHECK(sheets.field.probability == before);
    DOCTEST_CHECK(localize::decided_probability(0.3f, false, 0.5) == 0.3f);
    DOCTEST_CHECK(localize::decided_probability(0.3f, true, 0.5) > 0.5f);
    DOCTEST_CHECK(localize::decided_probability(0.8f, false, 0.5) < 0.5f);
}

#endif

}  // namespace graph_cut_test
