// Stands in for libFuzzer: replays a saved corpus, then seeded mutations of it, for a bounded time.
// GSE_FUZZ_RUNS sets another number of mutations, however long they take.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "engine/base/file.h"
#include "engine/base/random.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

constexpr int Mutations = 3000;
constexpr double SecondsAtMost = 0.4;  // ten targets stay under five seconds together

void run(const std::string& bytes) {
    // An exact copy on the heap, so that an address sanitizer sees one byte too far.
    const std::vector<std::uint8_t> exact(bytes.begin(), bytes.end());
    LLVMFuzzerTestOneInput(exact.data(), exact.size());
}

/// One to five random changes: a byte, a bit, an interesting number, a cut, a repeated piece, a piece of
/// another input.
std::string mutate(std::string bytes, const std::string& other, gse::Random& random) {
    const std::uint64_t changes = 1 + random.below(5);
    for (std::uint64_t change = 0; change < changes && !bytes.empty(); ++change) {
        const std::size_t at = random.below(bytes.size());
        const std::size_t size = std::min<std::size_t>(1 + random.below(16), bytes.size() - at);
        switch (random.below(7)) {
            case 0: bytes[at] = static_cast<char>(random.next()); break;
            case 1: bytes[at] = static_cast<char>(bytes[at] ^ (1 << random.below(8))); break;
            case 2:
                bytes.replace(at, std::min<std::size_t>(4, bytes.size() - at),
                              random.below(2) == 0 ? "\xff\xff\xff\xff" : std::string(4, '\0'));
                break;
            case 3: bytes.resize(at); break;
            case 4: bytes.insert(at, bytes.substr(at, size)); break;
            case 5: bytes.erase(at, size); break;
            default:
                if (!other.empty()) bytes.insert(at, other.substr(random.below(other.size()), size));
        }
    }
    return bytes;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: %s CORPUS_FOLDER\n", argv[0]);
        return 2;
    }
    std::vector<std::filesystem::path> paths;
    for (const auto& entry : std::filesystem::directory_iterator(argv[1])) paths.push_back(entry.path());
    std::sort(paths.begin(), paths.end());
    std::vector<std::string> corpus;
    for (const auto& path : paths) corpus.push_back(gse::read_file(path));
    if (corpus.empty()) {
        std::fprintf(stderr, "the corpus %s is empty\n", argv[1]);
        return 1;
    }
    run("");
    for (const std::string& bytes : corpus) run(bytes);
    const auto start = std::chrono::steady_clock::now();
    gse::Random random(20240501);
    int done = 0;
    const char* runs = std::getenv("GSE_FUZZ_RUNS");
    const int most = runs != nullptr ? std::atoi(runs) : Mutations;
    for (; done < most; ++done) {
        const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
        if (runs == nullptr && taken.count() > SecondsAtMost) break;
        run(mutate(corpus[random.below(corpus.size())], corpus[random.below(corpus.size())], random));
    }
    std::printf("%zu saved inputs and %d mutations\n", corpus.size(), done);
    return 0;
}
