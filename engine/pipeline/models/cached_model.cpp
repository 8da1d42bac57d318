// Questions as text, answers as bytes.
#include "engine/pipeline/models/cached_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <iterator>
#include <map>
#include <utility>

#include "engine/base/clock.h"
#include "engine/base/content_hash.h"
#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/json.h"
#include "engine/base/leftover.h"
#include "engine/base/log.h"
#include "engine/base/process_memory.h"
#include "engine/pipeline/models/neural_loader.h"
#include "engine/pipeline/models/tuning_json.h"

namespace gse::pipeline {
namespace {

template <class T> void put(std::string& bytes, const T& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// Takes a value off the front; false where there are too few bytes.
template <class T> bool take(std::string_view& bytes, T& value) {
    if (bytes.size() < sizeof value) return false;
    std::memcpy(&value, bytes.data(), sizeof value);
    bytes.remove_prefix(sizeof value);
    return true;
}

std::string bytes_of(const std::vector<float>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)};
}

std::vector<float> floats_in(std::string_view bytes) {
    std::vector<float> values(bytes.size() / sizeof(float));
    std::memcpy(values.data(), bytes.data(), values.size() * sizeof(float));
    return values;
}

bool finite(const std::vector<float>& values) {
    return std::all_of(values.begin(), values.end(), [](float value) { return std::isfinite(value); });
}

/// Width, height, channels and values of each.
std::string bytes_of(const std::vector<Image>& images) {
    std::string bytes;
    for (const auto& image : images) {
        for (const std::int32_t size : {image.width, image.height, image.channels}) put(bytes, size);
        bytes.append(reinterpret_cast<const char*>(image.data.data()), image.data.size() * sizeof(float));
    }
    return bytes;
}

/// Exactly `count` images; nothing where the bytes are something else.
std::optional<std::vector<Image>> images_in(std::string_view bytes, std::size_t count) {
    constexpr std::int32_t most_side = 1 << 14, most_channels = 16;
    std::vector<Image> images;
    while (images.size() < count) {
        std::int32_t width = 0, height = 0, channels = 0;
        if (!take(bytes, width) || !take(bytes, height) || !take(bytes, channels)) return std::nullopt;
        if (std::min({width, height, channels}) < 0 || std::max(width, height) > most_side ||
            channels > most_channels)
            return std::nullopt;
        const auto size = std::size_t{sizeof(float)} * static_cast<std::size_t>(width) *
                          static_cast<std::size_t>(height) * static_cast<std::size_t>(channels);
        if (bytes.size() < size) return std::nullopt;
        images.emplace_back(width, height, channels);
        std::memcpy(images.back().data.data(), bytes.data(), size);
        bytes.remove_prefix(size);
    }
    return bytes.empty() ? std::optional(std::move(images)) : std::nullopt;
}

/// Pictures, changes and outlines behind the number of each; nothing where a value is not finite.
std::optional<std::string> bytes_of(const edit::EditedViews& targets) {
    std::string bytes, images;
    for (const auto* list : {&targets.images, &targets.changes, &targets.outlines}) {
        if (!std::all_of(list->begin(), list->end(), [](const Image& image) { return finite(image.data); }))
            return std::nullopt;
        put(bytes, static_cast<std::uint32_t>(list->size()));
        images += bytes_of(*list);
    }
    return bytes + images;
}

/// Edited views of a round of so many views; nothing where the bytes are something else.
std::optional<edit::EditedViews> targets_in(std::string_view bytes, std::size_t views) {
    std::array<std::uint32_t, 3> counts{};
    for (auto& count : counts)
        if (!take(bytes, count) || (count != views && count != 0)) return std::nullopt;
    auto images = images_in(bytes, std::size_t{counts[0]} + counts[1] + counts[2]);
    if (!images || counts[0] != views) return std::nullopt;
    edit::EditedViews targets;
    auto next = std::make_move_iterator(images->begin());
    for (std::size_t i = 0; auto* list : {&targets.images, &targets.changes, &targets.outlines}) {
        const auto end = next + counts[i++];
        list->assign(next, end);
        next = end;
    }
    return targets;
}

/// A file of a library that reads and writes by name; gone when this is.
class ScratchFile {
public:
    ScratchFile()
        : path_(std::filesystem::temp_directory_path() / ("gseditpro-" + writer_mark() + ".safetensors")) {}
    ~ScratchFile() {
        std::error_code ignored;
        std::filesystem::remove(path_, ignored);
    }
    ScratchFile(const ScratchFile&) = delete;
    ScratchFile& operator=(const ScratchFile&) = delete;
    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

/// Text-image vectors: pictures one by one, sentences (a hundred short ones per word) in one entry that
/// grows.
class CachedEncoder final : public edit::ImageTextEncoder {
public:
    explicit CachedEncoder(std::shared_ptr<const CachedModel> model) : model_(std::move(model)) {
        const auto kept = model_->cache().find(sentences_question());
        std::string_view bytes = kept ? std::string_view(*kept) : std::string_view();
        std::uint32_t length = 0, count = 0;
        while (take(bytes, length) && take(bytes, count) &&
               bytes.size() >= length + std::size_t{count} * sizeof(float)) {
            known_[std::string(bytes.substr(0, length))] =
                floats_in(bytes.substr(length, count * sizeof(float)));
            bytes.remove_prefix(length + count * sizeof(float));
        }
    }
    ~CachedEncoder() override { keep_sentences(); }
    CachedEncoder(const CachedEncoder&) = delete;
    CachedEncoder& operator=(const CachedEncoder&) = delete;

