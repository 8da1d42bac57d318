// Drawing of twin groups, their augmentation, and which sentence holds for which picture.
#include "engine/laboratory/starter/starter_clip_batch.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "engine/laboratory/starter/split_caption.h"

namespace gse::training {
namespace {

constexpr double FullShare = 0.6;    // groups with full sentences; the others leave words out
constexpr int ClearStep = 24;        // of 255: a channel that differs by more is a visible difference
constexpr int LeastClearPixels = 8;  // fewer differing pixels: the pictures look alike
constexpr double BlurShare = 0.3;    // as pictures look that went through the VAE
constexpr double NoiseLimit = 0.04;
constexpr double LargestZoom = 1.3, SmallestZoom = 0.85, LargestShift = 0.12;  // of half the side

/// One random view of a group: crop or shrink, shift, mirror; brightness and contrast; blur.
torch::Tensor augment(torch::Tensor group, Random& random) {
    const double zoom = 1.0 / random.uniform(SmallestZoom, LargestZoom);
    const double mirror = random.uniform() < 0.5 ? -1 : 1;
    const auto shift = [&] { return random.uniform(-LargestShift, LargestShift); };
    const auto affine =
        torch::tensor({zoom * mirror, 0.0, shift(), 0.0, zoom, shift()}, torch::kFloat32).view({1, 2, 3});
    const auto grid =
        torch::affine_grid_generator(affine.expand({group.size(0), 2, 3}), group.sizes(), false);
    group = torch::grid_sampler(group, grid, 0, 1, false);  // bilinear, border
    if (random.uniform() < BlurShare) {
        const auto small = torch::avg_pool2d(group, 2);
        const auto soft = torch::upsample_bilinear2d(small, {group.size(2), group.size(3)}, false);
        group = torch::lerp(group, soft, random.uniform(0.3, 1.0));
    }
    const double contrast = random.uniform(0.88, 1.12), brightness = random.uniform(-0.06, 0.06);
    group = group * contrast + (0.5 * (1 - contrast) + brightness);
    auto generator = at::make_generator<at::CPUGeneratorImpl>(random.next());
    const double noise = random.uniform(0, NoiseLimit);
    return (group + noise * torch::randn(group.sizes(), generator)).clamp(0.0, 1.0);
}

/// Marks equal changes and unrelated ones; `facts` of all rows.
void compare_changes(const std::vector<std::int64_t>& from, const std::vector<std::int64_t>& to,
                     const std::vector<std::uint64_t>& facts, PairBatch& batch) {
    struct Change {
        std::uint64_t gained, lost;
    };
    std::vector<Change> changes;
    for (std::size_t k = 0; k < from.size(); ++k) {
        const auto before = facts[static_cast<std::size_t>(from[k])],
                   after = facts[static_cast<std::size_t>(to[k])];
        changes.push_back({after & ~before, before & ~after});
    }
    const auto count = static_cast<std::int64_t>(changes.size());
    batch.same_change = torch::zeros({count, count}, torch::kBool);
    batch.unrelated = torch::zeros({count, count}, torch::kBool);
    auto same = batch.same_change.accessor<bool, 2>();
    auto unrelated = batch.unrelated.accessor<bool, 2>();
    for (std::int64_t k = 0; k < count; ++k)
        for (std::int64_t l = 0; l < count; ++l) {
            const auto &a = changes[static_cast<std::size_t>(k)], &b = changes[static_cast<std::size_t>(l)];
            same[k][l] = k != l && a.gained == b.gained && a.lost == b.lost;
            unrelated[k][l] = ((a.gained | a.lost) & (b.gained | b.lost)) == 0;
        }
}

}  // namespace

PairBatchMaker::PairBatchMaker(const ClipTraining& training)
    : training_(training), table_(training.vocabulary),
      members_(static_cast<std::uint64_t>(training.pairs.group_size())) {}

PairBatch PairBatchMaker::make(Random& random) const {
    const auto rows = draw_rows(random);
    PairBatch batch;
    batch.pictures = pictures_of(rows, random);
    std::vector<std::string> texts, false_texts;
    std::vector<std::int64_t> false_of;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        texts.push_back(rows[i].claim.text);
        for (const auto& text : rows[i].false_texts) {
            false_texts.push_back(text);
            false_of.push_back(static_cast<std::int64_t>(i));
        }
    }
    batch.ids = ids_of(texts);
    batch.false_ids = ids_of(false_texts);
    batch.false_of = torch::tensor(false_of, torch::kLong);
    add_relations(rows, batch);
    return batch;
}

