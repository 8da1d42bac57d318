// Draws captioned pictures of the synthetic world with their part masks.
#include "engine/laboratory/training/starter_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <optional>
#include <string>

#include "engine/base/thread_pool.h"
#include "engine/laboratory/synth/synth.h"
#include "engine/laboratory/training/contrastive_pairs.h"
#include "engine/raster/rasterizer.h"

namespace gse::training {
namespace {

/// Content of one picture; a function of seed and index alone.
struct Shot {
    synth::SceneSpec spec;  // as drawn
    synth::SceneSpec twin;  // with the accessory, when `bare_twin`
    bool bare_twin = false;
    double azimuth = 0, elevation = 0, zoom = 1;
    std::array<float, 3> background{};
    double close_share = 0;  // of the picture that the accessory takes; 0 = the whole thing is in the picture
    Vec3 aside;              // of its middle, in its diagonals
    std::optional<synth::Part> restyled;  // the part that the edit gives another look
    bool more = false;                    // of synth::more_object_words() and so on
    // Squeeze of pictures: what is restyled may have other proportions than all that there is to learn from.
    double squeeze = 1;
};

constexpr double MostClose = 0.7;  // distance of a close camera, where a thing is 1 high

Shot make_shot(std::uint64_t seed, std::uint64_t index) {
    Random random = Random::stream(seed, index / 2);
    Shot shot;
    shot.spec = synth::training_spec(random);
    // Front views oversampled: faces and accessories are seen there.
    shot.azimuth = random.uniform() < 0.35 ? random.uniform(-1.2, 1.2)
                                           : random.uniform(-std::numbers::pi, std::numbers::pi);
    shot.elevation = random.uniform(0.05, 0.75);
    shot.zoom = random.uniform(0.8, 1.6);
    shot.background = random_background(random);
    const bool second = index % 2 == 1;
    if (second && !shot.spec.accessory.empty()) {
        shot.twin = shot.spec;
        shot.bare_twin = true;
        shot.spec.accessory.clear();
        shot.spec.accessory_colour.clear();
    } else if (second) {
        shot.azimuth += random.uniform(0.6, std::numbers::pi);
        shot.elevation = random.uniform(0.05, 0.75);
        shot.zoom = random.uniform(0.8, 1.6);
    }
    return shot;
}

/// Coverage of one part, averaged over the latent cells.
void store_coverage(const Image& pixels, std::uint8_t* cells) {
    const int side = pixels.width / LatentCell;
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            float sum = 0;
            for (int k = 0; k < LatentCell * LatentCell; ++k)
                sum += pixels.at(x * LatentCell + k % LatentCell, y * LatentCell + k / LatentCell, 0);
            const float mean = std::clamp(sum / (LatentCell * LatentCell), 0.0f, 1.0f);
            cells[y * side + x] = static_cast<std::uint8_t>(std::lround(mean * 255.0f));
        }
}

/// Scratch of one thread.
struct ShotPainter {
    ThreadPool pool{1};
    std::unique_ptr<raster::Rasterizer> rasterizer = raster::make_fast_rasterizer(pool);
    raster::ForwardOutput output;
    Image values;
    std::vector<float> indicator;

