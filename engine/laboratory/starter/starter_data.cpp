// Renders or reloads the training pictures.
#include "engine/laboratory/starter/starter_data.h"

#include <fmt/format.h>

#include <atomic>
#include <cstring>
#include <fstream>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/log.h"
#include "engine/base/thread_pool.h"

namespace gse::training {
namespace {

constexpr std::uint64_t CacheMagic = 0x3153434950455347ULL;  // "GSEPICS1"

struct CacheHeader {
    std::uint64_t magic = CacheMagic;
    std::uint64_t count = 0;
    std::uint32_t size = 0;
    std::uint32_t cells = 0;
};

std::filesystem::path cache_path(const StarterTrainParameters& parameters, const StarterSource& source,
                                 const std::filesystem::path& work) {
    const std::string key = fmt::format("{}|{}|{}|{}", source.identity(), parameters.image_size,
                                        parameters.pictures, parameters.seed);
    std::uint64_t hash = 1469598103934665603ULL;  // FNV-1a
    for (const char letter : key) hash = (hash ^ static_cast<unsigned char>(letter)) * 1099511628211ULL;
    return work / fmt::format("pictures-{:016x}.bin", hash);
}

void allocate(StarterPictures& pictures, int size, std::size_t count) {
    const std::size_t side = static_cast<std::size_t>(size);
    pictures.size = size;
    pictures.cells = size / 4;
    pictures.count = count;
    pictures.rgb.resize(count * side * side * 3);
    pictures.coverage.resize(count * StarterPartCount * (side / 4) * (side / 4));
    pictures.bare_twin.resize(count);
}

bool read_cache(const std::filesystem::path& path, const StarterTrainParameters& parameters,
                StarterPictures& pictures) {
    std::ifstream stream(path, std::ios::binary);
    CacheHeader header;
    if (!stream || !stream.read(reinterpret_cast<char*>(&header), sizeof(header))) return false;
    const auto count = static_cast<std::size_t>(parameters.pictures);
    if (header.magic != CacheMagic || header.count != count ||
        header.size != static_cast<std::uint32_t>(parameters.image_size))
        return false;
    allocate(pictures, parameters.image_size, count);
    for (auto* part : {&pictures.rgb, &pictures.coverage, &pictures.bare_twin})
        if (!stream.read(reinterpret_cast<char*>(part->data()), static_cast<std::streamsize>(part->size())))
            return false;
    return true;
}

void write_cache(const std::filesystem::path& path, const StarterPictures& pictures) {
    write_atomically(path, [&](const std::filesystem::path& temporary) {
        std::ofstream stream(temporary, std::ios::binary);
        const CacheHeader header{CacheMagic, pictures.count, static_cast<std::uint32_t>(pictures.size),
                                 static_cast<std::uint32_t>(pictures.cells)};
        stream.write(reinterpret_cast<const char*>(&header), sizeof(header));
        for (const auto* part : {&pictures.rgb, &pictures.coverage, &pictures.bare_twin})
            stream.write(reinterpret_cast<const char*>(part->data()),
                         static_cast<std::streamsize>(part->size()));
        if (!stream.flush())
            throw Error(ErrorCode::Unwritable, "the picture cache cannot be written", "", path);
    });
}

void store(StarterPictures& pictures, std::size_t index, const StarterPicture& picture) {
    const std::size_t rgb_size = pictures.rgb.size() / pictures.count;
    const std::size_t coverage_size = pictures.coverage.size() / pictures.count;
    if (picture.rgb.size() != rgb_size || picture.coverage.size() != coverage_size)
        throw Error(ErrorCode::InvalidArgument, "the picture source returned a picture of another size");
    std::memcpy(&pictures.rgb[index * rgb_size], picture.rgb.data(), rgb_size);
    std::memcpy(&pictures.coverage[index * coverage_size], picture.coverage.data(), coverage_size);
    pictures.bare_twin[index] = picture.bare_twin ? 1 : 0;
}

}  // namespace

StarterPictures load_or_render_pictures(const StarterTrainParameters& parameters, const StarterSource& source,
                                        const std::filesystem::path& work, const JobControl& job) {
    StarterPictures pictures;
    const auto path = cache_path(parameters, source, work);
    if (read_cache(path, parameters, pictures)) {
        log::info("{} training pictures read from the cache", pictures.count);
        return pictures;
    }
    allocate(pictures, parameters.image_size, static_cast<std::size_t>(parameters.pictures));
    ThreadPool pool(static_cast<unsigned>(parameters.threads));
    std::atomic<int> done{0};
    pool.parallel_for(pictures.count, static_cast<std::size_t>(source.views_of_scene()),
                      [&](std::size_t begin, std::size_t end, unsigned worker) {
                          for (std::size_t index = begin; index < end; ++index) {
                              if (job.stop_requested())
                                  throw Error(ErrorCode::Cancelled,
                                              "stopped while rendering the training pictures");
                              store(pictures, index, source.picture(index, parameters.image_size));
                              const int finished = done.fetch_add(1) + 1;
                              if (worker == 0)
                                  job.report("rendering pictures", finished, parameters.pictures);
                          }
                      });
    write_cache(path, pictures);
    return pictures;
}

}  // namespace gse::training