    std::vector<float> image(const Image& image) override {
        keep_sentences();  // those asked about the picture before
        const auto question = model_->question("vector of a picture", key_of(image).hex());
        if (const auto answer = model_->cache().find(question))
            return count_cached_answer(), floats_in(*answer);
        auto vector = score().image(image);
        if (finite(vector)) model_->cache().keep(question, bytes_of(vector));
        return vector;
    }
    std::vector<float> viewpoint(const Image& image) override {
        const auto question = model_->question("viewpoint of a picture", key_of(image).hex());
        if (const auto answer = model_->cache().find(question))
            return count_cached_answer(), floats_in(*answer);
        auto shares = score().viewpoint(image);
        if (finite(shares)) model_->cache().keep(question, bytes_of(shares));
        return shares;
    }
    std::vector<float> text(const std::string& sentence) override {
        const auto known = known_.find(sentence);
        if (known != known_.end()) return known->second;
        auto vector = score().text(sentence);
        if (finite(vector)) known_[sentence] = vector, changed_ = true;
        return vector;
    }

private:
    static constexpr std::size_t MostSentenceBytes = std::size_t{4} << 20;

    std::string sentences_question() const { return model_->question("vectors of sentences", ""); }

    void keep_sentences() {
        if (!std::exchange(changed_, false)) return;
        std::string bytes;
        for (const auto& [sentence, vector] : known_) {
            put(bytes, static_cast<std::uint32_t>(sentence.size()));
            put(bytes, static_cast<std::uint32_t>(vector.size()));
            bytes += sentence + bytes_of(vector);
        }
        if (bytes.size() > MostSentenceBytes) return known_.clear();  // begins anew
        model_->cache().keep(sentences_question(), bytes);
    }

    edit::ImageTextEncoder& score() {
        if (!score_) score_ = model_->real().image_text_encoder();
        if (!score_)  // it was there when the facts were kept
            throw Error(ErrorCode::NotFound,
                        fmt::format("the picture encoder of the model \"{}\" is gone", model_->name()),
                        "put its folder \"clip\" back, or choose the model once more");
        return *score_;
    }

