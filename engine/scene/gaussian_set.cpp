// Bookkeeping of the structure of arrays.
#include "engine/scene/gaussian_set.h"

#include <utility>

#include "engine/base/check.h"

namespace gse {
namespace {

GaussianSet::Buffer share(std::vector<float> values) {
    return std::make_shared<const std::vector<float>>(std::move(values));
}

void append(std::vector<float>& to, const std::vector<float>& from, std::size_t row, std::size_t stride) {
    const auto begin = from.begin() + static_cast<std::ptrdiff_t>(row * stride);
    to.insert(to.end(), begin, begin + static_cast<std::ptrdiff_t>(stride));
}

std::vector<float> filter(std::span<const float> values, std::span<const unsigned char> keep,
                          std::size_t stride) {
    std::vector<float> result;
    for (std::size_t row = 0; row < keep.size(); ++row)
        if (keep[row] != 0)
            result.insert(result.end(), values.begin() + static_cast<std::ptrdiff_t>(row * stride),
                          values.begin() + static_cast<std::ptrdiff_t>((row + 1) * stride));
    return result;
}

std::vector<float> copy(std::span<const float> values) { return {values.begin(), values.end()}; }

}  // namespace

void GaussianData::resize(std::size_t n) {
    position.resize(n * 3);
    log_scale.resize(n * 3);
    rotation.resize(n * 4);
    opacity_logit.resize(n);
    sh.resize(n * sh_stride());
}

void GaussianData::append_row(const GaussianData& other, std::size_t row) {
    GSE_CHECK_EQ(sh_degree, other.sh_degree);
    append(position, other.position, row, 3);
    append(log_scale, other.log_scale, row, 3);
    append(rotation, other.rotation, row, 4);
    append(opacity_logit, other.opacity_logit, row, 1);
    append(sh, other.sh, row, sh_stride());
}

GaussianSpans spans(const GaussianData& data) {
    return {data.size(),   data.sh_degree,     data.position, data.log_scale,
            data.rotation, data.opacity_logit, data.sh};
}

GaussianSet::GaussianSet() : GaussianSet(GaussianData{}) {}

GaussianSet::GaussianSet(GaussianData data)
    : sh_degree_(data.sh_degree), position_(share(std::move(data.position))),
      log_scale_(share(std::move(data.log_scale))), rotation_(share(std::move(data.rotation))),
      opacity_logit_(share(std::move(data.opacity_logit))), sh_(share(std::move(data.sh))) {
    check_lengths();
}

GaussianSet::GaussianSet(GaussianBuffers buffers)
    : sh_degree_(buffers.sh_degree), position_(std::move(buffers.position)),
      log_scale_(std::move(buffers.log_scale)), rotation_(std::move(buffers.rotation)),
      opacity_logit_(std::move(buffers.opacity_logit)), sh_(std::move(buffers.sh)) {
    GSE_CHECK(position_ && log_scale_ && rotation_ && opacity_logit_ && sh_);
    check_lengths();
}

void GaussianSet::check_lengths() const {
    const std::size_t n = opacity_logit_->size();
    GSE_CHECK(sh_degree_ >= 0 && sh_degree_ <= MaxShDegree);
    GSE_CHECK_EQ(position_->size(), n * 3);
    GSE_CHECK_EQ(log_scale_->size(), n * 3);
    GSE_CHECK_EQ(rotation_->size(), n * 4);
    GSE_CHECK_EQ(sh_->size(), n * static_cast<std::size_t>(sh_coefficient_count(sh_degree_)) * 3);
}

GaussianSpans GaussianSet::spans() const {
    return {size(),     sh_degree_,      *position_, *log_scale_,
            *rotation_, *opacity_logit_, *sh_,       colours_known_.get()};
}

GaussianData GaussianSet::to_data() const {
    return {sh_degree_,       copy(*position_),      copy(*log_scale_),
            copy(*rotation_), copy(*opacity_logit_), copy(*sh_)};
}

GaussianSet GaussianSet::filtered(std::span<const unsigned char> keep) const {
    GSE_CHECK_EQ(keep.size(), size());
    GaussianData data;
    data.sh_degree = sh_degree_;
    data.position = filter(*position_, keep, 3);
    data.log_scale = filter(*log_scale_, keep, 3);
    data.rotation = filter(*rotation_, keep, 4);
    data.opacity_logit = filter(*opacity_logit_, keep, 1);
    data.sh = filter(*sh_, keep, data.sh_stride());
    return GaussianSet(std::move(data));
}

std::size_t GaussianSet::byte_size() const {
    return sizeof(float) * (position_->size() + log_scale_->size() + rotation_->size() +
                            opacity_logit_->size() + sh_->size());
}

}  // namespace gse