    /// `outlined`: the part whose outline is wanted, too; -1 = none.
    void paint_parts(const synth::SynthScene& scene, const Camera& camera, StarterPicture& picture,
                     int outlined = -1) {
        const std::size_t cells =
            static_cast<std::size_t>(camera.width / LatentCell) * (camera.width / LatentCell);
        picture.coverage.resize(StarterPartCount * cells);
        for (int part = 0; part < StarterPartCount; ++part) {
            indicator.resize(scene.parts.size());
            std::transform(scene.parts.begin(), scene.parts.end(), indicator.begin(),
                           [part](synth::Part p) { return static_cast<int>(p) == part ? 1.0f : 0.0f; });
            rasterizer->forward_values(scene.scene.gaussians.spans(), camera, {}, indicator, values);
            store_coverage(values, &picture.coverage[static_cast<std::size_t>(part) * cells]);
            if (part == outlined) picture.outline = to_bytes(values);
        }
    }
};

/// A picture of `scene`; its parts' coverage, too.
StarterPicture painted(ShotPainter& painter, const synth::SynthScene& scene, const Camera& camera,
                       const std::array<float, 3>& background, std::span<const float> opacity_logit = {},
                       int outlined = -1) {
    StarterPicture picture;
    raster::Settings settings;
    settings.background = background;
    auto spans = scene.scene.gaussians.spans();
    if (!opacity_logit.empty()) spans.opacity_logit = opacity_logit;
    painter.rasterizer->forward(spans, camera, settings, painter.output);
    picture.rgb = to_bytes(painter.output.colour);
    painter.paint_parts(scene, camera, picture, outlined);
    return picture;
}

/// A camera that sees the accessory large: what is added is redrawn in a section of the picture.
Camera close_camera(const synth::SynthScene& scene, const Shot& shot, int size) {
    constexpr double Fov = std::numbers::pi / 4;
    Vec3 low{1e9, 1e9, 1e9}, high{-1e9, -1e9, -1e9};
    const auto positions = scene.scene.gaussians.position();
    for (std::size_t row = 0; row < scene.parts.size(); ++row) {
        if (scene.parts[row] != synth::Part::Accessory) continue;
        for (int axis = 0; axis < 3; ++axis) {
            const double at = positions[row * 3 + static_cast<std::size_t>(axis)];
            low[axis] = std::min(low[axis], at), high[axis] = std::max(high[axis], at);
        }
    }
    const Vec3 span = high - low;
    OrbitParameters orbit;
    orbit.centre = (low + high) * 0.5 + shot.aside * length(span);
    orbit.radius = std::max(0.5 * length(span) / (std::tan(0.5 * Fov) * shot.close_share), MostClose);
    orbit.elevation = shot.elevation;
    orbit.fov_x = Fov;
    return orbit_camera(orbit, shot.azimuth, size, size);
}

/// Upright cylinder around an object in which edits redraw it: where another takes its place
/// (edit::room_around()), or where something is added to it (edit::room_above()).
struct Room {
    Vec3 low{1e9, 1e9, 1e9}, high{-1e9, -1e9, -1e9};
    bool above = false;  // it is higher by a share of the longest side, not of the height

    static constexpr double LeastWidth = 0.4;  // of its height, half the width of a room
    double half_width(double share) const {
        return (1 + share) *
               std::max({0.5 * (high.x - low.x), 0.5 * (high.z - low.z), LeastWidth * (high.y - low.y)});
    }
    /// Latent cells that see some of it, if it is `share` wider and higher than the object.
    void store(const Camera& camera, double share, std::uint8_t* cells) const {
        constexpr int Points = 32;  // per axis: closer than cells
        const int side = camera.width / LatentCell;
        const double wide = half_width(share),
                     height = high.y - low.y +
                              share * (above ? std::max({high.x - low.x, high.y - low.y, high.z - low.z})
                                             : high.y - low.y);
        for (int k = 0; k < Points * Points * Points; ++k) {
            const double x = 2.0 * (k % Points) / (Points - 1) - 1,
                         z = 2.0 * (k / Points % Points) / (Points - 1) - 1;
            if (x * x + z * z > 1) continue;
            // Up is -y: it stands where the thing stands.
            const Vec3 point{(low.x + high.x) / 2 + wide * x,
                             high.y - height * (k / (Points * Points)) / (Points - 1),
                             (low.z + high.z) / 2 + wide * z};
            const Vec3 seen = camera.to_camera(point);
            if (seen.z <= 0) continue;
            const int u =
                static_cast<int>(std::floor((camera.fx * seen.x / seen.z + camera.cx) / LatentCell));
            const int v =
                static_cast<int>(std::floor((camera.fy * seen.y / seen.z + camera.cy) / LatentCell));
            if (u >= 0 && v >= 0 && u < side && v < side) cells[v * side + u] = 255;
        }
    }
};

/// Another than the word of the list.
std::string other_word(const std::vector<std::string>& words, const std::string& word, Random& random) {
    std::vector<std::string> others;
    std::copy_if(words.begin(), words.end(), std::back_inserter(others),
                 [&](const std::string& other) { return other != word; });
    return others.empty() ? word : others[random.below(others.size())];
}

/// The list, with its `more` words where those are asked for.
std::vector<std::string> words_of(std::vector<std::string> words, const std::vector<std::string>& more,
                                  bool wanted) {
    if (wanted) words.insert(words.end(), more.begin(), more.end());
    return words;
}

/// The scene before `part` got the look that it has; never one that is kept out of training.
synth::SceneSpec before_restyling(const synth::SceneSpec& after, synth::Part part, bool more,
                                  Random& random) {
    const auto grounds = words_of(synth::ground_words(), synth::more_ground_words(), more);
    const auto materials = words_of(synth::material_words(), synth::more_material_words(), more);
    synth::SceneSpec before = after;
    do {
        if (part == synth::Part::Ground) before.ground = other_word(grounds, after.ground, random);
        if (part == synth::Part::Object) before.material = other_word(materials, after.material, random);
        if (part == synth::Part::Accessory)
            before.accessory_colour =
                other_word(synth::accessory_colour_words(after.accessory), after.accessory_colour, random);
    } while (synth::held_out(before));
    return before;
}

/// Tells whether a caption names the look of `part`.
bool tells_look(const synth::Caption& caption, const synth::SceneSpec& spec, synth::Part part) {
    const auto is_look = [&](const synth::Caption::Grounding& grounding) {
        if (grounding.part != part) return false;
        return part == synth::Part::Ground ||
               (part == synth::Part::Object && grounding.word != spec.object) ||
               grounding.word == spec.accessory_colour;
    };
    return std::any_of(caption.groundings.begin(), caption.groundings.end(), is_look);
}

/// Scene before the edit: with another look of a part, without its accessory, or with the shadow alone of
/// another object.
struct SceneBefore {
    synth::SynthScene scene;
    std::vector<float> opacity_logit;  // [N]
    Room room;                         // of the thing that is gone, or that the accessory belongs to
    double share = 0;                  // by which it is larger