    std::shared_ptr<const CachedModel> model_;
    std::unique_ptr<edit::ImageTextEncoder> score_;  // when it is needed
    std::map<std::string, std::vector<float>> known_;
    bool changed_ = false;
};

/// The cache as the networks see it: questions are about this model.
class ModelCache final : public AnswerCache {
public:
    ModelCache(DiskCache& cache, std::string about) : cache_(cache), about_(std::move(about)) {}
    std::optional<std::string> find(std::string_view question) override {
        return cache_.find(about_ + std::string(question));
    }
    void keep(std::string_view question, std::string_view answer) override {
        cache_.keep(about_ + std::string(question), answer);
    }

private:
    DiskCache& cache_;
    const std::string about_;
};

std::string question_of(const edit::AttentionQuery& query, const neural::AttentionParameters& parameters) {
    ContentHash hash;
    hash.fields(parameters);
    hash.text(query.prompt);
    hash.texts(query.words);
    hash.text(query.view_words);
    hash.numbers(query.absent, query.repeats, query.seed);
    hash.image(query.image);
    return hash.key().hex();
}

void add_view(ContentHash& hash, const edit::EditView& view) {
    for (const auto* image :
         {&view.rendered, &view.original, &view.depth, &view.clean_plate.picture, &view.clean_plate.depth})
        hash.image(*image);
    hash.bytes(view.mask.data.data(), view.mask.data.size());
    const auto& camera = view.view.camera;
    hash.numbers(camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy);
    for (int i = 0; i < 9; ++i) hash.numbers(camera.rotation(i / 3, i % 3));
    hash.numbers(camera.translation.x, camera.translation.y, camera.translation.z);
    hash.numbers(view.elevation, view.azimuth.has_value(), view.azimuth.value_or(0));
    hash.text(view.view_words);
}

/// Key of everything that the pictures of a round follow from.
std::string question_of(const std::vector<edit::EditView>& views, const edit::EditViewsRequest& input,
                        const std::string& prompt, const neural::SdsParameters& parameters) {
    ContentHash hash;
    hash.fields(parameters);
    hash.text(prompt);
    hash.text(input.sentence);
    hash.numbers(input.round, input.rounds, input.steps, input.strength, input.seed, input.anew,
                 input.guided_until, input.noise);
    for (const auto& view : views) add_view(hash, view);
    return hash.key().hex();
}

std::string question_of(neural::DreamBoothParameters parameters, std::span<const Image> instance,
                        const std::string& instance_prompt, const std::string& class_prompt) {
    parameters.threads = 0;  // the result is the same
    ContentHash hash;
    hash.fields(parameters);
    hash.text(instance_prompt);
    hash.text(class_prompt);
    for (const auto& image : instance) hash.image(image);
    return hash.key().hex();
}

/// A tuning as an entry: length of the report, report, weights.
std::string tuning_bytes(const neural::TuneReport& report, std::string_view weights) {
    const auto json = tuning_to_json(report).dump();
    std::string bytes;
    put(bytes, static_cast<std::uint64_t>(json.size()));
    return bytes + json + std::string(weights);
}

}  // namespace

/// Attention source that takes maps from the cache where they are kept.
class CachedAttentionSource final : public edit::AttentionSource {
public:
    CachedAttentionSource(std::shared_ptr<const CachedModel> model,
                          const neural::AttentionParameters& parameters)
        : model_(std::move(model)), parameters_(parameters) {}

    std::vector<Image> locate(const edit::AttentionQuery& query) override {
        const auto question = model_->question("attention", question_of(query, parameters_));
        if (const auto answer = model_->cache().find(question))
            if (auto maps = images_in(*answer, query.words.size()))
                return count_cached_answer(), std::move(*maps);
        if (!source_) source_ = model_->real().attention(parameters_);
        auto maps = source_->locate(query);  // the source may have prepared it
        if (std::all_of(maps.begin(), maps.end(), [](const Image& map) { return finite(map.data); }))
            model_->cache().keep(question, bytes_of(maps));
        return maps;
    }
    double threshold() const override { return model_->facts().threshold; }
    int image_size() const override { return model_->facts().attention_size; }
    void prepare(std::span<const edit::AttentionQuery> queries) override {
        std::vector<edit::AttentionQuery> unknown;
        for (const auto& query : queries)
            if (!model_->cache().find(model_->question("attention", question_of(query, parameters_))))
                unknown.push_back(query);
        if (unknown.empty()) return;
        if (!source_) source_ = model_->real().attention(parameters_);
        source_->prepare(unknown);
    }
    std::size_t at_once() const override { return source_ ? source_->at_once() : UsuallyAtOnce; }

private:
    static constexpr std::size_t UsuallyAtOnce = 8;  // the source says how many it takes once it is loaded

