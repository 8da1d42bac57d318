// Traits of a model that follow from its training pictures; read from the gseditpro.json of its bundle.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "engine/base/fields.h"

namespace gse::edit {

/// Proportions, grounds and colours of the pictures that a model has learned from. Defaults hold for models
/// that state none.
struct ModelTraits {
    using Colour = std::array<float, 3>;  // display values in [0,1]

    double figure_aim = 0.59;
    double half_picture = 0.87;
    double head_room = 0.15;
    double small_head = 0.26;
    double head_and_neck = 1.7;
    double ground_reach = 3;
    std::vector<std::string> plain_grounds{"sand", "grass", "snow"};
    std::map<std::string, Colour> ground_colours{
        {"snow", {0.88f, 0.93f, 0.99f}},  {"sand", {0.85f, 0.73f, 0.50f}}, {"grass", {0.36f, 0.62f, 0.15f}},
        {"water", {0.13f, 0.56f, 0.70f}}, {"ice", {0.66f, 0.86f, 0.96f}},  {"mud", {0.33f, 0.21f, 0.13f}},
        {"gravel", {0.55f, 0.54f, 0.52f}}};
    Colour sky{0.69f, 0.78f, 0.88f};
    std::map<std::string, std::string> usual_colours{
        {"rabbit", "white"},   {"horse", "brown"},     {"elephant", "gray"},   {"pig", "pink"},
        {"lion", "ochre"},     {"penguin", "black"},   {"owl", "brown"},       {"frog", "green"},
        {"turtle", "green"},   {"dinosaur", "green"},  {"snowman", "white"},   {"robot", "gray"},
        {"pumpkin", "orange"}, {"cactus", "green"},    {"teapot", "white"},    {"rocket", "white"},
        {"castle", "stone"},   {"lamp", "yellow"},     {"wings", "white"},     {"crown", "golden"},
        {"halo", "golden"},    {"necklace", "golden"}, {"sunglasses", "black"}};

    /// Numbers and lists of words; colours are read apart.
    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        f("figure_aim", self.figure_aim,
          "Height of a picture's middle above a figure's foot, as a share of the figure's height.",
          Range{0, 2});
        f("half_picture", self.half_picture, "Half of a picture's height, in heights of the figure.",
          Range{0.1, 10});
        f("head_room", self.head_room,
          "Room above a thing that is framed by its box, beyond the room below it, as a share of the "
          "picture.",
          Range{0, 1});
        f("small_head", self.small_head,
          "Heads below this share of a figure's height are framed alone for what they wear.", Range{0, 1});
        f("head_and_neck", self.head_and_neck, "Height of head and neck, in heights of the head.",
          Range{1, 10});
        f("ground_reach", self.ground_reach, "Radius of a plain ground, in heights of the figure.",
          Range{0.1, 100});
        f("plain_grounds", self.plain_grounds,
          "Grounds below a thing that stands in nothing: the first, or another one that the sentence names.");
    }
};

}  // namespace gse::edit
