// Fuzz target: the readers of ply files; the one that reads pieces must say what the one that has all of it
// says.
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <filesystem>
#include <optional>
#include <string>

#include "engine/io/formats/ply/gaussian_ply.h"
#include "tests/fuzz/fuzz_helpers.h"

namespace gse::fuzz {
namespace {

/// A file of these bytes that lives in memory; the same one every time.
std::filesystem::path file_of(std::span<const std::byte> bytes) {
    static const int descriptor = memfd_create("ply", MFD_CLOEXEC);
    GSE_CHECK(descriptor >= 0);
    GSE_CHECK(ftruncate(descriptor, 0) == 0);
    GSE_CHECK_EQ(pwrite(descriptor, bytes.data(), bytes.size(), 0), static_cast<ssize_t>(bytes.size()));
    return "/proc/self/fd/" + std::to_string(descriptor);
}

/// Answer of a reader: a scene, nothing, or why not.
struct Answer {
    std::optional<Scene> scene;
    std::string refusal;
};

template <class F> Answer answer_of(F&& read) {
    Answer answer;
    try {
        answer.scene = read();
    } catch (const Error& error) { answer.refusal = error.message(); }
    return answer;
}

void compare_readers(std::span<const std::byte> bytes) {
    const auto pieces = answer_of([&] { return io::load_gaussian_ply(InputFile(file_of(bytes))); });
    if (!pieces.scene && pieces.refusal.empty()) return;
    const auto whole = answer_of([&] { return std::optional(io::parse_gaussian_ply(bytes)); });
    GSE_CHECK(pieces.refusal == whole.refusal);
    if (!pieces.scene) return;
    GSE_CHECK(pieces.scene->info.warnings == whole.scene->info.warnings);
    const auto &a = pieces.scene->gaussians, &b = whole.scene->gaussians;
    GSE_CHECK(same_bits(a.position(), b.position()) && same_bits(a.log_scale(), b.log_scale()) &&
              same_bits(a.rotation(), b.rotation()) && same_bits(a.opacity_logit(), b.opacity_logit()) &&
              same_bits(a.sh(), b.sh()));
}

}  // namespace
}  // namespace gse::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace gse;
    fuzz::quiet();
    const auto bytes = fuzz::as_bytes(data, size);
    fuzz::compare_readers(bytes);
    return fuzz::exercise([&] { fuzz::exercise_scene(parse_scene(bytes, "x.ply")); });
}