    std::shared_ptr<const CachedModel> model_;
    const neural::AttentionParameters parameters_;
    std::unique_ptr<edit::AttentionSource> source_;  // when it is needed
};

/// Multi-view editor that takes edited views from the cache where they are kept.
class CachedEditor final : public edit::MultiViewEditor {
public:
    CachedEditor(std::shared_ptr<const CachedModel> model, std::string prompt,
                 const neural::SdsParameters& parameters)
        : model_(std::move(model)), prompt_(std::move(prompt)), parameters_(parameters) {}

    edit::EditedViews edit(const std::vector<edit::EditView>& views, const edit::EditViewsRequest& input,
                           const JobControl& job) override {
        if (!input.keep) return drawn_by_networks(views, input, job);
        const auto question =
            model_->question("drawn views", question_of(views, input, prompt_, parameters_));
        if (const auto answer = model_->cache().find(question))
            if (auto targets = targets_in(*answer, views.size()))
                return count_cached_answer(), std::move(*targets);
        auto targets = drawn_by_networks(views, input, job);
        if (const auto bytes = bytes_of(targets)) model_->cache().keep(question, *bytes);
        return targets;
    }

    bool supports_appearance_editing() const override {
        return parameters_.restyle && model_->supports_appearance_editing();
    }

private:
    edit::EditedViews drawn_by_networks(const std::vector<edit::EditView>& views,
                                        const edit::EditViewsRequest& input, const JobControl& job) {
        if (!views_) views_ = model_->real().views(prompt_, parameters_);
        return views_->edit(views, input, job);
    }

