// The median of earlier times.
#include "engine/remote/drawing/picture_times.h"

#include "engine/math/quantile.h"

namespace gse::remote {

std::optional<double> PictureTimes::usual_of_slow() const {
    if (times_.size() < LeastTimed) return std::nullopt;
    auto times = times_;
    const double usual = upper_median(times), now = clock_() - begun_;
    return now > SlowFactor * usual && now > LeastSlowSeconds ? std::optional(usual) : std::nullopt;
}

}  // namespace gse::remote
