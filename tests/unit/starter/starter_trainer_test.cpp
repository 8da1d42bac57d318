// The starter's trainer on a toy world: it learns, resumes to the same bits, and writes a folder that can be
// read.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <atomic>
#include <fstream>
#include <sstream>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/json.h"
#include "engine/base/random.h"
#include "engine/laboratory/starter/starter_data.h"
#include "engine/laboratory/starter/starter_trainer.h"
#include "engine/neural/api/config.h"
#include "engine/neural/weights/safetensors.h"
#include "tests/test_paths.h"

namespace {

using namespace gse::neural;
using namespace gse::training;

const char* const ToyColours[] = {"red", "green", "blue"};

/// Pairs of squares at one place in two colours.
class ToyPairs : public ContrastivePairs {
public:
    StarterPicture picture(std::uint64_t index, int size) const override {
        const int cells = size / 4, colour = colour_of(index);
        gse::Random random = gse::Random::stream(6, index / 2);
        const int x0 = static_cast<int>(random.below(static_cast<std::uint64_t>(size / 2)));
        const int y0 = static_cast<int>(random.below(static_cast<std::uint64_t>(size / 2)));
        StarterPicture picture;
        picture.rgb.assign(static_cast<std::size_t>(size * size * 3), 40);
        picture.coverage.assign(static_cast<std::size_t>(3 * cells * cells), 0);
        for (int y = y0; y < y0 + size / 2; ++y)
            for (int x = x0; x < x0 + size / 2; ++x)
                picture.rgb[static_cast<std::size_t>((y * size + x) * 3 + colour)] = 230;
        return picture;
    }
    StarterCaption caption(std::uint64_t index, std::uint64_t seed, bool) const override {
        return {claim(index, seed, true).text, {}};
    }
    std::vector<std::string> vocabulary() const override { return {"a", "red", "green", "blue", "square"}; }
    std::string identity() const override { return "toy twins"; }
    int group_size() const override { return 2; }
    std::uint64_t facts(std::uint64_t index) const override { return std::uint64_t{1} << colour_of(index); }
    StarterClaim claim(std::uint64_t index, std::uint64_t, bool) const override {
        return {std::string("a ") + ToyColours[colour_of(index)] + " square", facts(index)};
    }
    std::vector<std::string> false_claims(std::uint64_t index, std::uint64_t, bool) const override {
        return {std::string("a ") + ToyColours[(colour_of(index) + 1) % 3] + " square"};
    }

private:
    static int colour_of(std::uint64_t index) {
        const auto first = gse::Random::stream(7, index / 2).below(3);
        return static_cast<int>((first + index % 2) % 3);
    }
};

/// Coloured squares on grey.
class ToySource : public StarterSource {
public:
    const ContrastivePairs* contrastive_pairs() const override { return &pairs_; }
    StarterPicture picture(std::uint64_t index, int size) const override {
        const Layout layout(index, size);
        StarterPicture picture;
        picture.rgb.assign(static_cast<std::size_t>(size * size * 3), 40);
        const int cells = size / 4;
        picture.coverage.assign(static_cast<std::size_t>(3 * cells * cells), 0);
        for (int y = layout.y; y < layout.y + size / 2; ++y)
            for (int x = layout.x; x < layout.x + size / 2; ++x) {
                picture.rgb[static_cast<std::size_t>((y * size + x) * 3 + layout.colour)] = 230;
                picture.coverage[static_cast<std::size_t>(cells * cells + (y / 4) * cells + x / 4)] = 255;
            }
        return picture;
    }
    /// `more`: words beside those of its captions.
    explicit ToySource(std::vector<std::string> more = {}) : more_(std::move(more)) {}
    StarterCaption caption(std::uint64_t index, std::uint64_t, bool) const override {
        const std::string colour = ToyColours[Layout(index, 32).colour];
        return {"a " + colour + " square, front view",
                {{colour, 0, StarterPart::Object}, {"square", 0, StarterPart::Object}}};
    }
    std::vector<std::string> vocabulary() const override {
        std::vector<std::string> words{"a", "red", "green", "blue", "square", "front", "view"};
        words.insert(words.end(), more_.begin(), more_.end());
        return words;
    }
    std::string identity() const override { return "toy"; }

private:
    struct Layout {
        int colour, x, y;
        Layout(std::uint64_t index, int size) {
            gse::Random random = gse::Random::stream(5, index);
            colour = static_cast<int>(random.below(3));
            x = static_cast<int>(random.below(static_cast<std::uint64_t>(size / 8))) * 4;
            y = static_cast<int>(random.below(static_cast<std::uint64_t>(size / 8))) * 4;
        }
    };
    ToyPairs pairs_;
    std::vector<std::string> more_;
};

StarterTrainParameters toy_parameters() {
    StarterTrainParameters parameters;
    parameters.image_size = 32;
    parameters.pictures = 32;
    parameters.threads = 2;
    parameters.vae_steps = 6;
    parameters.unet_steps = 6;
    parameters.vae_batch = 2;
    parameters.unet_batch = 2;
    parameters.clip_steps = 6;
    parameters.clip_pictures = 16;
    parameters.clip_batch = 2;
    parameters.clip_width = 32;
    parameters.vae_channels = 8;
    parameters.unet_channels = 80;
    parameters.text_width = 32;
    return parameters;
}

std::vector<double> column(const std::filesystem::path& log, std::size_t index) {
    std::ifstream stream(log);
    std::string line;
    std::getline(stream, line);
    std::vector<double> values;
    while (std::getline(stream, line)) {
        std::istringstream cells(line);
        std::string cell;
        for (std::size_t i = 0; i <= index; ++i) std::getline(cells, cell, '\t');
        values.push_back(std::stod(cell));
    }
    return values;
}

}  // namespace

