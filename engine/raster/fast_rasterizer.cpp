// First fast version: threads over Gaussians and tiles, float blending; the derivative is still the plain
// one.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "engine/base/check.h"
#include "engine/raster/plain.h"

namespace gse::raster {
namespace {

constexpr int Tile = 16;

struct Record {
    float x, y, a, b, c, opacity, depth, threshold;
    float colour[3];
    std::uint32_t row;
};

struct TileState {
    float t[256], rgb[256][3], depth[256];
    std::int32_t blended[256];
    bool done[256];
    int left;
};

class FirstFastRasterizer final : public Rasterizer {
public:
    explicit FirstFastRasterizer(ThreadPool& pool) : pool_(pool), plain_(make_plain_rasterizer()) {}

    void forward(const GaussianSpans& gaussians, const Camera& camera, const Settings& settings,
                 ForwardOutput& output) override {
        gaussians_ = gaussians;
        camera_ = camera;
        settings_ = settings;
        prepare(gaussians, camera, settings, {});
        output.colour.resize(camera.width, camera.height, 3);
        output.alpha.resize(camera.width, camera.height, 1);
        output.depth.resize(camera.width, camera.height, 1);
        output.blended.resize(output.alpha.pixel_count());
        output.pairs = pairs_.size();
        output.dropped_rows = dropped_;
        each_tile([&](std::size_t tile, TileState& state) {
            blend(tile, state, [](std::size_t, int, float) {});
            each_pixel(tile, [&](int local, std::size_t pixel) {
                const float rest = state.t[local];
                for (std::size_t c = 0; c < 3; ++c)
                    output.colour.data[pixel * 3 + c] = state.rgb[local][c] + rest * settings.background[c];
                output.alpha.data[pixel] = 1 - rest;
                output.depth.data[pixel] = state.depth[local];
                output.blended[pixel] = state.blended[local];
            });
        });
    }

    void backward(const Image& d_colour, const Image& d_alpha, std::size_t first_row,
                  Gradients& output) override {
        ForwardOutput ignored;
        plain_->forward(gaussians_, camera_, settings_, ignored);
        plain_->backward(d_colour, d_alpha, first_row, output);
    }

    void contributions(const GaussianSpans& gaussians, const Camera& camera, const Settings& settings,
                       const Image& mask, std::span<double> masked, std::span<double> total) override {
        GSE_CHECK_EQ(masked.size(), gaussians.size);
        prepare(gaussians, camera, settings, {});
        partial_.assign(pairs_.size() * 2, 0.0);
        each_tile([&](std::size_t tile, TileState& state) {
            const std::size_t width = static_cast<std::size_t>(camera.width);
            const std::size_t x0 = tile % columns_ * Tile, y0 = tile / columns_ * Tile;
            blend(tile, state, [&](std::size_t entry, int local, float weight) {
                const std::size_t pixel = (y0 + static_cast<std::size_t>(local / Tile)) * width + x0 +
                                          static_cast<std::size_t>(local % Tile);
                partial_[entry * 2] += static_cast<double>(weight * mask.data[pixel]);
                partial_[entry * 2 + 1] += static_cast<double>(weight);
            });
        });
        for (std::size_t entry = 0; entry < pairs_.size(); ++entry) {
            masked[records_[pairs_[entry]].row] += partial_[entry * 2];
            total[records_[pairs_[entry]].row] += partial_[entry * 2 + 1];
        }
    }

    void forward_values(const GaussianSpans& gaussians, const Camera& camera, const Settings& settings,
                        std::span<const float> values, Image& output) override {
        GSE_CHECK_EQ(values.size(), gaussians.size);
        prepare(gaussians, camera, settings, values);
        output.resize(camera.width, camera.height, 1);
        each_tile([&](std::size_t tile, TileState& state) {
            blend(tile, state, [](std::size_t, int, float) {});
            each_pixel(tile, [&](int local, std::size_t pixel) { output.data[pixel] = state.rgb[local][0]; });
        });
    }