    std::shared_ptr<const CachedModel> model_;
    const std::string prompt_;
    const neural::SdsParameters parameters_;
    std::unique_ptr<edit::MultiViewEditor> views_;  // when it is needed
};

CachedModel::CachedModel(std::shared_ptr<DiskCache> cache, std::string identity, Loader loader)
    : cache_(std::move(cache)), identity_(std::move(identity)), loaded_identity_(identity_),
      loader_(std::move(loader)) {}

const neural::TextToImage& CachedModel::real() const {
    const std::lock_guard lock(mutex_);
    if (real_) return *real_;
    const double start = wall_seconds();
    ModelLoad load;
    load.before_mb = current_rss_mb();
    real_ = loader_();  // may throw; asked again then
    loader_ = nullptr;
    load.after_mb = current_rss_mb();
    load.seconds = wall_seconds() - start;
    load_ = load;
    return *real_;
}

std::optional<ModelLoad> CachedModel::load() const {
    const std::lock_guard lock(mutex_);
    return load_;
}

std::string CachedModel::question(std::string_view kind, std::string_view text) const {
    return fmt::format("{} of {} on {} threads\n{}", kind, identity_, network_threads(), text);
}

std::optional<CachedModel::Facts> CachedModel::kept_facts() const {
    const auto answer = cache_->find("facts of " + identity_);
    const auto json = answer ? try_parse_json(*answer) : nlohmann::json();
    if (!json.is_object()) return std::nullopt;
    try {
        Facts facts;
        facts.words = json.at("words").get<std::vector<std::string>>();
        facts.generated_vocabulary = json.at("generated_vocabulary").get<std::vector<std::string>>();
        facts.image_size = json.at("image_size").get<int>();
        facts.name = json.at("name").get<std::string>();
        facts.kind = static_cast<neural::BundleKind>(json.at("kind").get<int>());
        facts.scores = json.at("scores").get<bool>();
        facts.supports_scene_conditioning = json.at("knows_scene").get<bool>();
        facts.supports_appearance_editing = json.at("restyles").get<bool>();
        facts.threshold = json.at("threshold").get<double>();
        facts.attention_size = json.at("attention_size").get<int>();
        facts.notes = json.at("notes").get<std::vector<std::string>>();
        return facts;
    } catch (const nlohmann::json::exception&) { return std::nullopt; }
}

bool CachedModel::known() const {
    const std::lock_guard lock(mutex_);
    if (!facts_) facts_ = kept_facts();
    return facts_.has_value();
}

const CachedModel::Facts& CachedModel::facts() const {
    if (known()) return *facts_;
    const auto& model = real();
    Facts facts{model.known_words(),
                model.generated_vocabulary(),
                model.image_size(),
                model.name(),
                model.kind(),
                model.image_text_encoder() != nullptr,
                model.supports_scene_conditioning(),
                model.supports_appearance_editing(),
                0.5,
                0,
                model.notes()};
    const auto attention = model.attention();
    facts.threshold = attention->threshold();
    facts.attention_size = attention->image_size();
    const nlohmann::json json{{"words", facts.words},
                              {"generated_vocabulary", facts.generated_vocabulary},
                              {"image_size", facts.image_size},
                              {"name", facts.name},
                              {"kind", facts.kind},
                              {"scores", facts.scores},
                              {"knows_scene", facts.supports_scene_conditioning},
                              {"restyles", facts.supports_appearance_editing},
                              {"threshold", facts.threshold},
                              {"attention_size", facts.attention_size},
                              {"notes", facts.notes}};
    cache_->keep("facts of " + identity_, json_text(json));
    const std::lock_guard lock(mutex_);
    if (!facts_) facts_ = std::move(facts);
    return *facts_;
}

std::unique_ptr<edit::AttentionSource> CachedModel::attention(
    const neural::AttentionParameters& parameters) const {
    return std::make_unique<CachedAttentionSource>(shared_from_this(), parameters);
}

std::unique_ptr<edit::Guidance> CachedModel::guidance(const std::string& prompt,
                                                      const neural::SdsParameters& parameters) const {
    return real().guidance(prompt, parameters);
}

std::unique_ptr<edit::MultiViewEditor> CachedModel::views(const std::string& prompt,
                                                          const neural::SdsParameters& parameters) const {
    return std::make_unique<CachedEditor>(shared_from_this(), prompt, parameters);
}

std::unique_ptr<edit::ImageTextEncoder> CachedModel::image_text_encoder() const {
    return facts().scores ? std::make_unique<CachedEncoder>(shared_from_this()) : nullptr;
}

bool CachedModel::save_tuning(const std::filesystem::path& path, std::uint64_t most_bytes) const {
    return real().save_tuning(path, most_bytes);
}

std::shared_ptr<neural::TextToImage> CachedModel::load_lora(const std::filesystem::path& path,
                                                            double strength) const {
    return real().load_lora(path, strength);
}

std::shared_ptr<CachedModel> CachedModel::tuned_model(const std::string& question, Loader loader) const {
    ContentHash hash;
    hash.text(question);
    auto model = std::make_shared<CachedModel>(cache_, hash.key().hex(), std::move(loader));
    model->loaded_identity_ = loaded_identity_;
    auto facts = this->facts();
    facts.supports_appearance_editing = false;  // a tuning changes none of the others
    model->facts_ = std::move(facts);
    return model;
}

neural::TunedModel CachedModel::tune(const neural::DreamBoothParameters& parameters,
                                     std::span<const Image> instance, const std::string& instance_prompt,
                                     const std::string& class_prompt, const JobControl& job,
                                     AnswerCache*) const {
    const auto asked = fmt::format("tuning of {} on {} threads\n{}", loaded_identity_, network_threads(),
                                   question_of(parameters, instance, instance_prompt, class_prompt));
    if (auto answer = cache_->find(asked)) {
        std::string_view bytes(*answer);
        std::uint64_t length = 0;
        if (take(bytes, length) && length <= bytes.size()) {
            if (const auto report = tuning_from_json(bytes.substr(0, length))) {
                count_cached_answer();
                auto loader = [self = shared_from_this(), weights = std::string(bytes.substr(length))] {
                    const ScratchFile file;
                    write_file(file.path(), weights);
                    return self->real().load_tuning(file.path());
                };
                return {tuned_model(asked, std::move(loader)), *report};
            }
        }
    }
    ModelCache cache(*cache_, fmt::format("{} on {} threads\n", loaded_identity_, network_threads()));
    auto tuned = real().tune(parameters, instance, instance_prompt, class_prompt, job, &cache);
    try {
        const ScratchFile file;
        if (tuned.model->save_tuning(file.path(), cache_->largest_bytes()))
            cache_->keep(asked, tuning_bytes(tuned.report, read_file(file.path())));
    } catch (const Error& error) {  // it is only not kept
        log::debug("{}", error.what());
    }
    return {tuned_model(asked, [model = std::move(tuned.model)] { return model; }), std::move(tuned.report)};
}

}  // namespace gse::pipeline