DOCTEST_TEST_CASE("an interrupted training run resumes to the same weights") {
    const ToySource source;
    const gse::test::ScratchFolder scratch;
    const auto straight = scratch.path() / "straight";
    train_starter(toy_parameters(), source, scratch.path() / "work1", straight, {});

    // Stopped in every stage, and started again with the same command.
    for (const std::string stage : {"vae", "unet", "clip"}) {
        std::stop_source stop;
        gse::JobControl job;
        job.stop = stop.get_token();
        job.progress = [&](std::string_view name, int step, int) {
            if (name == "training " + stage && step >= 500) stop.request_stop();
        };
        DOCTEST_CHECK_THROWS_AS(train_starter(toy_parameters(), source, scratch.path() / "work2",
                                              scratch.path() / "resumed", job),
                                gse::Error);
    }
    train_starter(toy_parameters(), source, scratch.path() / "work2", scratch.path() / "resumed", {});
    for (const char* file :
         {"vae/diffusion_pytorch_model.safetensors", "unet/diffusion_pytorch_model.safetensors",
          "text_encoder/model.safetensors", "clip/model.safetensors", "clip/config.json", "gseditpro.json",
          "tokenizer/vocab.json"})
        DOCTEST_CHECK_MESSAGE(
            gse::read_file(straight / file) == gse::read_file(scratch.path() / "resumed" / file), file);
}

