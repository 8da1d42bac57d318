// gseditpro-lab bench server: ways to make a server's views agree, with a server that contradicts itself.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/base/fields.h"
#include "engine/base/progress.h"

namespace gse::bench {

struct ServerBenchParameters {
    double hue = 40;
    double texture = 0.1;
    double outline = 6;
    int side = 256;
    int seeds = 3;

    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        f("hue", self.hue, "Largest error of the hue, degrees.", Range{0, 60});
        f("texture", self.texture, "Amplitude of stripes whose phase differs between pictures.", Range{0, 1});
        f("outline", self.outline, "Pixels by which the painted part falls short of the mask.",
          Range{0, 100});
        f("side", self.side, "Side of the pictures, pixels.", Range{64, 1024});
        f("seeds", self.seeds, "Edits per way, each from another seed.", Range{1, 100});
    }
};

/// Figures of one way, means over the seeds.
struct AgreementFigures {
    std::string name;
    double disagreement = 0;  // of the last round's pictures, as ViewAgreement has it
    double psnr = 0;          // dB of the fitted scene to the truth, over what the label covers
    double rejected = 0, requests = 0, megapixels = 0, seconds = 0;
};

/// Edits the scene at `path`, whose bear becomes blue, in every way. Throws Error, also when stopped.
std::vector<AgreementFigures> bench_server(const std::filesystem::path& path,
                                           const ServerBenchParameters& parameters, const JobControl& job);

std::string agreement_text(const std::vector<AgreementFigures>& rows);
nlohmann::ordered_json agreement_json(const std::vector<AgreementFigures>& rows);

}  // namespace gse::bench
