// Puts ground, object and accessory together as labelled Gaussians, and the camera that looks at them.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/error.h"
#include "engine/laboratory/synth/head_rows.h"
#include "engine/laboratory/synth/objects/ground.h"
#include "engine/laboratory/synth/objects/models.h"
#include "engine/laboratory/synth/synth.h"
#include "engine/laboratory/synth/words.h"

namespace gse::synth {
namespace {

// Shares of the budget; fixed, so that an accessory changes nothing else.
constexpr double GroundShare = 0.32;
constexpr double ObjectShare = 0.50;
constexpr double AccessoryShare = 0.18;
constexpr int SmallestBudget = 500;
constexpr int LargestBudget = 2'000'000;

// Random streams of a scene's seed.
enum Stream : std::uint64_t {
    LightStream = 1,
    PoseStream = 2,
    TextureStream = 3,
    ObjectStream = 100,
    AccessoryStream = 200,
    GroundStream = 300,
    OpacityStream = 400,
    SampleStream = 500
};

/// Rows of a share of the budget.
int share_of(const SceneSpec& spec, double share) {
    return static_cast<int>(share * std::clamp(spec.gaussian_budget, SmallestBudget, LargestBudget));
}

/// Half a turn about z: model space (y up) to world space (y down); the front stays at -z.
Vec3 to_world(const Vec3& model) { return {-model.x, -model.y, model.z}; }

/// Streams of what differs between variants of a scene.
Random own_stream(const SceneSpec& spec, std::uint64_t index) {
    return Random::stream(spec.seed + 0x9e3779b97f4a7c15ULL * spec.variant, index);
}

/// The first that a pose is drawn with.
double turn_of(Random& random, const SceneSpec& spec) { return random.uniform(-0.22, 0.22) + spec.heading; }

Placing make_pose(Random random, const SceneSpec& spec) {
    Placing pose;
    pose.turn = rotation_y(turn_of(random, spec));
    pose.size = random.uniform(0.93, 1.05) * spec.size;
    pose.shift = {random.uniform(-0.04, 0.04), 0, random.uniform(-0.04, 0.04)};
    return pose;
}

void place(std::vector<SurfacePoint>& points, const Placing& pose) {
    for (auto& point : points) {
        point.position = pose.turn * point.position * pose.size + pose.shift;
        point.normal = pose.turn * point.normal;
        point.spacing *= pose.size;
    }
}

/// Colours of the points; textures follow the object's own space, light the scene's.
std::vector<Vec3> colours_of(std::span<const SurfacePoint> own, std::span<const SurfacePoint> placed,
                             std::span<const Shape> shapes, const Material& material, const Light& light) {
    std::vector<Vec3> colours(own.size());
    for (std::size_t i = 0; i < own.size(); ++i) {
        const Shape& shape = shapes[own[i].shape];
        SurfacePoint point = own[i];
        point.normal = placed[i].normal;
        colours[i] = shade(shape.paint_at ? shape.paint_at(own[i]) : shape.paint, material, light, point);
    }
    return colours;
}

/// Writes Gaussians of one part behind each other into the arrays of a scene.
class Writer {
public:
    explicit Writer(SynthScene& scene) : scene_(scene) {}

    void add(std::span<const SurfacePoint> points, std::span<const Vec3> colours, Part part, Random random) {
        for (std::size_t i = 0; i < points.size(); ++i) add_one(points[i], colours[i], part, random);
    }
    GaussianData take() { return std::move(data_); }

private:
    void add_one(const SurfacePoint& point, const Vec3& colour, Part part, Random& random) {
        constexpr double Wide = 0.72, Narrow = 0.62, Thin = 0.10;  // standard deviations over the spacing
        const Vec3 position = to_world(point.position);
        const Vec3 normal = to_world(point.normal);
        const Quat turn = quaternion(rotation_to(normal));  // local y is the thin axis
        const double opacity = random.uniform(0.92, 0.97);
        for (const double value : {position.x, position.y, position.z})
            data_.position.push_back(static_cast<float>(value));
        for (const double factor : {Wide, Thin, Narrow})
            data_.log_scale.push_back(static_cast<float>(std::log(factor * point.spacing)));
        for (const double value : {turn.w, turn.x, turn.y, turn.z})
            data_.rotation.push_back(static_cast<float>(value));
        data_.opacity_logit.push_back(static_cast<float>(std::log(opacity / (1 - opacity))));
        for (const double value : {colour.x, colour.y, colour.z})
            data_.sh.push_back(static_cast<float>(sh_from_colour(value)));
        scene_.parts.push_back(part);
    }

