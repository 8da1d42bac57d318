// One thread per part, each with a team of one.
#include "engine/neural/layers/parallel_for_batches.h"

#include <torch/torch.h>

#include <algorithm>
#include <exception>
#include <thread>
#include <vector>

#include "engine/neural/api/network_use.h"

// The OpenMP library behind torch has the first, whose number holds for the calling thread; OpenBLAS the
// others, for all of them.
extern "C" {
void omp_set_num_threads(int count) __attribute__((weak));
void openblas_set_num_threads(int count) __attribute__((weak));
int openblas_get_num_threads() __attribute__((weak));
}

namespace gse::neural {
namespace {

/// Channels of the widest level up to which a model is small.
constexpr std::int64_t WidestSmallModel = 256;

/// While it lives, the calling thread shares no operation out.
class AloneHere {
public:
    AloneHere() : before_(torch::get_num_threads()) {  // which also sets up a thread that is new
        if (omp_set_num_threads != nullptr) omp_set_num_threads(1);
    }
    ~AloneHere() {
        if (omp_set_num_threads != nullptr) omp_set_num_threads(before_);
    }
    AloneHere(const AloneHere&) = delete;
    AloneHere& operator=(const AloneHere&) = delete;

private:
    int before_;
};

/// While it lives, OpenBLAS leaves every product to the thread that asks for it; its own ones are lent to one
/// at a time.
class BlasAlone {
public:
    BlasAlone() {
        if (openblas_get_num_threads == nullptr || openblas_set_num_threads == nullptr) return;
        before_ = openblas_get_num_threads();
        if (before_ > 1) openblas_set_num_threads(1);
    }
    ~BlasAlone() {
        if (before_ > 1) openblas_set_num_threads(before_);
    }
    BlasAlone(const BlasAlone&) = delete;
    BlasAlone& operator=(const BlasAlone&) = delete;

private:
    int before_ = 1;
};

}  // namespace

bool is_small(const UNetConfig& config) {
    const auto& widths = config.block_out_channels;
    return *std::max_element(widths.begin(), widths.end()) <= WidestSmallModel;
}

int batch_threads() {
    constexpr unsigned most = 16;
    return static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1u, most));
}

void parallel_for_batches(std::int64_t count, bool apart,
                          const std::function<void(std::int64_t begin, std::int64_t end)>& body) {
    if (count <= 0) return;
    const torch::NoGradGuard no_grad;
    if (!apart) return body(0, count);
    const auto parts = std::min<std::int64_t>(batch_threads(), count);
    const BlasAlone blas_alone;
    std::vector<std::exception_ptr> failures(static_cast<std::size_t>(parts));
    std::vector<NetworkUse> uses(static_cast<std::size_t>(parts));
    const auto work = [&](std::int64_t part) {
        const auto i = static_cast<std::size_t>(part);
        const AloneHere alone;
        const torch::NoGradGuard no_grad_here;
        const auto before = thread_use();
        try {
            body(count * part / parts, count * (part + 1) / parts);
        } catch (...) { failures[i] = std::current_exception(); }
        uses[i] = thread_use() - before;
    };
    {
        std::vector<std::jthread> others;
        for (std::int64_t part = 1; part < parts; ++part) others.emplace_back(work, part);
        work(0);
    }
    for (std::size_t i = 1; i < uses.size(); ++i) thread_use() += uses[i];
    for (const auto& failure : failures)
        if (failure) std::rethrow_exception(failure);
}

}  // namespace gse::neural