DOCTEST_TEST_CASE("a run goes on from a finished model and keeps the parts it has no time for") {
    const ToySource source;
    const gse::test::ScratchFolder scratch;
    const auto first = scratch.path() / "first";
    train_starter(toy_parameters(), source, scratch.path() / "work1", first, {});
    auto parameters = toy_parameters();
    parameters.initial = first.string();
    parameters.vae_minutes = parameters.unet_minutes = parameters.clip_minutes = 0;
    const auto unchanged = [&](const std::filesystem::path& folder, const char* file) {
        return gse::read_file(first / file) == gse::read_file(folder / file);
    };

    parameters.vae_steps = parameters.unet_steps = parameters.clip_steps = 0;
    train_starter(parameters, source, scratch.path() / "work2", scratch.path() / "kept", {});
    for (const char* file : {"vae/diffusion_pytorch_model.safetensors", "vae/config.json", "unet/config.json",
                             "unet/diffusion_pytorch_model.safetensors", "text_encoder/model.safetensors",
                             "clip/model.safetensors", "clip/config.json"})
        DOCTEST_CHECK_MESSAGE(unchanged(scratch.path() / "kept", file), file);

    parameters.unet_steps = 2;
    train_starter(parameters, source, scratch.path() / "work3", scratch.path() / "tuned", {});
    DOCTEST_CHECK(unchanged(scratch.path() / "tuned", "vae/diffusion_pytorch_model.safetensors"));
    DOCTEST_CHECK(unchanged(scratch.path() / "tuned", "vae/config.json"));
    DOCTEST_CHECK(!unchanged(scratch.path() / "tuned", "unet/diffusion_pytorch_model.safetensors"));
    DOCTEST_CHECK(!unchanged(scratch.path() / "tuned", "text_encoder/model.safetensors"));

    // The image-text encoder too begins where it had come to.
    parameters.unet_steps = 0;
    parameters.clip_steps = 1;
    parameters.clip_lr = 0;
    train_starter(parameters, source, scratch.path() / "work4", scratch.path() / "same", {});
    DOCTEST_CHECK(unchanged(scratch.path() / "same", "clip/model.safetensors"));
}

DOCTEST_TEST_CASE("a run that knows more words keeps what the model before it made of the old ones") {
    const gse::test::ScratchFolder scratch;
    const auto first = scratch.path() / "first", second = scratch.path() / "second";
    auto parameters = toy_parameters();
    parameters.vae_steps = parameters.unet_steps = parameters.clip_steps = 2;
    train_starter(parameters, ToySource(), scratch.path() / "work1", first, {});
    parameters.initial = first.string();
    parameters.vae_minutes = parameters.unet_minutes = parameters.clip_minutes = 0;
    parameters.vae_steps = parameters.unet_steps = parameters.clip_steps = 0;
    train_starter(parameters, ToySource({"left", "right"}), scratch.path() / "work2", second, {});

    const auto before = read_json_file(first / "tokenizer/vocab.json"),
               now = read_json_file(second / "tokenizer/vocab.json");
    DOCTEST_CHECK(now.contains("left</w>"));
    DOCTEST_CHECK(now.size() > before.size());
    for (const char* file : {"text_encoder/model.safetensors", "clip/model.safetensors"}) {
        const SafetensorsFile a(first / file), b(second / file);
        for (const auto& [name, entry] : a.entries()) {
            if (!name.ends_with("token_embedding.weight")) {
                DOCTEST_CHECK_MESSAGE(torch::equal(a.tensor(name), b.tensor(name)), name);
                continue;
            }
            const auto rows_before = a.tensor(name), rows_now = b.tensor(name);
            for (const auto& [token, id] : before.items())
                DOCTEST_CHECK_MESSAGE(torch::equal(rows_before[id.get<std::int64_t>()],
                                                   rows_now[now.at(token).get<std::int64_t>()]),
                                      token);
        }
    }
    // What it was taught it says of itself; the first one was not.
    DOCTEST_CHECK(
        read_json_file(second / "gseditpro.json").at("profile").at("request").at("sided_view_words") ==
        Json(true));
    DOCTEST_CHECK(!read_json_file(first / "gseditpro.json").contains("profile"));

    // The other way words would be lost.
    parameters.initial = second.string();
    const auto forget = [&] {
        train_starter(parameters, ToySource(), scratch.path() / "work3", scratch.path() / "third", {});
    };
    DOCTEST_CHECK_THROWS_WITH_AS(forget(), doctest::Contains("\"right\""), gse::Error);
}

