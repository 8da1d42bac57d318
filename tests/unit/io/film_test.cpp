// Films: a film that the disk does not take whole never replaces a good one, and every cut of a film is told
// from a whole one.
#include <signal.h>
#include <sys/resource.h>

#include <cmath>

#include "engine/io/image/film_check.h"
#include "engine/io/image/video.h"
#include "tests/unit/io/io_helpers.h"

namespace film_test {

using namespace gse;
using namespace gse::test;

#ifdef GSE_HAVE_OPENCV
namespace {

constexpr int Side = 64, Frames = 24;

/// Noise, so that the film has some size.
void write_noise(const std::filesystem::path& path, std::uint64_t seed) {
    Random random(seed);
    VideoWriter film(path, Side, Side, 24);
    for (int frame = 0; frame < Frames; ++frame) {
        Image picture(Side, Side, 3);
        for (float& value : picture.data) value = static_cast<float>(random.uniform());
        film.add(picture);
    }
    film.finish();
}

std::size_t entries_of(const std::filesystem::path& folder) {
    return static_cast<std::size_t>(
        std::distance(std::filesystem::directory_iterator(folder), std::filesystem::directory_iterator()));
}

}  // namespace

DOCTEST_TEST_CASE("a film cut off at any byte is not whole") {
    const ScratchFolder scratch;
    for (const char* name : {"a.mp4", "a.webm"}) {
        DOCTEST_CAPTURE(name);
        write_noise(scratch.path() / name, 1);
        const std::string bytes = read_file(scratch.path() / name);
        DOCTEST_REQUIRE(bytes.size() > 20000);
        DOCTEST_CHECK(io::film_is_whole(as_bytes(bytes)));
        for (std::size_t size = 0; size < bytes.size();
             size += size < 200 || bytes.size() - size < 3000 ? 1 : 97)
            if (io::film_is_whole(as_bytes(bytes).first(size))) {
                DOCTEST_CAPTURE(size);
                DOCTEST_CHECK(false);
            }
    }
}

DOCTEST_TEST_CASE("a film that the disk does not take whole leaves the old one and says why") {
    const ScratchFolder scratch;
    signal(SIGXFSZ, SIG_IGN);
    for (const char* name : {"a.mp4", "a.webm"}) {
        DOCTEST_CAPTURE(name);
        const auto path = scratch.path() / name;
        write_noise(path, 1);
        const std::string old = read_file(path);
        write_noise(scratch.path() / "other" / name, 2);
        const auto whole = static_cast<double>(std::filesystem::file_size(scratch.path() / "other" / name));
        for (const double share : {0.0, 0.1, 0.5, 0.9, 0.999}) {
            DOCTEST_CAPTURE(share);
            rlimit before{};
            getrlimit(RLIMIT_FSIZE, &before);
            const rlimit limit{static_cast<rlim_t>(share * whole), before.rlim_max};
            setrlimit(RLIMIT_FSIZE, &limit);
            const auto error = error_of([&] { write_noise(path, 2); });
            setrlimit(RLIMIT_FSIZE, &before);
            DOCTEST_REQUIRE(error);
            DOCTEST_CHECK(error->code() == ErrorCode::Unwritable);
            DOCTEST_CHECK(read_file(path) == old);
        }
        write_noise(path, 2);
        DOCTEST_CHECK(read_file(path) != old);
    }
    DOCTEST_CHECK(entries_of(scratch.path()) == 3);
}

DOCTEST_TEST_CASE("a film is written where a link leads") {
    const ScratchFolder scratch;
    std::filesystem::create_directory(scratch.path() / "disk");
    std::filesystem::create_symlink("disk/real.mp4", scratch.path() / "a.mp4");
    write_noise(scratch.path() / "a.mp4", 1);
    DOCTEST_CHECK(std::filesystem::is_symlink(scratch.path() / "a.mp4"));
    DOCTEST_CHECK(io::film_is_whole(as_bytes(read_file(scratch.path() / "disk/real.mp4"))));
}
#endif

}  // namespace film_test