    std::string name() const override { return "scalar"; }

private:
    void prepare(const GaussianSpans& gaussians, const Camera& camera, const Settings& settings,
                 std::span<const float> values) {
        project_rows(gaussians, {camera, settings}, values);
        width_ = camera.width;
        height_ = camera.height;
        columns_ = static_cast<std::size_t>((width_ + Tile - 1) / Tile);
        const std::size_t tiles = columns_ * static_cast<std::size_t>((height_ + Tile - 1) / Tile);
        offsets_.assign(tiles + 1, 0);
        const auto each_cell = [&](const Record& r, auto&& visit) {
            const float wide = half_[r.row * 2], high = half_[r.row * 2 + 1];
            const auto cell = [](float at, int size) {
                return static_cast<std::size_t>(std::clamp(at, 0.0f, static_cast<float>(size - 1))) / Tile;
            };
            for (std::size_t y = cell(r.y - high - 1, height_); y <= cell(r.y + high + 1, height_); ++y)
                for (std::size_t x = cell(r.x - wide - 1, width_); x <= cell(r.x + wide + 1, width_); ++x)
                    visit(y * columns_ + x);
        };
        for (const Record& record : records_)
            each_cell(record, [&](std::size_t tile) { ++offsets_[tile + 1]; });
        for (std::size_t tile = 0; tile < tiles; ++tile) offsets_[tile + 1] += offsets_[tile];
        cursor_.assign(offsets_.begin(), offsets_.end());
        pairs_.resize(offsets_.back());
        for (std::size_t i = 0; i < records_.size(); ++i)
            each_cell(records_[i],
                      [&](std::size_t tile) { pairs_[cursor_[tile]++] = static_cast<std::uint32_t>(i); });
    }

    void project_rows(const GaussianSpans& g, const plain::View& view, std::span<const float> values) {
        all_.resize(g.size);
        fate_.resize(g.size);
        half_.resize(g.size * 2);
        pool_.parallel_for(g.size, 512, [&](std::size_t begin, std::size_t end, unsigned) {
            const std::size_t stride = static_cast<std::size_t>(sh_coefficient_count(g.sh_degree)) * 3;
            std::array<double, 59> wide{};
            for (std::size_t row = begin; row < end; ++row) {
                std::copy_n(&g.position[row * 3], 3, &wide[0]);
                std::copy_n(&g.log_scale[row * 3], 3, &wide[3]);
                std::copy_n(&g.rotation[row * 4], 4, &wide[6]);
                wide[10] = g.opacity_logit[row];
                std::copy_n(&g.sh[row * stride], stride, &wide[11]);
                const std::span<const double> s(wide);
                const plain::Inputs one{1,
                                        g.sh_degree,
                                        s.subspan(0, 3),
                                        s.subspan(3, 3),
                                        s.subspan(6, 4),
                                        s.subspan(10, 1),
                                        s.subspan(11, stride)};
                plain::Splat p;
                fate_[row] = plain::project(one, 0, view, p);
                if (fate_[row] != plain::Fate::Drawn) continue;
                const auto f = [](double v) { return static_cast<float>(v); };
                all_[row] = {f(p.x),
                             f(p.y),
                             f(p.a),
                             f(p.b),
                             f(p.c),
                             f(p.opacity),
                             f(p.depth),
                             0,
                             {f(p.colour[0]), f(p.colour[1]), f(p.colour[2])},
                             static_cast<std::uint32_t>(row)};
                if (!values.empty()) all_[row].colour[0] = values[row];
                half_[row * 2] = f(p.half_width);
                half_[row * 2 + 1] = f(p.half_height);
            }
        });
        records_.clear();
        dropped_ = 0;
        for (std::size_t row = 0; row < g.size; ++row) {
            if (fate_[row] == plain::Fate::Drawn) records_.push_back(all_[row]);
            if (fate_[row] == plain::Fate::Unusable) ++dropped_;
        }
        std::sort(records_.begin(), records_.end(), [](const Record& a, const Record& b) {
            return a.depth != b.depth ? a.depth < b.depth : a.row < b.row;
        });
    }

