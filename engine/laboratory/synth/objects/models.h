// The objects and accessories of the synthetic world as lists of shapes in model space.
#pragma once

#include <string>

#include "engine/laboratory/synth/objects/shapes.h"

namespace gse::synth {

/// Paints of a thing's own slots.
constexpr Paint Main{Slot::Main};
constexpr Paint Pale{Slot::Pale};
constexpr Paint Deep{Slot::Deep};

/// Places of accessories on an object, in model space.
struct Anchor {
    Vec3 top{0, 1, 0};          // highest point under a hat's middle
    double head_radius = 0.25;  // half width of the head at hat height
    Vec3 eyes{0, 0.7, -0.25};   // between the eyes, on the surface
    double eye_half = 0.11;     // half the distance between the eyes
    double face_depth = 0.25;   // how far temples reach back
    Vec3 neck{0, 0.5, 0};       // middle of the neck
    double neck_x = 0.2;        // half width of the neck
    double neck_z = 0.2;        // half depth of the neck
    Vec3 back{0, 0.5, 0.2};     // where wings are fixed
    double body_radius = 0.35;  // half width of the whole, for flames around it
    double body_depth = 0.3;    // half depth of the whole
};

struct Model {
    ShapeList shapes;
    Anchor anchor;
};

/// Model of a word of object_words() or more_object_words(), with random proportions.
Model make_object(const std::string& word, Random random);

/// Two big eyes, white with a black pupil, looking to -z.
void add_eyes(ShapeList& shapes, const Vec3& middle, double half, double radius);

Model make_bear(Random& random);
Model make_dog(Random& random);
Model make_cat(Random& random);
Model make_duck(Random& random);
Model make_statue(Random& random);
Model make_ball(Random& random);
Model make_vase(Random& random);
Model make_mushroom(Random& random);
Model make_chair(Random& random);
Model make_car(Random& random);
Model make_house(Random& random);
Model make_tree(Random& random);

Model make_rabbit(Random& random);
Model make_horse(Random& random);
Model make_elephant(Random& random);
Model make_pig(Random& random);
Model make_lion(Random& random);
Model make_penguin(Random& random);
Model make_owl(Random& random);
Model make_frog(Random& random);
Model make_turtle(Random& random);
Model make_dinosaur(Random& random);
Model make_snowman(Random& random);
Model make_robot(Random& random);
Model make_pumpkin(Random& random);
Model make_cactus(Random& random);
Model make_teapot(Random& random);
Model make_rocket(Random& random);
Model make_castle(Random& random);
Model make_lamp(Random& random);

/// Shapes of a word of accessory_words() or more_accessory_words() at its place on an object.
ShapeList make_accessory(const std::string& word, const Anchor& anchor, Random random);

ShapeList make_cape(const Anchor& anchor, Random& random);
ShapeList make_beard(const Anchor& anchor, Random& random);
ShapeList make_horns(const Anchor& anchor, Random& random);
ShapeList make_helmet(const Anchor& anchor, Random& random);
ShapeList make_halo(const Anchor& anchor, Random& random);
ShapeList make_backpack(const Anchor& anchor, Random& random);
ShapeList make_headphones(const Anchor& anchor, Random& random);
ShapeList make_necklace(const Anchor& anchor, Random& random);

}  // namespace gse::synth
