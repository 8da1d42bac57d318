// Draws pictures and their captions into one file.
#include "engine/laboratory/training/picture_shards.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <map>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/json.h"
#include "engine/base/random.h"
#include "engine/laboratory/starter/split_caption.h"
#include "engine/laboratory/training/starter_source.h"

namespace gse::training {
namespace {

constexpr std::int32_t ShardMagic = 0x32485347;  // "GSH2"
constexpr std::uint8_t NoWord = 255, NoPart = 255;
constexpr std::uint64_t WordingStream = 7919;  // of a scene: how its captions are put

using Bytes = std::vector<std::uint8_t>;

struct Shard {
    Bytes after, before, coverage, room, outline, words, restyled;
    std::vector<float> cameras, next_share, fronts;
};

/// Places of the words of a sentence in the vocabulary.
class WordPlaces {
public:
    explicit WordPlaces(const std::vector<std::string>& vocabulary) {
        if (vocabulary.size() >= NoWord)
            throw Error(ErrorCode::Unsupported, "the vocabulary has more words than a byte tells apart");
        for (std::size_t i = 0; i < vocabulary.size(); ++i)
            places_[vocabulary[i]] = static_cast<std::uint8_t>(i);
        places_[","] = static_cast<std::uint8_t>(vocabulary.size());
    }
    void store(const std::string& sentence, std::uint8_t* to) const {
        std::fill_n(to, ShardWords, NoWord);
        int count = 0;
        for (const auto& word : split_caption(sentence)) {
            const auto found = places_.find(word);
            if (found == places_.end() || count == ShardWords)
                throw Error(ErrorCode::InvalidArgument,
                            "the caption \"" + sentence +
                                "\" is too long or has a word that is not in the vocabulary");
            to[count++] = found->second;
        }
    }

private:
    std::map<std::string, std::uint8_t> places_;
};

Shard empty_shard(const ShardRange& range) {
    const auto count = static_cast<std::size_t>(range.count),
               pixels = static_cast<std::size_t>(range.size * range.size);
    const auto cells = pixels / (LatentCell * LatentCell),
               wordings = static_cast<std::size_t>(range.wordings);
    Shard shard;
    shard.after.resize(count * pixels * 3);
    shard.before.resize(count * pixels * 3);
    shard.coverage.resize(count * StarterPartCount * cells);
    shard.room.resize(count * cells);
    shard.outline.resize(count * pixels);
    shard.words.resize(count * wordings * 2 * ShardWords);
    shard.restyled.resize(count);
    shard.cameras.resize(count * 2);
    shard.next_share.resize(count * wordings);
    shard.fronts.resize(count);
    return shard;
}

void copy_into(Bytes& all, std::size_t index, std::size_t count, const std::uint8_t* values) {
    const auto size = all.size() / count;
    std::memcpy(&all[index * size], values, size);
}

void draw(const StarterSource& source, const ShardRange& range, const WordPlaces& places, std::size_t i,
          Shard& shard) {
    const std::uint64_t index = range.first + i;
    const auto count = static_cast<std::size_t>(range.count),
               wordings = static_cast<std::size_t>(range.wordings);
    const auto after = source.picture(index, range.size);
    copy_into(shard.after, i, count, after.rgb.data());
    copy_into(shard.coverage, i, count, after.coverage.data());
    copy_into(shard.outline, i, count, after.outline.data());
    const auto restyled = source.restyled(index);
    shard.restyled[i] = restyled ? static_cast<std::uint8_t>(*restyled) : NoPart;
    const auto camera = source.camera(index);
    shard.cameras[2 * i] = static_cast<float>(camera.azimuth),
                      shard.cameras[2 * i + 1] = static_cast<float>(camera.elevation);
    shard.fronts[i] = static_cast<float>(camera.front);
    const auto scene = index / static_cast<std::uint64_t>(source.views_of_scene());
    for (std::size_t k = 0; k < wordings; ++k) {
        const auto caption = source.caption(index, Random::stream(WordingStream + k, scene).next(), false);
        const bool two = !caption.next_text.empty();
        places.store(caption.text, &shard.words[(i * wordings + k) * 2 * ShardWords]);
        places.store(two ? caption.next_text : caption.text,
                     &shard.words[((i * wordings + k) * 2 + 1) * ShardWords]);
        shard.next_share[i * wordings + k] = two ? static_cast<float>(caption.next_share) : 0.0f;
    }
}

void draw_before(const StarterSource& before, const ShardRange& range, std::size_t i, Shard& shard) {
    const auto count = static_cast<std::size_t>(range.count), cells = shard.room.size() / count;
    const auto picture = before.picture(range.first + i, range.size);
    copy_into(shard.before, i, count, picture.rgb.data());
    copy_into(shard.room, i, count, &picture.coverage[static_cast<std::size_t>(StarterPart::Object) * cells]);
}

void write(const Shard& shard, const ShardRange& range, const std::filesystem::path& path) {
    std::ofstream stream(path, std::ios::binary);
    const auto put = [&](const auto& values) {
        stream.write(reinterpret_cast<const char*>(values.data()),
                     static_cast<std::streamsize>(values.size() * sizeof(values[0])));
    };
    put(std::vector<std::int32_t>{ShardMagic, static_cast<std::int32_t>(range.count), range.size,
                                  range.size / LatentCell, range.wordings, ShardWords});
    for (const auto* bytes : {&shard.after, &shard.before, &shard.coverage, &shard.room, &shard.outline,
                              &shard.words, &shard.restyled})
        put(*bytes);
    put(shard.cameras);
    put(shard.next_share);
    put(shard.fronts);
    if (!stream.flush()) throw Error(ErrorCode::Unwritable, "the pictures cannot be written", "", path);
}

}  // namespace

void write_picture_shard(const StarterSource& source, const ShardRange& range,
                         const std::filesystem::path& path, ThreadPool& pool) {
    if (source.before() == nullptr || !source.has_outlines())
        throw Error(ErrorCode::InvalidArgument,
                    "the picture source has no pictures of before, or no outlines");
    Shard shard = empty_shard(range);
    const WordPlaces places(source.vocabulary());
    const auto views = static_cast<std::size_t>(source.views_of_scene());
    pool.parallel_for(static_cast<std::size_t>(range.count), views,
                      [&](std::size_t begin, std::size_t end, unsigned) {
                          for (std::size_t i = begin; i < end; ++i) draw(source, range, places, i, shard);
                          for (std::size_t i = begin; i < end; ++i)
                              draw_before(*source.before(), range, i, shard);
                      });
    write_atomically(path, [&](const std::filesystem::path& temporary) { write(shard, range, temporary); });
}

void write_picture_shards(const StarterTrainParameters& parameters, const std::filesystem::path& folder,
                          const JobControl& job, std::uint64_t per_file) {
    const auto source = make_shape_source(
        parameters.seed, {parameters.restyled_share, parameters.more_share, parameters.more_looks});
    const auto views = static_cast<std::uint64_t>(source->views_of_scene()),
               count = static_cast<std::uint64_t>(parameters.pictures);
    const std::uint64_t each = std::max<std::uint64_t>(1, (per_file + views - 1) / views) * views,
                        files = (count + each - 1) / each;
    auto words = source->vocabulary();
    words.emplace_back(",");
    write_file(folder / "vocabulary.json", nlohmann::json(words).dump() + "\n");
    ThreadPool pool(static_cast<unsigned>(parameters.threads));
    for (std::uint64_t file = 0; file < files; ++file) {
        if (job.stop_requested())
            throw Error(ErrorCode::Cancelled, "stopped while drawing the training pictures");
        const auto path = folder / fmt::format("shard-{}.bin", file);
        ShardRange range;
        range.first = file * each;
        range.count = each;
        range.size = parameters.image_size;
        if (!std::filesystem::exists(path)) write_picture_shard(*source, range, path, pool);
        job.report("drawing pictures", static_cast<int>(file + 1), static_cast<int>(files));
    }
}

}  // namespace gse::training
