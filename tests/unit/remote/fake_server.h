// Image server in this process: draws by a rule, answers wrongly where it is told to, and keeps its orders.
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/remote/api/image_server.h"

namespace gse::test {

/// Picture in one colour, by its light: what the fake server paints inside a mask.
inline Image in_colour(const Image& picture, const std::array<float, 3>& colour) {
    Image result = picture;
    for (std::size_t i = 0; i < result.data.size(); i += 3) {
        const float light = (picture.data[i] + picture.data[i + 1] + picture.data[i + 2]) / 3;
        for (std::size_t c = 0; c < 3; ++c) result.data[i + c] = std::min(1.0f, 1.4f * light * colour[c]);
    }
    return result;
}

/// `inside` where the mask is set, `outside` elsewhere; everywhere without a mask.
inline Image where(const Image& mask, const Image& inside, const Image& outside) {
    if (mask.data.empty()) return inside;
    Image result = outside;
    for (std::size_t i = 0; i < mask.data.size(); ++i)
        if (mask.data[i] > 0.5f)
            for (std::size_t c = 0; c < 3; ++c) result.data[i * 3 + c] = inside.data[i * 3 + c];
    return result;
}

class FakeServer : public remote::ImageServer {
public:
    FakeServer() {
        facts.product = "sd-server";  // it keeps what lies outside of a mask
        facts.model = "sd-v1-5";
    }
    remote::ServerFacts facts;
    std::vector<remote::RedrawOrder> orders;  // that it was given
    std::array<float, 3> colour{1.0f, 0.75f, 0.1f};
    /// Draws in place of the usual recolouring; `call` counts from 0.
    std::function<Image(const remote::RedrawOrder& order, std::size_t call)> draws = {};
    std::size_t fails_from = ~std::size_t{0};  // call from which on nobody answers
    std::size_t lost_at = ~std::size_t{0};     // call that ends when all its previews were shown
    std::string model = {};                    // that it says has drawn
    std::size_t previews = 0;                  // pictures in the making that it shows for each, if asked
    std::function<void(std::size_t call)> while_drawn = {};  // before it says once more that it draws
    int place = 0;  // in its queue, which it tells before it draws; 0 = it draws

    remote::ServerFacts probe(const JobControl&) override { return facts; }
    remote::RedrawnPicture redraw(const remote::RedrawOrder& order, const JobControl& job) override {
        if (job.stop_requested()) throw Error(ErrorCode::Cancelled, "stopped");
        if (place > 0) job.report("waiting in the server's queue", place, 0);
        job.report(remote::DrawingStage, 0, 0);
        const std::size_t call = orders.size();
        if (call >= fails_from) throw Error(ErrorCode::Foreign, "nobody answers");
        for (std::size_t i = 0; i < previews && order.preview; ++i)
            order.preview(Image(8, 8, 3, 0.1f * static_cast<float>(i)));
        if (while_drawn) {
            while_drawn(call);
            if (job.stop_requested()) throw Error(ErrorCode::Cancelled, "stopped");
            job.report(remote::DrawingStage, 0, 0);
        }
        if (call == lost_at) throw Error(ErrorCode::Foreign, "the connection ended");
        orders.push_back(order);
        if (draws) return {draws(order, call), model};
        return {where(order.mask, in_colour(order.picture, colour), order.picture), model};
    }
};

}  // namespace gse::test