std::vector<PairBatchMaker::Row> PairBatchMaker::draw_rows(Random& random) const {
    const auto groups = training_.pictures.count / members_;
    std::vector<Row> rows;
    for (int g = 0; g < training_.parameters.clip_batch; ++g) {
        const std::uint64_t group = random.below(groups);
        const bool full = random.uniform() < FullShare;
        const std::uint64_t wording = random.next();
        for (std::uint64_t m = 0; m < members_; ++m) {
            const std::uint64_t picture = group * members_ + m;
            // Full sentences of a group differ in nothing but what differs in the pictures.
            const std::uint64_t seed = full ? wording : random.next();
            rows.push_back({picture, training_.pairs.claim(picture, seed, full), full, {}});
            if (training_.parameters.false_weight > 0)
                rows.back().false_texts = training_.pairs.false_claims(picture, seed, full);
        }
    }
    return rows;
}

torch::Tensor PairBatchMaker::pictures_of(const std::vector<Row>& rows, Random& random) const {
    const auto& pictures = training_.pictures;
    const std::int64_t side = pictures.size, count = static_cast<std::int64_t>(rows.size());
    const auto stride = static_cast<std::size_t>(side * side * 3);
    auto bytes = torch::empty({count, side, side, 3}, torch::kUInt8);
    for (std::size_t i = 0; i < rows.size(); ++i)
        std::memcpy(bytes.data_ptr<std::uint8_t>() + i * stride, &pictures.rgb[rows[i].picture * stride],
                    stride);
    const auto values = bytes.permute({0, 3, 1, 2}).to(torch::kFloat).div_(255.0);
    std::vector<torch::Tensor> groups;
    const auto members = static_cast<std::int64_t>(members_);
    for (std::int64_t first = 0; first < count; first += members)
        groups.push_back(augment(values.narrow(0, first, members), random));
    return torch::cat(groups);
}

torch::Tensor PairBatchMaker::ids_of(const std::vector<std::string>& texts) const {
    auto ids =
        torch::full({static_cast<std::int64_t>(texts.size()), StarterTokenCount}, table_.eos(), torch::kLong);
    auto cells = ids.accessor<std::int64_t, 2>();
    for (std::size_t i = 0; i < texts.size(); ++i) {
        const auto row = static_cast<std::int64_t>(i);
        cells[row][0] = table_.bos();
        std::int64_t position = 1;
        for (const auto& word : split_caption(texts[i]))
            if (position < StarterTokenCount - 1) cells[row][position++] = table_.id(word);
    }
    return ids;
}

bool PairBatchMaker::look_alike(std::uint64_t a, std::uint64_t b) const {
    const auto stride = static_cast<std::size_t>(training_.pictures.size) *
                        static_cast<std::size_t>(training_.pictures.size) * 3;
    const std::uint8_t* first = &training_.pictures.rgb[a * stride];
    const std::uint8_t* second = &training_.pictures.rgb[b * stride];
    int clear = 0;
    for (std::size_t p = 0; p < stride && clear < LeastClearPixels; p += 3) {
        const auto differs = [&](std::size_t c) {
            return std::abs(int{first[p + c]} - int{second[p + c]}) > ClearStep;
        };
        if (differs(0) || differs(1) || differs(2)) ++clear;
    }
    return clear < LeastClearPixels;
}

void PairBatchMaker::add_relations(const std::vector<Row>& rows, PairBatch& batch) const {
    const auto count = static_cast<std::int64_t>(rows.size());
    batch.blocked = torch::zeros({count, count}, torch::kBool);
    auto blocked = batch.blocked.accessor<bool, 2>();
    std::vector<std::uint64_t> facts;
    for (const auto& row : rows) facts.push_back(training_.pairs.facts(row.picture));
    for (std::size_t i = 0; i < rows.size(); ++i)
        for (std::size_t j = 0; j < rows.size(); ++j)
            blocked[static_cast<std::int64_t>(i)][static_cast<std::int64_t>(j)] =
                i != j && (rows[j].claim.facts & ~facts[i]) == 0;
    std::vector<std::int64_t> from, to;
    for (std::size_t first = 0; first < rows.size(); first += members_)
        for (std::size_t i = first; i < first + members_; ++i)
            for (std::size_t j = i + 1; j < first + members_; ++j) {
                const auto a = static_cast<std::int64_t>(i), b = static_cast<std::int64_t>(j);
                if (look_alike(rows[i].picture, rows[j].picture)) {
                    blocked[a][b] = blocked[b][a] = true;
                } else if (rows[first].full && i == first && rows[i].claim.facts != rows[j].claim.facts) {
                    from.push_back(a);
                    to.push_back(b);
                }
            }
    batch.from = torch::tensor(from, torch::kLong);
    batch.to = torch::tensor(to, torch::kLong);
    compare_changes(from, to, facts, batch);
}

}  // namespace gse::training