    SceneBefore(synth::SceneSpec spec, std::optional<synth::Part> restyled, bool more, Random random) {
        if (restyled) {
            scene = synth::generate(before_restyling(spec, *restyled, more, random));
            return;
        }
        const auto objects = words_of(synth::object_words(), synth::more_object_words(), more);
        constexpr float Nothing = -20;
        const bool replaced = spec.accessory.empty();
        if (replaced) spec.object = objects[random.below(objects.size())];
        spec.accessory.clear(), spec.accessory_colour.clear();
        scene = synth::generate(spec);
        const auto given = scene.scene.gaussians.opacity_logit();
        opacity_logit.assign(given.begin(), given.end());
        room.above = !replaced;
        // Something worn reaches beyond.
        share = replaced ? random.uniform(0.1, 0.3) : random.uniform(0.3, 0.8);
        const auto positions = scene.scene.gaussians.position();
        for (std::size_t row = 0; row < opacity_logit.size(); ++row) {
            if (scene.parts[row] != synth::Part::Object) continue;
            if (replaced) opacity_logit[row] = Nothing;
            for (int axis = 0; axis < 3; ++axis) {
                const double at = positions[row * 3 + static_cast<std::size_t>(axis)];
                room.low[axis] = std::min(room.low[axis], at),
                room.high[axis] = std::max(room.high[axis], at);
            }
        }
    }
};

/// "gray" is "grey", too.
void spell_grey(std::string& text) {
    for (auto at = text.find("gray"); at != std::string::npos; at = text.find("gray", at))
        text.replace(at, 4, "grey");
}

/// Some views of every scene, with the accessory that it has, from any side; half of the accessories from
/// close by.
class ShapeSource : public StarterSource {
public:
    /// `edited`: with what is new in it; else as it was before.
    ShapeSource(std::uint64_t seed, const ShapeMix& mix, bool edited = true)
        : seed_(seed), mix_(mix), edited_(edited) {
        if (edited) before_ = std::make_unique<ShapeSource>(seed, mix, false);
    }

