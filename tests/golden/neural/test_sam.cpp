// SAM and MobileSAM against their references: both namings, both containers, every block, seven kinds of
// prompts.
#include <algorithm>

#include "engine/base/error.h"
#include "engine/neural/layers/images.h"
#include "engine/neural/sam/sam_model.h"
#include "engine/neural/sam/sam_segmenter.h"
#include "engine/neural/weights/torch_file.h"
#include "tests/golden/neural/golden_case.h"

namespace gse::test {
namespace {

using namespace gse::neural;

constexpr std::int64_t TinyImageSize = 128;  // of the references' small networks

// sam/README.md and mobile_sam/README.md.
constexpr double SamTolerance = 2e-5;
constexpr double MobileEncoderRelative = 1e-4, MobileDecoderTolerance = 5e-5;
// Where the reference's logit is so small that rounding decides.
constexpr double UndecidedLogit = 1e-3;
// A resized picture is off by one step of 1/255 where rounding falls the other way.
constexpr double OneStep = 1.01;
constexpr double RoundedShare = 0.01;  // of its pixels, at most

struct Prompt {
    const char* name;
    bool several;
};
constexpr Prompt Prompts[] = {
    {"point", true}, {"two_points_single", false}, {"box", false},        {"box_point", true},
    {"none", true},  {"point_mask_input", true},   {"batch_boxes", false}};

/// The prompt of that name, in pixels of the encoder's picture as the reference scales them.
SamPrompts prompts_of(const SafetensorsFile& io, const std::string& name, const SamScale& to) {
    SamPrompts prompts;
    const auto scale = torch::tensor({to.x, to.y}, torch::kFloat32);
    const bool with_mask = name == "point_mask_input";
    const std::string clicks = with_mask && !io.contains(name + ".point_coords") ? "point" : name;
    if (io.contains(clicks + ".point_coords")) {
        prompts.points = (io.tensor(clicks + ".point_coords") * scale).unsqueeze(0);
        prompts.labels = io.tensor(clicks + ".point_labels").unsqueeze(0);
    }
    if (io.contains(name + ".box"))
        prompts.boxes = (io.tensor(name + ".box").view({2, 2}) * scale).view({1, 4});
    if (io.contains(name + ".boxes"))
        prompts.boxes = (io.tensor(name + ".boxes").view({-1, 2, 2}) * scale).view({-1, 4});
    if (with_mask) prompts.mask = io.tensor(name + ".mask_input");
    return prompts;
}

void check_prompts(const SafetensorsFile& io, const SamModel& model, Margins& margins, double tolerance) {
    const auto picture = io.tensor("image_u8_hwc");
    const auto scale = model->scale(picture.size(0), picture.size(1));
    for (const auto& [name, several] : Prompts) {
        const std::string prefix = std::string(name) + ".";
        const auto encoded = model->encode(prompts_of(io, name, scale));
        if (io.contains(prefix + "sparse_embeddings"))
            margins.near(prefix + "sparse", encoded.sparse, io.tensor(prefix + "sparse_embeddings"),
                         tolerance);
        if (io.contains(prefix + "dense_embeddings"))
            margins.near(prefix + "dense", encoded.dense.contiguous(), io.tensor(prefix + "dense_embeddings"),
                         tolerance);
        const auto masks = model->masks(io.tensor("image_embeddings"), encoded, several);
        margins.near(prefix + "logits", masks.logits, io.tensor(prefix + "low_res_masks"), tolerance);
        margins.near(prefix + "iou", masks.iou, io.tensor(prefix + "iou_predictions"), tolerance);
        if (io.contains(prefix + "upsampled_logits"))
            margins.near(prefix + "upsampled",
                         model->enlarge(masks.logits.narrow(1, 0, 1), picture.size(0), picture.size(1)),
                         io.tensor(prefix + "upsampled_logits"), tolerance);
        if (!io.contains(prefix + "masks")) continue;
        const auto large = model->enlarge(masks.logits, picture.size(0), picture.size(1)).squeeze(0);
        const auto differs = (large > 0) != (io.tensor(prefix + "masks") != 0);
        DOCTEST_CHECK_MESSAGE((differs & (large.abs() >= UndecidedLogit)).sum().item<std::int64_t>() == 0,
                              name);
    }
}

/// The embedding and all layers that the reference has; returns how many.
template <class Near>
std::size_t compare_encoder(const SafetensorsFile& io, const SamModel& model, const Near& near) {
    SamTrace trace;
    near("embedding", model->embed(io.tensor("preprocessed"), &trace), io.tensor("image_embeddings"));
    std::size_t compared = 0;
    for (const auto& [layer, output] : trace)
        if (io.contains(layer)) near(layer, output, io.tensor(layer)), ++compared;
    return compared;
}

void check_pixels(const SafetensorsFile& io, const SamModel& model) {
    const auto picture = io.tensor("image_u8_hwc").permute({2, 0, 1}).unsqueeze(0).to(torch::kFloat32) / 255;
    const auto off = (model->pixels(picture) - io.tensor("preprocessed")).abs() * 57;  // in steps, about
    DOCTEST_CHECK(off.max().item<double>() <= OneStep);
    DOCTEST_CHECK((off > 0.01).to(torch::kFloat32).mean().item<double>() < RoundedShare);
}

/// The segmenter of the search gives what the model gives.
void check_segmenter(const std::filesystem::path& weights, const SafetensorsFile& io) {
    const auto segmenter = load_sam_segmenter(weights, "cpu");
    const auto picture = io.tensor("image_u8_hwc").permute({2, 0, 1}).unsqueeze(0).to(torch::kFloat32) / 255;
    const auto box = io.tensor("box.box");
    const auto corner = [&](int i) {
        return static_cast<double>(box[i].item<float>()) + 0.5 * picture.size(3) / TinyImageSize;
    };
    const auto mask = segmenter->segment(to_image(picture), {},
                                         edit::BoxPrompt{corner(0), corner(1), corner(2), corner(3)}, {});
    const auto expected = (io.tensor("box.masks")[0] != 0).contiguous();
    std::size_t differing = 0;
    for (std::size_t i = 0; i < mask.data.size(); ++i)
        differing += (mask.data[i] != 0) != expected.data_ptr<bool>()[i] ? 1u : 0u;
    DOCTEST_CHECK(static_cast<double>(differing) <= RoundedShare * static_cast<double>(mask.data.size()));
    DOCTEST_CHECK(segmenter->trusted());
    DOCTEST_CHECK(segmenter->segment(to_image(picture), {}, std::nullopt, {}).count() == 0);
}

void check_sam(const std::filesystem::path& weights, const SafetensorsFile& io, const std::string& name) {
    const torch::NoGradGuard no_grad;
    const auto model = load_sam(weights, torch::kCPU);
    DOCTEST_CHECK(model->shape().image_size() == TinyImageSize);
    Margins margins(name);
    const auto near = [&](const std::string& what, const torch::Tensor& actual,
                          const torch::Tensor& expected) {
        margins.near(what, actual, expected, SamTolerance);
    };
    DOCTEST_CHECK(compare_encoder(io, model, near) >= 5);  // positions and four blocks
    margins.near("positions", model->dense_positions(), io.tensor("dense_pe"), SamTolerance);
    check_prompts(io, model, margins, SamTolerance);
    check_pixels(io, model);
}

}  // namespace

DOCTEST_TEST_CASE("sam: names of segment-anything, safetensors and torch.save") {
    const GoldenCase golden("sam");
    if (!golden.present) return;
    const auto io = golden.tensors();
    check_sam(golden.folder / "sam_original.safetensors", io, "sam");
    check_sam(golden.folder / "sam_original.pth", io, "sam .pth");
    check_segmenter(golden.folder / "sam_original.pth", io);
}

DOCTEST_TEST_CASE("sam_hf: names of transformers, a folder") {
    const GoldenCase golden("sam_hf"), original("sam");
    if (!golden.present || !original.present) return;
    check_sam(golden.folder, original.tensors(), "sam_hf");
}

DOCTEST_TEST_CASE("mobile_sam: safetensors and torch.save") {
    const GoldenCase golden("mobile_sam");
    if (!golden.present) return;
    const torch::NoGradGuard no_grad;
    const auto io = golden.tensors();
    for (const char* file : {"mobile_sam.safetensors", "mobile_sam.pt"}) {
        const auto model = load_sam(golden.folder / file, torch::kCPU, TinyImageSize);
        DOCTEST_CHECK(model->shape().name == "MobileSAM");
        Margins margins(file);
        const auto near = [&](const std::string& what, const torch::Tensor& actual,
                              const torch::Tensor& expected) {
            margins.near_relative(what, actual, expected, MobileEncoderRelative);
        };
        DOCTEST_CHECK(compare_encoder(io, model, near) == 18);
        margins.near("positions", model->dense_positions(), io.tensor("dense_pe"), MobileDecoderTolerance);
        check_prompts(io, model, margins, MobileDecoderTolerance);
        check_pixels(io, model);
    }
}

DOCTEST_TEST_CASE("a file of torch.save holds what its safetensors twin holds") {
    const GoldenCase sam("sam"), mobile("mobile_sam");
    if (!sam.present || !mobile.present) return;
    for (const auto& [pickled, plain] :
         {std::pair{sam.folder / "sam_original.pth", sam.folder / "sam_original.safetensors"},
          std::pair{mobile.folder / "mobile_sam.pt", mobile.folder / "mobile_sam.safetensors"}}) {
        const TorchFile file(pickled);
        const SafetensorsFile twin(plain);
        DOCTEST_CHECK(file.shapes() == twin.shapes());
        for (const auto& [name, shape] : twin.shapes())
            DOCTEST_CHECK_MESSAGE(torch::equal(file.tensor(name), twin.tensor(name)), name);
    }
}

DOCTEST_TEST_CASE("manifests: names and shapes of the published weights") {
    const GoldenCase golden("manifests");
    if (!golden.present) return;
    struct Published {
        const char* manifest;
        const char* name;
        std::int64_t heads, inner;
    };
    for (const auto& [manifest, name, heads, depth] :
         {Published{"sam_vit_b_original.tsv", "SAM ViT-B", 12, 12},
          Published{"sam_vit_b_transformers.tsv", "SAM ViT-B", 12, 12},
          Published{"sam_vit_l_original.tsv", "SAM ViT-L", 16, 24},
          Published{"sam_vit_l_transformers.tsv", "SAM ViT-L", 16, 24},
          Published{"sam_vit_h_original.tsv", "SAM ViT-H", 16, 32},
          Published{"sam_vit_h_transformers.tsv", "SAM ViT-H", 16, 32},
          Published{"mobile_sam_original.tsv", "MobileSAM", 10, 2}}) {
        DOCTEST_INFO(manifest);
        const auto shapes = read_manifest(golden.folder / manifest);
        const auto plan = sam_plan(shapes);
        const auto shape = infer_sam_shape(shapes, plan, golden.folder / manifest);
        DOCTEST_CHECK(shape.name == name);
        DOCTEST_CHECK(shape.image_size() == 1024);
        if (const auto* vit = std::get_if<SamVitShape>(&shape.encoder)) {
            DOCTEST_CHECK(vit->heads == heads);
            DOCTEST_CHECK(static_cast<std::int64_t>(vit->windows.size()) == depth);
            DOCTEST_CHECK(std::count(vit->windows.begin(), vit->windows.end(), 64) == 4);  // see everything
            DOCTEST_CHECK(std::count(vit->windows.begin(), vit->windows.end(), 14) == depth - 4);
        } else {
            const auto& tiny = std::get<TinyVitShape>(shape.encoder);
            DOCTEST_CHECK(tiny.heads[3] == heads);
            DOCTEST_CHECK(tiny.windows == std::array<std::int64_t, 4>{7, 7, 14, 7});
        }
        check_weights(*SamModel(shape, WeightOptions{torch::kMeta, torch::kFloat32, false}), shapes, plan,
                      golden.folder / manifest);
    }
}

}  // namespace gse::test