DOCTEST_TEST_CASE("what draws new things goes along while the UNet beside it stays") {
    const gse::test::ScratchFolder scratch;
    const auto folder = [&](const char* name) { return scratch.path() / name; };
    auto parameters = toy_parameters();
    parameters.vae_steps = parameters.unet_steps = parameters.clip_steps = 2;
    train_starter(parameters, ToySource(), folder("work1"), folder("first"), {});
    auto facts = read_json_file(folder("first") / "gseditpro.json");
    facts["shape_unet"] = "own";
    facts["shape_views"] = 6;
    facts["viewpoint"] = "seen";
    const std::string weights = "what draws new things", classifier = "what tells viewpoints";  // never read
    gse::write_file(folder("first") / "own/model.safetensors", weights);
    gse::write_file(folder("first") / "seen/model.safetensors", classifier);
    gse::write_file(folder("first") / "gseditpro.json", facts.dump());

    parameters.initial = folder("first").string();
    parameters.vae_steps = parameters.unet_steps = 0;  // the image-text encoder alone
    parameters.vae_minutes = parameters.unet_minutes = 0;
    train_starter(parameters, ToySource(), folder("work2"), folder("second"), {});
    facts = read_json_file(folder("second") / "gseditpro.json");
    DOCTEST_CHECK((facts.at("shape_unet") == "own" && facts.at("shape_views") == 6));
    DOCTEST_CHECK(gse::read_file(folder("second") / "own/model.safetensors") == weights);
    parameters.unet_steps = 1;  // another UNet beside it
    train_starter(parameters, ToySource(), folder("work3"), folder("third"), {});
    DOCTEST_CHECK(!read_json_file(folder("third") / "gseditpro.json").contains("shape_unet"));
    for (const char* name : {"second", "third"}) {
        DOCTEST_CHECK(read_json_file(folder(name) / "gseditpro.json").at("viewpoint") == "seen");
        DOCTEST_CHECK(gse::read_file(folder(name) / "seen/model.safetensors") == classifier);
    }
}

DOCTEST_TEST_CASE(
    "the upscaler resumes to the same weights, and comes nearer to the truth than enlargement") {
    const ToySource source;
    const gse::test::ScratchFolder scratch;
    const auto folder = [&](const char* name) { return scratch.path() / name; };
    auto parameters = toy_parameters();
    parameters.threads = 1;
    parameters.clip_steps = parameters.vae_steps = parameters.unet_steps = 0;
    parameters.clip_minutes = parameters.vae_minutes = parameters.unet_minutes = 0;
    auto first = toy_parameters();
    first.clip_minutes = first.clip_steps = 0;
    train_starter(first, source, folder("work1"), folder("first"), {});
    DOCTEST_CHECK_FALSE(read_json_file(folder("first") / "gseditpro.json").contains("upscaler"));

    parameters.initial = folder("first").string();
    parameters.upscaler_pictures = 8;
    parameters.upscaler_batch = 4;
    parameters.upscaler_steps = 100;
    train_starter(parameters, source, folder("work2"), folder("straight"), {});
    DOCTEST_CHECK(read_json_file(folder("straight") / "gseditpro.json").at("upscaler") == "upscaler");
    const auto shown = column(folder("work2") / "upscaler.tsv", 5),
               enlarged = column(folder("work2") / "upscaler.tsv", 6);
    DOCTEST_REQUIRE(shown.size() == 2);
    DOCTEST_CHECK(shown.back() > enlarged.back());

    std::stop_source stop;
    gse::JobControl job;
    job.stop = stop.get_token();
    job.progress = [&](std::string_view name, int step, int) {
        if (name == "training upscaler" && step >= 500) stop.request_stop();
    };
    DOCTEST_CHECK_THROWS_AS(train_starter(parameters, source, folder("work3"), folder("resumed"), job),
                            gse::Error);
    train_starter(parameters, source, folder("work3"), folder("resumed"), {});
    DOCTEST_CHECK(gse::read_file(folder("straight") / "upscaler/model.safetensors") ==
                  gse::read_file(folder("resumed") / "upscaler/model.safetensors"));

    // It goes along while the VAE stays, whose pictures it knows.
    parameters.initial = folder("straight").string();
    parameters.upscaler_steps = 0;
    train_starter(parameters, source, folder("work4"), folder("kept"), {});
    DOCTEST_CHECK(read_json_file(folder("kept") / "gseditpro.json").at("upscaler") == "upscaler");
    DOCTEST_CHECK(gse::read_file(folder("straight") / "upscaler/model.safetensors") ==
                  gse::read_file(folder("kept") / "upscaler/model.safetensors"));
    parameters.vae_steps = 1;
    train_starter(parameters, source, folder("work5"), folder("other"), {});
    DOCTEST_CHECK_FALSE(read_json_file(folder("other") / "gseditpro.json").contains("upscaler"));
}

