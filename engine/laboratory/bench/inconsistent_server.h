// Image server in this process that paints things blue and contradicts itself from picture to picture.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "engine/base/random.h"
#include "engine/remote/api/image_server.h"

namespace gse::bench {

/// Amounts by which pictures of one request contradict each other.
struct Inconsistency {
    double hue = 40;       // degrees, largest deviation
    double texture = 0.1;  // amplitude of stripes whose phase differs, share of the light
    double outline = 6;    // px, by which the painted part falls short of the mask at most
    double noise = 0.01;   // deviation everywhere
};

/// Draws by a rule that is known, with errors that depend on the whole picture sent: the truth of an edit is
/// painted_truth(). Like real models it follows a reference, continues what is painted around a small hole,
/// and paints all objects of one picture alike.
class InconsistentServer final : public remote::ImageServer {
public:
    InconsistentServer(const Inconsistency& amounts, std::string model);
    remote::ServerFacts probe(const JobControl& job) override;
    remote::RedrawnPicture redraw(const remote::RedrawOrder& order, const JobControl& job) override;

private:
    std::array<double, 3> colour_for(const remote::RedrawOrder& order, Random& random) const;

    const Inconsistency amounts_;
    const std::string model_;
};

/// Picture [H,W,3] all in the colour that the server paints when it errs in nothing.
Image painted_truth(const Image& picture);

}  // namespace gse::bench
