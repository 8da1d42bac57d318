// The session of a rasterizer that prepares nothing.
#include "engine/raster/view_session.h"

namespace gse::raster {
namespace {

class FullViewSession final : public ViewSession {
public:
    explicit FullViewSession(Rasterizer& rasterizer) : rasterizer_(rasterizer) {}

    void forward(std::size_t, const GaussianSpans& gaussians, std::size_t first_row, const Camera& camera,
                 const Settings& settings, ForwardOutput& output) override {
        rasterizer_.forward(gaussians, camera, settings, output);
        first_row_ = first_row;
        ++work_.full;
    }

    void backward(const Image& d_colour, const Image& d_alpha, Gradients& output) override {
        rasterizer_.backward(d_colour, d_alpha, first_row_, output);
    }

    void forget() override {}
    ViewSessionWork work() const override { return work_; }

private:
    Rasterizer& rasterizer_;
    std::size_t first_row_ = 0;
    ViewSessionWork work_;
};

}  // namespace

std::unique_ptr<ViewSession> make_full_view_session(Rasterizer& rasterizer) {
    return std::make_unique<FullViewSession>(rasterizer);
}

std::unique_ptr<ViewSession> Rasterizer::view_session(std::size_t, std::size_t) {
    return make_full_view_session(*this);
}

}  // namespace gse::raster