    template <class Body>
    void each_tile(Body&& body) {
        pool_.parallel_for(offsets_.size() - 1, 4, [&](std::size_t begin, std::size_t end, unsigned) {
            TileState state;
            for (std::size_t tile = begin; tile < end; ++tile) body(tile, state);
        });
    }

    template <class Body>
    void each_pixel(std::size_t tile, Body&& body) {
        const int x0 = static_cast<int>(tile % columns_) * Tile,
                  y0 = static_cast<int>(tile / columns_) * Tile;
        for (int local = 0; local < Tile * Tile; ++local) {
            const int x = x0 + local % Tile, y = y0 + local / Tile;
            if (x < width_ && y < height_)
                body(local, static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                                static_cast<std::size_t>(x));
        }
    }

    template <class Visit>
    void blend(std::size_t tile, TileState& state, Visit&& visit) {
        std::memset(&state, 0, sizeof state);
        std::fill(std::begin(state.t), std::end(state.t), 1.0f);
        const int x0 = static_cast<int>(tile % columns_) * Tile,
                  y0 = static_cast<int>(tile / columns_) * Tile;
        state.left = std::min(Tile, width_ - x0) * std::min(Tile, height_ - y0);
        for (std::size_t entry = offsets_[tile]; entry < offsets_[tile + 1] && state.left > 0; ++entry) {
            const Record& r = records_[pairs_[entry]];
            const auto low = [](float at) {
                return std::max(0, static_cast<int>(std::floor(std::max(at, -1e3f))));
            };
            const auto high = [](float at, int size) {
                return static_cast<int>(std::min(at, static_cast<float>(size - 1)));
            };
            const float wide = half_[r.row * 2], tall = half_[r.row * 2 + 1];
            const int x_end = high(r.x + wide - static_cast<float>(x0), std::min(Tile, width_ - x0));
            const int y_end = high(r.y + tall - static_cast<float>(y0), std::min(Tile, height_ - y0));
            for (int y = low(r.y - tall - static_cast<float>(y0) - 1); y <= y_end; ++y)
                for (int x = low(r.x - wide - static_cast<float>(x0) - 1); x <= x_end; ++x)
                    blend_pixel(r, entry, {x, y, x0, y0}, state, visit);
        }
    }

    struct At {
        int x, y, x0, y0;
    };

    template <class Visit>
    static void blend_pixel(const Record& r, std::size_t entry, const At& at, TileState& state,
                            Visit&& visit) {
        const int local = at.y * Tile + at.x;
        if (state.done[local]) return;
        const float dx = r.x - (static_cast<float>(at.x0 + at.x) + 0.5f);
        const float dy = r.y - (static_cast<float>(at.y0 + at.y) + 0.5f);
        const float sigma = 0.5f * (r.a * dx * dx + r.c * dy * dy) + r.b * dx * dy;
        if (!(sigma >= 0) || sigma > 6) return;
        const float alpha = std::min(0.99f, r.opacity * std::exp(-sigma));
        if (alpha < 1.0f / 255.0f) return;
        const float after = state.t[local] * (1 - alpha);
        if (after <= 1e-4f) {
            state.done[local] = true;
            --state.left;
            return;
        }
        const float weight = alpha * state.t[local];
        for (int c = 0; c < 3; ++c) state.rgb[local][c] += weight * r.colour[c];
        state.depth[local] += weight * r.depth;
        ++state.blended[local];
        state.t[local] = after;
        visit(entry, local, weight);
    }

    ThreadPool& pool_;
    std::unique_ptr<Rasterizer> plain_;
    GaussianSpans gaussians_;
    Camera camera_;
    Settings settings_;
    std::vector<Record> all_, records_;
    std::vector<plain::Fate> fate_;
    std::vector<float> half_;
    std::vector<std::size_t> offsets_, cursor_;
    std::vector<std::uint32_t> pairs_;
    std::vector<double> partial_;
    std::size_t dropped_ = 0, columns_ = 0;
    int width_ = 0, height_ = 0;
};

}  // namespace

std::unique_ptr<Rasterizer> make_fast_rasterizer(ThreadPool& pool) {
    return std::make_unique<FirstFastRasterizer>(pool);
}

}  // namespace gse::raster