    SynthScene& scene_;
    GaussianData data_;
};

std::uint64_t object_index(const SceneSpec& spec) {
    return word_index(object_words(), more_object_words(), spec.object);
}

/// Samples of the object in its own space.
std::vector<SurfacePoint> object_points(const SceneSpec& spec, const Model& model) {
    return sample_surface(model.shapes, {}, share_of(spec, ObjectShare),
                          Random::stream(spec.seed, SampleStream + object_index(spec)));
}

GroundSample ground_of(const SceneSpec& spec, std::span<const SurfacePoint> object, const Light& light) {
    const std::uint64_t index = word_index(ground_words(), more_ground_words(), spec.ground);
    return make_ground(spec.ground, share_of(spec, GroundShare), object, light,
                       Random::stream(spec.seed, GroundStream + index));
}

LabelSet labels_of(const std::vector<Part>& parts) {
    LabelSet set;
    constexpr std::pair<const char*, Part> Names[] = {
        {"ground", Part::Ground}, {"object", Part::Object}, {"accessory", Part::Accessory}};
    for (const auto& [name, part] : Names) {
        std::vector<float> weight(parts.size());
        for (std::size_t i = 0; i < parts.size(); ++i) weight[i] = parts[i] == part ? 1.0f : 0.0f;
        set.labels.push_back(make_label(name, std::move(weight), 0.5f));
    }
    return set;
}

constexpr double TargetHeight = 0.59;  // a little above the middle of the figure: room for a hat

struct Frame {
    double zoom = 1;
    int width = 0, height = 0;
};

Camera camera_at(const Vec3& target, double azimuth, double elevation, const Frame& frame) {
    constexpr double Fov = std::numbers::pi / 4;
    constexpr double Distance = 2.1;  // a figure of 1 unit fills about 60 % of the frame
    OrbitParameters orbit;
    orbit.centre = target;
    orbit.radius = Distance / std::max(frame.zoom, 1e-3);
    orbit.elevation = elevation;
    const double aspect = static_cast<double>(frame.width) / std::max(frame.height, 1);
    orbit.fov_x = 2 * std::atan(std::tan(0.5 * Fov) * std::max(aspect, 1.0));
    return orbit_camera(orbit, azimuth, frame.width, frame.height);
}

}  // namespace

SynthScene generate(const SceneSpec& spec) {
    require_known_words(spec);
    SynthScene result;
    result.spec = spec;
    const auto stream = [&](std::uint64_t index) { return Random::stream(spec.seed, index); };
    const Light light = make_light(stream(LightStream));
    const Placing pose = make_pose(own_stream(spec, PoseStream), spec);
    const Model model = make_object(spec.object, own_stream(spec, ObjectStream + object_index(spec)));
    const Material material = make_material(spec.material, own_stream(spec, TextureStream));

    const auto own = object_points(spec, model);
    auto placed = own;
    place(placed, pose);
    const GroundSample ground = ground_of(spec, placed, light);
    Writer writer(result);
    writer.add(ground.points, ground.colours, Part::Ground, stream(OpacityStream));
    writer.add(placed, colours_of(own, placed, model.shapes, material, light), Part::Object,
               stream(OpacityStream + 1));
    if (!spec.accessory.empty()) {
        const std::uint64_t index = word_index(accessory_words(), more_accessory_words(), spec.accessory);
        const auto shapes = make_accessory(spec.accessory, model.anchor, stream(AccessoryStream + index));
        const Material dye = make_material(accessory_material(spec), stream(AccessoryStream + 50));
        const auto own_worn = sample_surface(shapes, model.shapes, share_of(spec, AccessoryShare),
                                             stream(SampleStream + 50 + index));
        auto worn = own_worn;
        place(worn, pose);
        writer.add(worn, colours_of(own_worn, worn, shapes, dye, light), Part::Accessory,
                   stream(OpacityStream + 2));
    }
    const Vec3 face = (model.anchor.top * 2.0 + model.anchor.eyes) / 3.0;
    result.head = to_world(pose.turn * face * pose.size + pose.shift);
    result.scene.gaussians = GaussianSet(writer.take());
    result.scene.info.format = "synthetic";
    result.scene.info.up_known = true;
    result.scene.labels = labels_of(result.parts);
    return result;
}

GaussianSet ground_under(const SceneSpec& spec, std::span<const Placing> places) {
    const Light light = make_light(Random::stream(spec.seed, LightStream));
    const Model model = make_object(spec.object, own_stream(spec, ObjectStream + object_index(spec)));
    const Placing pose = make_pose(own_stream(spec, PoseStream), spec);
    auto own = object_points(spec, model);
    place(own, pose);
    std::vector<SurfacePoint> things;
    for (const auto& there : places)
        for (auto point : own) {
            point.position = to_world(there(to_world(point.position)));
            point.spacing *= there.size;
            things.push_back(point);
        }
    const GroundSample ground = ground_of(spec, things, light);
    SynthScene scene;
    Writer writer(scene);
    writer.add(ground.points, ground.colours, Part::Ground, Random::stream(spec.seed, OpacityStream));
    return GaussianSet(writer.take());
}

std::vector<std::uint8_t> head_rows(const SynthScene& scene) {
    const auto& spec = scene.spec;
    const Model model = make_object(spec.object, own_stream(spec, ObjectStream + object_index(spec)));
    const auto points = object_points(spec, model);
    const auto& [top, neck] = std::pair{model.anchor.top, model.anchor.neck};
    const Vec3 middle{top.x, 0.5 * (top.y + neck.y), top.z};
    const double reach = std::max(top.y - neck.y, 2 * model.anchor.head_radius);
    std::vector<std::uint8_t> rows(scene.parts.size(), 0);
    auto row = static_cast<std::size_t>(std::find(scene.parts.begin(), scene.parts.end(), Part::Object) -
                                        scene.parts.begin());
    for (const auto& point : points) {
        const Vec3& centre = model.shapes[point.shape].centre;
        rows.at(row++) = centre.y > neck.y && length(centre - middle) < reach ? 1 : 0;
    }
    return rows;
}

double turn_of(const SceneSpec& spec) {
    Random random = own_stream(spec, PoseStream);
    return turn_of(random, spec);
}

Camera scene_camera(const SynthScene&, double azimuth, double elevation, double zoom, int width, int height) {
    return camera_at({0, -TargetHeight, 0}, azimuth, elevation, {zoom, width, height});
}

Camera head_camera(const SynthScene& scene, double azimuth, double elevation, double zoom, int width,
                   int height) {
    return camera_at(scene.head, azimuth, elevation, {zoom, width, height});
}

}  // namespace gse::synth