DOCTEST_TEST_CASE("mixed precision trains nearly as float does, and is not the same") {
    const ToySource source;
    const gse::test::ScratchFolder scratch;
    auto parameters = toy_parameters();
    parameters.clip_minutes = 0;
    parameters.clip_steps = 1;
    train_starter(parameters, source, scratch.path() / "float", scratch.path() / "out1", {});
    parameters.bf16 = true;
    train_starter(parameters, source, scratch.path() / "mixed", scratch.path() / "out2", {});
    const auto single = column(scratch.path() / "float/unet.tsv", 4),
               mixed = column(scratch.path() / "mixed/unet.tsv", 4);
    DOCTEST_REQUIRE(single.size() == mixed.size());
    // bfloat16 has 8 bits; products of hundreds of them are summed in float.
    constexpr double EightBits = 1.0 / 64;
    for (std::size_t i = 0; i < single.size(); ++i) {
        DOCTEST_CHECK(mixed[i] == doctest::Approx(single[i]).epsilon(EightBits));
        DOCTEST_CHECK(mixed[i] != single[i]);
    }
}

DOCTEST_TEST_CASE("two models trained from one another are averaged, weight by weight") {
    const ToySource source;
    const gse::test::ScratchFolder scratch;
    const auto first = scratch.path() / "first", second = scratch.path() / "second",
               mean = scratch.path() / "mean";
    auto parameters = toy_parameters();
    parameters.vae_steps = parameters.unet_steps = parameters.clip_steps = 2;
    train_starter(parameters, source, scratch.path() / "work1", first, {});
    parameters.initial = first.string();
    parameters.vae_minutes = parameters.unet_minutes = parameters.clip_minutes = 0;
    parameters.vae_steps = parameters.clip_steps = 0;
    train_starter(parameters, source, scratch.path() / "work2", second, {});

    parameters.unet_steps = 0;
    parameters.average = second.string();
    train_starter(parameters, source, scratch.path() / "work3", mean, {});
    constexpr double half_precision = 1e-3;  // weights are stored as 16-bit floats
    for (const char* file : {"unet/diffusion_pytorch_model.safetensors", "text_encoder/model.safetensors"}) {
        const SafetensorsFile a(first / file), b(second / file), c(mean / file);
        for (const auto& [name, entry] : c.entries()) {
            if (!at::isFloatingType(entry.dtype)) continue;
            const auto expected =
                (a.tensor(name).to(torch::kFloat64) + b.tensor(name).to(torch::kFloat64)) / 2;
            DOCTEST_CHECK_MESSAGE(
                torch::allclose(c.tensor(name).to(torch::kFloat64), expected, half_precision, 1e-6), name);
        }
        for (const auto& one : {first, second})
            DOCTEST_CHECK(gse::read_file(one / file) != gse::read_file(mean / file));
    }

    parameters.initial.clear();
    const auto train = [&] {
        train_starter(parameters, source, scratch.path() / "work4", scratch.path() / "none", {});
    };
    parameters.vae_steps = parameters.unet_steps = 1;
    DOCTEST_CHECK_THROWS_WITH_AS(train(), doctest::Contains("average"), gse::Error);
    const auto other = scratch.path() / "other";
    auto stranger = toy_parameters();
    stranger.seed = 9;
    stranger.vae_steps = stranger.unet_steps = stranger.clip_steps = 1;
    train_starter(stranger, source, scratch.path() / "work5", other, {});
    parameters.initial = first.string();
    parameters.average = other.string();
    parameters.vae_steps = parameters.unet_steps = 0;
    DOCTEST_CHECK_THROWS_WITH_AS(train(), doctest::Contains("another VAE"), gse::Error);
}