    StarterPicture picture(std::uint64_t index, int size) const override {
        thread_local ShotPainter painter;
        thread_local std::pair<std::string, std::uint64_t>
            known;  // views of a scene are asked for one after the other
        thread_local synth::SynthScene scene;
        thread_local std::optional<SceneBefore> before;
        const Shot shot = shot_of(index);
        if (const std::pair wanted{identity(), index / Views}; known != wanted) {
            scene = synth::generate(shot.spec);
            if (!edited_)
                before.emplace(shot.spec, shot.restyled, shot.more, Random::stream(seed_ + 1, index / Views));
            known = wanted;
        }
        auto camera = shot.close_share > 0
                          ? close_camera(scene, shot, size)
                          : synth::scene_camera(scene, shot.azimuth, shot.elevation, shot.zoom, size, size);
        camera.fx *= shot.squeeze, camera.fy /= shot.squeeze;
        const auto is_new = shot.restyled.value_or(shot.spec.accessory.empty() ? synth::Part::Object
                                                                               : synth::Part::Accessory);
        if (edited_) return painted(painter, scene, camera, shot.background, {}, static_cast<int>(is_new));
        auto picture = painted(painter, before->scene, camera, shot.background, before->opacity_logit);
        const std::size_t cells = picture.coverage.size() / StarterPartCount;
        std::fill_n(picture.coverage.begin() + static_cast<std::ptrdiff_t>(cells), cells, std::uint8_t{0});
        if (!shot.restyled) before->room.store(camera, before->share, &picture.coverage[cells]);
        return picture;
    }
    StarterCaption caption(std::uint64_t index, std::uint64_t seed, bool) const override {
        constexpr double
            Plain = 0.6,
            AnySide = 0.05;  // shares: the sentence in its plainest form; one that does not say from where
        const Shot shot = shot_of(index);
        Random random(seed);
        auto caption = random.uniform() < Plain ? synth::full_caption(shot.spec)
                                                : synth::random_caption(shot.spec, random);
        if (shot.restyled && !tells_look(caption, shot.spec, *shot.restyled))
            caption = synth::full_caption(shot.spec);
        std::string text = caption.text;
        if (shot.more && random.uniform() < 0.5) spell_grey(text);
        if (random.uniform() < AnySide) return {text, {}};
        const auto side = synth::side_blend(shot.azimuth);
        return {text + ", " + side.words, {}, text + ", " + side.next_words, side.share};
    }
    std::vector<std::string> vocabulary() const override {
        return mix_.more > 0 ? synth::drawn_vocabulary() : synth::vocabulary();
    }
    int views_of_scene() const override { return Views; }
    StarterCamera camera(std::uint64_t index) const override {
        const Shot shot = shot_of(index);
        return {shot.azimuth, shot.elevation, synth::turn_of(shot.spec)};
    }
    const StarterSource* before() const override { return before_.get(); }
    std::optional<StarterPart> restyled(std::uint64_t index) const override {
        const auto part = shot_of(index).restyled;
        return part ? std::optional(static_cast<StarterPart>(*part)) : std::nullopt;
    }
    bool has_outlines() const override { return edited_; }
    std::string identity() const override {
        return fmt::format("synthetic shapes 6 {}{}{}", edited_ ? "" : "before ", seed_,
                           mix_.restyled > 0 ? fmt::format(" restyled {}", mix_.restyled) : "") +
               (mix_.more > 0 ? fmt::format(" more {}{}", mix_.more, mix_.more_looks ? " looks" : "") : "");
    }

private:
    static constexpr int Views = 8;               // of a scene
    static constexpr double WithAccessory = 0.6;  // of the scenes

    Shot shot_of(std::uint64_t index) const {
        Random random = Random::stream(seed_, index / Views);
        Shot shot;
        shot.more = mix_.more > 0 && Random::stream(seed_ + 3, index / Views).uniform() < mix_.more;
        shot.spec = shot.more ? synth::training_spec_of_more(random, WithAccessory, mix_.more_looks)
                              : synth::training_spec(random, WithAccessory);
        const double zoom = random.uniform(0.8, 1.6);
        shot.background = random_background(random);
        if (!shot.spec.accessory.empty() && random.uniform() < 0.5) {
            shot.close_share = random.uniform(0.3, 0.75);
            shot.aside = {random.uniform(-0.15, 0.15), random.uniform(-0.15, 0.15),
                          random.uniform(-0.15, 0.15)};
        }
        restyle(shot, Random::stream(seed_ + 2, index / Views));
        random = Random::stream(random.next(), index % Views);
        shot.azimuth = random.uniform(-std::numbers::pi, std::numbers::pi);
        shot.elevation = random.uniform(0.05, 0.75);
        shot.zoom = zoom * random.uniform(0.9, 1.1);
        return shot;
    }
    void restyle(Shot& shot, Random random) const {
        constexpr double Accessory = 0.25, Ground = 0.3, Squeezed = 0.5,
                         MostSqueezed = 0.3;  // shares; of the logarithm
        if (!(random.uniform() < mix_.restyled)) return;
        const bool coloured = synth::accessory_colour_words(shot.spec.accessory).size() > 1;
        if (coloured && random.uniform() < Accessory) {
            shot.restyled = synth::Part::Accessory;
        } else {
            shot.restyled = random.uniform() < Ground ? synth::Part::Ground : synth::Part::Object;
            shot.close_share = 0;
        }
        if (random.uniform() < Squeezed) shot.squeeze = std::exp(random.uniform(-MostSqueezed, MostSqueezed));
    }
    std::uint64_t seed_;
    ShapeMix mix_;
    bool edited_;
    std::unique_ptr<ShapeSource> before_;
};

class SyntheticSource : public StarterSource {
public:
    explicit SyntheticSource(std::uint64_t seed)
        : seed_(seed), pairs_(make_contrastive_pairs(seed)), drawn_(seed, {0, MoreDrawn, false}) {}

