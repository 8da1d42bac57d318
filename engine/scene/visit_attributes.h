// One visit of every attribute of Gaussians, with its stride.
#pragma once

#include <cstddef>

namespace gse {

/// Calls f(stride, array) for each attribute of `data`, or f(stride, array, array of the next, ...) for
/// several.
template <class F, class Data, class... More> void visit_attributes(F&& f, Data& data, More&... more) {
    f(std::size_t{3}, data.position, more.position...);
    f(std::size_t{3}, data.log_scale, more.log_scale...);
    f(std::size_t{4}, data.rotation, more.rotation...);
    f(std::size_t{1}, data.opacity_logit, more.opacity_logit...);
    f(data.sh_stride(), data.sh, more.sh...);
}

}  // namespace gse