DOCTEST_TEST_CASE("an initial model of another structure is refused before any work") {
    const ToySource source;
    const gse::test::ScratchFolder scratch;
    auto parameters = toy_parameters();
    parameters.vae_steps = parameters.unet_steps = parameters.clip_steps = 1;
    train_starter(parameters, source, scratch.path() / "work1", scratch.path() / "first", {});
    parameters.initial = (scratch.path() / "first").string();
    parameters.unet_channels = 160;
    const auto train = [&] {
        train_starter(parameters, source, scratch.path() / "work2", scratch.path() / "second", {});
    };
    DOCTEST_CHECK_THROWS_WITH_AS(train(), doctest::Contains("attention_head_dim"), gse::Error);
    parameters.unet_channels = toy_parameters().unet_channels;
    parameters.initial = (scratch.path() / "nowhere").string();
    DOCTEST_CHECK_THROWS_AS(train(), gse::Error);
    parameters.initial.clear();
    parameters.vae_steps = 0;
    parameters.vae_minutes = 0;
    DOCTEST_CHECK_THROWS_WITH_AS(train(), doctest::Contains("untrained"), gse::Error);
    DOCTEST_CHECK(!std::filesystem::exists(scratch.path() / "work2"));
}

DOCTEST_TEST_CASE("training lowers every loss on the toy world") {
    const ToySource source;
    const gse::test::ScratchFolder scratch;
    auto parameters = toy_parameters();
    parameters.vae_steps = 100;
    parameters.unet_steps = 80;
    parameters.vae_batch = parameters.unet_batch = 4;
    parameters.clip_steps = 70;
    parameters.clip_batch = 8;
    train_starter(parameters, source, scratch.path() / "work", scratch.path() / "model", {});
    const auto vae = column(scratch.path() / "work/vae.tsv", 4);
    DOCTEST_CHECK(vae.back() < vae.front());
    for (const std::size_t loss : {5u, 6u}) {  // diffusion, place
        const auto values = column(scratch.path() / "work/unet.tsv", loss);
        DOCTEST_CHECK(values.back() < 0.8 * values.front());
    }
    const auto clip = scratch.path() / "work/clip.tsv";
    DOCTEST_CHECK(column(clip, 5).back() < column(clip, 5).front());  // contrast
    DOCTEST_CHECK(column(clip, 7).back() > 0.5);                      // direction
    DOCTEST_CHECK(column(clip, 8).back() > 0.8);  // a sentence told from the same with another word
}

DOCTEST_TEST_CASE("every word of a vocabulary becomes one token") {
    const auto vocabulary =
        build_vocabulary({"bear", "beard", "ear", "a", "golden", "gold", "old", "wearing"});
    const auto json = nlohmann::json::parse(vocabulary.vocab_json);
    for (const char* word :
         {"bear</w>", "beard</w>", "ear</w>", "a</w>", "golden</w>", "gold</w>", "old</w>"})
        DOCTEST_CHECK_MESSAGE(json.contains(word), word);
    DOCTEST_CHECK(static_cast<int>(json.size()) == vocabulary.size);
    DOCTEST_CHECK(json["<|endoftext|>"] == vocabulary.eos);
}