    StarterPicture picture(std::uint64_t index, int size) const override {
        thread_local ShotPainter painter;
        const Shot shot = make_shot(seed_, index);
        const synth::SynthScene scene = synth::generate(shot.spec);
        const Camera camera = synth::scene_camera(scene, shot.azimuth, shot.elevation, shot.zoom, size, size);
        StarterPicture picture = painted(painter, scene, camera, shot.background);
        if (shot.bare_twin) add_twin_accessory(painter, shot, camera, picture);
        return picture;
    }

    StarterCaption caption(std::uint64_t index, std::uint64_t seed, bool insertion) const override {
        const Shot shot = make_shot(seed_, index);
        Random random(seed);
        const auto caption = insertion ? accessory_caption(shot, random)
                                       : synth::random_caption(shot.spec, shot.azimuth, random);
        StarterCaption result;
        result.text = caption.text;
        for (const auto& grounding : caption.groundings)
            result.groundings.push_back(
                {grounding.word, grounding.occurrence, static_cast<StarterPart>(grounding.part)});
        return result;
    }

    std::vector<std::string> vocabulary() const override { return synth::vocabulary(); }
    std::string identity() const override { return "synthetic-3 " + std::to_string(seed_); }
    const ContrastivePairs* contrastive_pairs() const override { return pairs_.get(); }
    const StarterSource& drawn_pictures() const override { return drawn_; }

private:
    static constexpr double MoreDrawn = 0.5;  // share with words that are drawn only

    /// Insertion captions must name the accessory.
    static synth::Caption accessory_caption(const Shot& shot, Random& random) {
        for (int attempt = 0; attempt < 4; ++attempt) {
            auto caption = synth::random_caption(shot.twin, shot.azimuth, random);
            for (const auto& grounding : caption.groundings)
                if (grounding.part == synth::Part::Accessory) return caption;
        }
        return synth::full_caption(shot.twin);
    }

    static void add_twin_accessory(ShotPainter& painter, const Shot& shot, const Camera& camera,
                                   StarterPicture& picture) {
        const synth::SynthScene twin = synth::generate(shot.twin);
        StarterPicture twin_picture;
        painter.paint_parts(twin, camera, twin_picture);
        const auto cells = static_cast<std::ptrdiff_t>(picture.coverage.size() / StarterPartCount);
        std::copy(twin_picture.coverage.begin() + 2 * cells, twin_picture.coverage.end(),
                  picture.coverage.begin() + 2 * cells);
        picture.bare_twin = true;
    }

    std::uint64_t seed_;
    std::unique_ptr<ContrastivePairs> pairs_;
    ShapeSource drawn_;
};

}  // namespace

std::array<float, 3> random_background(Random& random) {
    const double kind = random.uniform();
    if (kind < 0.35) return {0, 0, 0};
    const float grey = static_cast<float>(random.uniform(0.02, 1.0));
    if (kind < 0.7) return {grey, grey, grey};
    const auto tint = [&] {
        return static_cast<float>(std::clamp(grey + random.uniform(-0.25, 0.25), 0.0, 1.0));
    };
    return {tint(), tint(), tint()};
}

std::vector<std::uint8_t> to_bytes(const Image& image) {
    std::vector<std::uint8_t> bytes(image.data.size());
    std::transform(image.data.begin(), image.data.end(), bytes.begin(), [](float value) {
        return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0f, 1.0f) * 255.0f));
    });
    return bytes;
}

std::unique_ptr<StarterSource> make_shape_source(std::uint64_t seed, const ShapeMix& mix) {
    return std::make_unique<ShapeSource>(seed, mix);
}

std::unique_ptr<StarterSource> make_starter_source(std::uint64_t seed) {
    return std::make_unique<SyntheticSource>(seed);
}

}  // namespace gse::training
