// Buffers of tensors that come again, and what is given back.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>
#include <torch/torch.h>

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "engine/neural/layers/buffer_cache.h"
#include "tests/test_paths.h"

using namespace gse::neural;

namespace {

torch::Tensor tensor_of(std::size_t bytes) {
    return torch::empty({static_cast<std::int64_t>(bytes)}, torch::kUInt8);
}

/// Sanitizers bring their own allocators, under which buffers are not kept.
bool keeps() {
    keep_buffers();
    release_buffers();
    const auto before = buffer_use().fresh;
    tensor_of(2 * LeastKeptBuffer);
    release_buffers();
    if (buffer_use().fresh > before) return true;
    gse::test::skip("a sanitizer allocates here");
    return false;
}

/// Flags that the system shows of the mapping around an address, as in /proc/self/smaps; empty where it shows
/// none.
std::string mapping_flags(const void* address) {
    const auto wanted = reinterpret_cast<std::uintptr_t>(address);
    std::ifstream maps("/proc/self/smaps");
    bool inside = false;
    for (std::string line; std::getline(maps, line);) {
        std::uintptr_t begin = 0, end = 0;
        char dash = 0;
        if (std::istringstream range(line); range >> std::hex >> begin >> dash >> end && dash == '-')
            inside = begin <= wanted && wanted < end;
        if (inside && line.starts_with("VmFlags:")) return line + ' ';
    }
    return {};
}

bool has_huge_pages() {
    std::ifstream file("/sys/kernel/mm/transparent_hugepage/enabled");
    std::string choice;
    return std::getline(file, choice) && choice.find("[never]") == std::string::npos;
}

}  // namespace

DOCTEST_TEST_CASE("a large tensor asks for huge pages") {
    if (!keeps()) return;
    const auto tensor = tensor_of(2 * LeastKeptBuffer);
    const auto flags = mapping_flags(static_cast<const char*>(tensor.data_ptr()) + LeastKeptBuffer);
    if (flags.empty() || !has_huge_pages()) {
        gse::test::skip("the system has no huge pages, or does not show them");
        return;
    }
    DOCTEST_CHECK_MESSAGE(flags.find(" hg ") != std::string::npos, flags);
}

DOCTEST_TEST_CASE(
    "a large tensor's memory is used again for the next one of its size, aligned as torch promises") {
    if (!keeps()) return;
    constexpr std::size_t bytes = 2 * LeastKeptBuffer;
    void* first = nullptr;
    {
        const auto tensor = tensor_of(bytes);
        first = tensor.data_ptr();
        DOCTEST_CHECK(reinterpret_cast<std::uintptr_t>(first) % 64 == 0);
    }
    const auto kept = buffer_use();
    DOCTEST_CHECK(kept.kept >= bytes);
    {
        const auto next = tensor_of(bytes - 1000);
        DOCTEST_CHECK(next.data_ptr() == first);
        const auto beside = tensor_of(bytes);  // the first is in use
        DOCTEST_CHECK(beside.data_ptr() != first);
    }
    DOCTEST_CHECK(buffer_use().reused == kept.reused + 1);
    release_buffers();
    DOCTEST_CHECK(buffer_use().kept == 0);
}

DOCTEST_TEST_CASE("a buffer much longer than asked for is not taken, and small tensors never are kept") {
    if (!keeps()) return;
    { const auto tensor = tensor_of(4 * LeastKeptBuffer); }
    const auto before = buffer_use();
    { const auto tensor = tensor_of(2 * LeastKeptBuffer); }
    DOCTEST_CHECK(buffer_use().reused == before.reused);
    const auto kept = buffer_use().kept;
    { const auto tensor = tensor_of(LeastKeptBuffer / 2); }
    DOCTEST_CHECK(buffer_use().kept == kept);
    release_buffers();
}

DOCTEST_TEST_CASE("no more is kept than the limit, the longest unused goes first") {
    if (!keeps()) return;
    constexpr std::size_t bytes = MostKeptBytes / 4;
    std::vector<torch::Tensor> tensors;
    for (int i = 0; i < 6; ++i) tensors.push_back(tensor_of(bytes));
    const void* last = tensors.back().data_ptr();
    for (auto& tensor : tensors) tensor = torch::Tensor();
    DOCTEST_CHECK(buffer_use().kept <= MostKeptBytes);
    DOCTEST_CHECK(buffer_use().kept >= MostKeptBytes / 2);
    DOCTEST_CHECK(tensor_of(bytes).data_ptr() == last);
    { const auto more = tensor_of(2 * MostKeptBytes); }  // longer than all that may be kept
    DOCTEST_CHECK(buffer_use().kept <= MostKeptBytes);
    release_buffers();
    DOCTEST_CHECK(buffer_use().kept == 0);
}

DOCTEST_TEST_CASE("what the system cannot give is an error, and what is kept goes first") {
    if (!keeps()) return;
    { const auto tensor = tensor_of(2 * LeastKeptBuffer); }
    DOCTEST_CHECK(buffer_use().kept > 0);
    DOCTEST_CHECK_THROWS_AS(tensor_of(std::size_t{1} << 60), c10::Error);
    DOCTEST_CHECK(buffer_use().kept == 0);
    DOCTEST_CHECK(torch::ones({8}).sum().item<float>() == 8);
}
