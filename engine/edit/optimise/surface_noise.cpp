// Hashed voxels, summed over the pixels of a cell.
#include "engine/edit/optimise/surface_noise.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/base/check.h"
#include "engine/base/random.h"
#include "engine/math/quantile.h"
#include "engine/math/unproject.h"

namespace gse::edit {
namespace {

/// Seeds a voxel's noise: FNV-1a over words with a mix. Edits of earlier versions come out bit by bit only
/// with exactly this hash.
std::uint64_t mixed(std::uint64_t value, std::uint64_t word) {
    value = (value ^ word) * 0x100000001b3ULL;
    return value ^ value >> 29;
}
constexpr std::uint64_t FirstValue = 0xcbf29ce484222325ULL;

std::uint64_t voxel_of(const Vec3& point, double voxel) {
    std::uint64_t value = FirstValue;
    for (int axis = 0; axis < 3; ++axis)
        value = mixed(value,
                      static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(point[axis] / voxel))));
    return value;
}

std::uint64_t private_voxel(std::uint64_t view, int cell_x, int cell_y) {
    constexpr std::string_view nothing = "nothing there";
    std::uint64_t first_word = 0;
    std::memcpy(&first_word, nothing.data(), sizeof first_word);
    std::uint64_t value = mixed(mixed(FirstValue, nothing.size()), first_word);
    for (const char letter : nothing.substr(sizeof first_word))
        value = mixed(value, static_cast<unsigned char>(letter));
    for (const auto part : {view, static_cast<std::uint64_t>(cell_x), static_cast<std::uint64_t>(cell_y)})
        value = mixed(value, part);
    return value;
}

/// World point of a pixel's surface.
/// Voxels of a cell with the pixels of each.
using Shares = std::vector<std::pair<std::uint64_t, int>>;

void count(Shares& shares, std::uint64_t voxel) {
    const auto found =
        std::find_if(shares.begin(), shares.end(), [&](const auto& share) { return share.first == voxel; });
    if (found != shares.end()) ++found->second;
    else shares.emplace_back(voxel, 1);
}

}  // namespace

Image surface_noise(const Image& depth, const Camera& camera, int cells, int channels, double voxel,
                    std::uint64_t seed, std::uint64_t view) {
    GSE_CHECK(cells > 0 && channels > 0 && voxel > 0);
    GSE_CHECK(depth.width == camera.width && depth.height == camera.height);
    std::vector<Shares> shares(static_cast<std::size_t>(cells) * static_cast<std::size_t>(cells));
    for (int y = 0; y < depth.height; ++y)
        for (int x = 0; x < depth.width; ++x) {
            const int cell_x = x * cells / depth.width, cell_y = y * cells / depth.height;
            const double z = depth.at(x, y, 0);
            count(shares[static_cast<std::size_t>(cell_y * cells + cell_x)],
                  z > 0 ? voxel_of(unprojected(camera, x + 0.5, y + 0.5, z), voxel)
                        : private_voxel(view, cell_x, cell_y));
        }
    Image noise(cells, cells, channels);
    const auto stride = static_cast<std::size_t>(channels);
    for (std::size_t cell = 0; cell < shares.size(); ++cell) {
        double squares = 0;
        std::vector<double> sums(stride, 0.0);
        for (const auto& [key, pixels] : shares[cell]) {
            Random random = Random::stream(seed, key);
            squares += static_cast<double>(pixels) * pixels;
            for (auto& sum : sums) sum += pixels * random.normal();
        }
        if (shares[cell].empty()) {  // more cells than pixels
            Random random = Random::stream(seed, private_voxel(view, static_cast<int>(cell), -1));
            squares = 1;
            for (auto& sum : sums) sum = random.normal();
        }
        for (std::size_t c = 0; c < stride; ++c)
            noise.data[cell * stride + c] = static_cast<float>(sums[c] / std::sqrt(squares));
    }
    return noise;
}

double noise_voxel(std::span<const EditView> views, int cells) {
    std::vector<double> sizes;
    for (const auto& view : views)
        for (std::size_t i = 0; i < view.mask.data.size(); ++i)
            if (view.mask.data[i] != 0 && view.depth.data[i] > 0)
                sizes.push_back(view.depth.data[i] / view.view.camera.fx * view.depth.width / cells);
    return sizes.empty() ? 1 : 0.5 * upper_median(sizes);
}

}  // namespace gse::edit
