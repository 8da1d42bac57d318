// Sentences of further forms: wishes, negations, places, copies, exchanges, and words of two meanings.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <string>

#include "engine/language/plan/plan_sentence.h"

namespace sentence_forms_test {

namespace {

using namespace gse::language;

struct Case {
    const char *scene, *source, *sentence, *plan;
};

const char* const Bear = "red bear; grass";
const char* const Horse = "brown horse; meadow";
const char* const Car = "red car; road";
const char* const Hat = "red bear; blue hat; grass";
const char* const Chairs = "brown wooden chair; brown wooden chair; table; floor";
const char* const StatueVase = "gray stone statue; white vase; grass";
const char* const House = "brick house; tree; gravel";
const char* const Flower = "brown wooden chair; white vase; yellow flower; table";
const char* const VaseFloor = "white vase; wooden table; floor";
const char* const Cars = "red car; blue car; road";
const char* const Room = "white vase; wooden table; brown chair; tiles";
const char* const Beard = "man; black beard; gray sweater; wall";
const char* const Man = "man; gray sweater; wall";
const char* const Vase = "white vase; wooden table";
const char* const Frog = "red bear; green frog; grass";
const char* const Tiles = "white vase; brown wooden chair; tiles";

const Case Cases[] = {
    {Bear, "bear", "a rainbow over the bear, please", "add(rainbow, above, bear)"},
    {Bear, "bear", "let the bear wear a crown of thorns", "add(crown of thorns, worn by, bear)"},
    {Bear, "bear", "let ivy grow on the bear", "add(ivy, on, bear)"},
    {Bear, "bear", "I could imagine a lamp post on the bear's left", "add(lamp post, left of, bear)"},
    {Bear, "bear", "a sign should stand in front of the bear", "add(sign, in front of, bear)"},
    {Bear, "bear", "a little bit bluer", "recolour(bear, bluer)"},
    {Bear, "bear", "a more colorful bear", "recolour(bear, more colorful)"},
    {Bear, "bear", "make the bear a lot furrier", "material(bear, furry)"},
    {Bear, "bear", "a bear bigger than a house", "transform(bear, bigger)"},
    {Bear, "bear", "make it way darker", "recolour(bear, darker)"},
    {Bear, "bear", "a white bear with black ears wearing a red scarf",
     "recolour(bear, white) ; recolour(ears of bear, black) ; add(scarf{red}, worn by, bear)"},
    {Bear, "bear", "turn the bear blue, remove the grass and add a chair behind it",
     "recolour(bear, blue) ; remove(grass) ; add(chair, behind, bear)"},
    {Bear, "bear", "make it blue and green all over", "recolour(bear, blue and green)"},
    {Bear, "bear", "give the bear a hat and paint the house green",
     "add(hat, worn by, bear) ; refuse(not in scene, house)"},
    {Bear, "bear", "an ice sculpture of a bear on the grass", "material(bear, ice)"},
    {Bear, "bear", "an orange and black bear", "recolour(bear, orange and black)"},
    {Bear, "bear", "a lion with a huge mane sitting on the grass",
     "replace(bear, lion) ; transform(mane of lion, bigger)"},
    {Bear, "bear", "a bear with a rainbow-colored belly", "pattern(belly of bear, rainbow)"},
    {Bear, "bear", "a red bear next to a blue bear", "add(bear{blue}, beside, bear)"},
    {Bear, "bear", "a lawn with a bear and a picnic basket", "add(picnic basket, on, grass)"},
    {Bear, "bear", "a red bear in a knight's armor", "add(knight's armor, worn by, bear)"},
    {Bear, "bear", "a bear and a dog playing on the grass", "add(dog, beside, bear)"},
    {Bear, "bear", "pixelate everything", "style(scene, pixelated)"},
    {Bear, "bear", "make it look like a comic", "style(scene, comic)"},
    {Bear, "bear", "a bear at the beach", "ground(grass, beach)"},
    {Bear, "bear", "a bear lifting its paw", "pose(bear, lifting paw)"},
    {Bear, "bear", "turn it into an oil painting", "style(scene, oil painting)"},
    {Bear, "bear", "a bear at the north pole", "environment(scene, north pole)"},
    {Bear, "bear", "make it a black and white drawing", "style(scene, black and white drawing)"},
    {Bear, "bear", "a thunderstorm rages over the bear", "environment(scene, thunderstorm)"},
    {Bear, "bear", "let the bear stand on cobblestones", "ground(grass, cobblestones)"},
    {Bear, "bear", "lay a wooden floor under the bear", "ground(grass, floor{wooden})"},
    {Bear, "bear", "make the bear stand on gravel", "ground(grass, gravel)"},
    {Bear, "bear", "let the bear stand in water", "ground(grass, water)"},
    {Bear, "bear", "have the bear painted in bright yellow", "recolour(bear, bright yellow)"},
    {Bear, "bear", "flood the lawn with water", "ground(grass, water)"},
    {Bear, "bear", "put the bear on sand instead of grass", "ground(grass, sand)"},
    {Bear, "bear", "a rainbow-striped bear", "pattern(bear, rainbow)"},
    {Bear, "bear", "a goldish bear", "recolour(bear, goldish)"},
    {Bear, "bear", "a bear with a velvet surface", "material(bear, velvet)"},
    {Bear, "bear", "a bear with a diamond pattern", "pattern(bear, diamond)"},
    {Bear, "bear", "a bear carved from a single block of ice", "material(bear, ice)"},
    {Bear, "bear", "a bear built from wooden planks", "material(bear, wooden)"},
    {Bear, "bear", "there is no grass anymore, only sand", "ground(grass, sand)"},
    {Bear, "bear", "the bear isn't supposed to be red, make it gray", "recolour(bear, gray)"},
    {Bear, "bear", "there is no need to change anything", "none(nothing asked)"},
    {Bear, "bear", "I do not want a red bear, I want a golden one", "material(bear, golden)"},
    {Bear, "bear", "a [[golden]] bear, (bokeh:0.8)", "material(bear, golden)"},
    {Bear, "bear", "a hyperrealistic golden bear, cinematic lighting", "material(bear, golden)"},
    {Bear, "bear", "a bear wearing a (crown)1.3", "add(crown, worn by, bear)"},
    {Bear, "bear", "a water buffalo on the grass", "replace(bear, water buffalo)"},
    {Bear, "bear", "a bear with a snow shovel", "add(snow shovel, held by, bear)"},
    {Bear, "bear", "make the bear a sugar cube", "replace(bear, sugar cube)"},
    {Bear, "bear", "a horse chestnut", "replace(bear, horse chestnut)"},
    {Bear, "bear", "paw pads in pink", "recolour(paw pads of bear, pink)"},
    {Bear, "bear", "the inside of its ears pink", "recolour(inside of ears of bear, pink)"},
    {Bear, "bear", "please would it be possible for the bear to wear boots?", "add(boots, worn by, bear)"},
    {Bear, "bear", "ok so basically i just need the bear to be teal, cheers", "recolour(bear, teal)"},
    {Bear, "bear", "could I possibly get the bear in stripes?", "pattern(bear, striped)"},
    {Bear, "bear", "the bear's fur has gone white", "recolour(fur of bear, white)"},
    {Bear, "bear", "the bear used to be red, now it is white", "recolour(bear, white)"},
    {Bear, "bear", "it needs wings", "add(wings, worn by, bear)"},
    {Bear, "bear", "a bear peeking out of a barrel", "add(barrel, around, bear)"},
    {Bear, "bear", "a bear in the middle of a circle of stones", "add(circle of stones, around, bear)"},
    {Bear, "bear", "a bear hiding behind a bush", "add(bush, in front of, bear)"},
    {Bear, "bear", "a dog to the left of the bear and a cat to the right",
     "add(dog, left of, bear) ; add(cat, right of, bear)"},
    {Bear, "bear", "a tent to the left and a campfire to the right of the bear",
     "add(tent, left of, bear) ; add(campfire, right of, bear)"},
    {Bear, "bear", "the grass alone", "remove(bear)"},
    {Bear, "bear", "I'd prefer a donkey over the bear", "replace(bear, donkey)"},
    {Bear, "bear", "replace the bear and the grass with a fish and water",
     "ground(grass, water) ; replace(bear, fish)"},
    {Bear, "bear", "let a horse take the bear's place", "replace(bear, horse)"},
    {Bear, "bear", "remove the bear and place an owl in its stead", "replace(bear, owl)"},
    {Bear, "bear", "let the bear stay red", "none(already so)"},
    {Bear, "bear", "a golden bear. It wears a crown. It stands on snow.",
     "material(bear, golden) ; ground(grass, snow) ; add(crown, worn by, bear)"},
    {Bear, "bear", "first paint the bear green, then give it a scarf, and finally remove the grass",
     "recolour(bear, green) ; remove(grass) ; add(scarf, worn by, bear)"},
    {Bear, "bear", "make it yellow. Actually, orange.", "recolour(bear, orange)"},
    {Bear, "bear", "1) bear: wooden 2) grass: sand", "material(bear, wooden) ; ground(grass, sand)"},
    {Bear, "bear", "no grass, snow", "ground(grass, snow)"},
    {Bear, "bear", "more red", "recolour(bear, more red)"},
    {Bear, "bear", "lay the bear down", "pose(bear, lying)"},
    {Bear, "bear", "blow the bear up to three times its size", "transform(bear, scale 3)"},
    {Bear, "bear", "turn the bear counterclockwise by 15 degrees",
     "transform(bear, rotate 15 counterclockwise)"},
    {Bear, "bear", "lower the bear a little", "transform(bear, move down)"},
    {Bear, "bear", "a biger bear", "transform(bear, bigger)"},
    {Bear, "bear", "a bare wearing a hat", "add(hat, worn by, bear)"},
    {Bear, "bear", "putt a hat on teh baer", "add(hat, worn by, bear)"},
    {Bear, "bear", "a polka dotted bear", "pattern(bear, spotted)"},
    {Horse, "", "a white horse with a braided tail",
     "recolour(horse, white) ; alter(tail of horse, braided)"},
    {Car, "car", "the car is covered in rust", "material(car, rusty)"},
    {Car, "car", "make the car a vintage convertible", "replace(car, convertible{vintage})"},
    {Hat, "bear", "put a red band around the hat", "add(band{red}, around, hat)"},
    {Hat, "bear", "nobody wears a hat", "remove(hat)"},
    {Hat, "bear", "the hat is not needed anymore", "remove(hat)"},
    {Hat, "bear", "leave only the bear and the grass", "remove(hat)"},
    {Hat, "bear", "take away what the bear is wearing", "remove(hat)"},
    {Hat, "bear", "bear no hat", "remove(hat)"},
    {Chairs, "chair", "keep only one chair", "remove(chair[1])"},
    {Chairs, "chair", "move one chair to the left", "transform(chair[1], move left)"},
    {StatueVase, "", "bring the vase over to the right side of the statue",
     "transform(vase, move right of, statue)"},
    {House, "", "the house on a winter evening", "environment(scene, winter evening)"},
    {House, "", "make it look haunted", "style(scene, haunted)"},
    {Flower, "", "put another flower in the vase", "duplicate(flower, 2)"},
    {VaseFloor, "vase", "set the vase down on the floor", "transform(vase, move on, floor)"},
    {Cars, "", "three cars", "duplicate(car[all], 3)"},
    {Cars, "", "make the two cars change places", "transform(car{red}, swap with, car{blue})"},
    {Room, "", "the vase should be under the table", "transform(vase, move under, table)"},
    {Room, "", "the thing on the table should be golden", "material(vase, golden)"},
    {Beard, "man", "swap his beard for a mustache", "replace(beard, mustache)"},
    {Man, "man", "let him raise both arms", "pose(man, raise arms)"},
    {Man, "man", "the man has grown a beard", "add(beard, worn by, man)"},
    {Man, "man", "take it off him", "remove(sweater)"},
    {Man, "man", "older, beard", "alter(man, older) ; add(beard, worn by, man)"},
    {Man, "man", "paint his sweater gery", "none(already so)"},
    {Vase, "vase", "make the vase from blue glass", "recolour(vase, blue) ; material(vase, glass)"},
    {Frog, "", "swap the two animals", "transform(bear, swap with, frog)"},
    {Tiles, "", "swap the vase and the chair and paint the vase red",
     "transform(vase, swap with, chair) ; recolour(vase, red)"},
    {Tiles, "", "remove chair, vase blue", "recolour(vase, blue) ; remove(chair)"},
    {Bear, "bear", "a bear with a golden key around its neck", "add(key{golden}, around, neck of bear)"},
    {Vase, "vase", "an empty vase on a table", "none(already so)"},
    {Bear, "bear", "let the bear stand on a red carpet", "ground(grass, carpet{red})"},
    {Bear, "bear", "make the lawn empty", "remove(bear)"},
    {Bear, "bear", "there is snow on the ground", "ground(grass, snow)"},
    {Bear, "bear", "I don't want grass, I want snow", "ground(grass, snow)"},
    {Bear, "bear", "give it some wings and let it fly", "pose(bear, flying) ; add(wings, worn by, bear)"},
    {Bear, "bear", "a bear on a rainy evening", "environment(scene, rainy evening)"},
    {Bear, "bear", "a bear in a flower pot", "add(flower pot, around, bear)"},
    {Bear, "bear", "a bear with a shiny metallic surface",
     "material(bear, shiny) ; material(bear, metallic)"},
    {Bear, "bear", "a red and gold striped bear", "pattern(bear, striped, red and golden)"},
    {Hat, "bear", "leave the hat out", "remove(hat)"},
    {Bear, "bear", "the bear needs longer arms", "transform(arms of bear, longer)"},
    {Cars, "", "two red cars", "recolour(car{blue}, red)"},
    {Bear, "bear", "a giraffe-patterned bear", "pattern(bear, giraffe)"},
    {Bear, "bear", "a hat is on the bear", "add(hat, worn by, bear)"},
    {Bear, "bear", "no red bear but a blue one", "recolour(bear, blue)"},
    {Bear, "bear", "I do not want any changes", "none(nothing asked)"},
    {Hat, "bear", "paint the bear green, not the hat", "recolour(bear, green)"},
    {Bear, "bear", "make this blue", "recolour(bear, blue)"},
    {Bear, "bear", "a read bear with a green hat", "add(hat{green}, worn by, bear)"},
    {Bear, "bear", "remove the dog and paint the bear blue",
     "recolour(bear, blue) ; refuse(not in scene, dog)"},
    {Bear, "bear", "replace the background with mountains", "environment(scene, mountains background)"},
    {Bear, "bear", "give it the color of honey", "recolour(bear, honey)"},
    {Bear, "bear", "the bear should get a pair of wings", "add(wings, worn by, bear)"},
    {Bear, "bear", "a dog should sit beside the bear", "add(dog, beside, bear)"},
    {Hat, "bear", "the bear should lose its hat", "remove(hat)"},
    {Bear, "bear", "add two copies of the bear", "duplicate(bear, 3)"},
    {StatueVase, "", "make the statue and the vase trade places", "transform(statue, swap with, vase)"},
};

std::string planned(const std::string& sentence, const char* scene, const char* source) {
    return to_string(plan::plan_sentence(sentence, plan::scene_words(scene), source));
}

}  // namespace

DOCTEST_TEST_CASE("wishes, negations, places and exchanges in further forms come to their plans") {
    for (const auto& [scene, source, sentence, plan] : Cases) {
        const std::string typed = sentence;
        DOCTEST_CAPTURE(typed);
        DOCTEST_CHECK(planned(typed, scene, source) == plan);
    }
}

DOCTEST_TEST_CASE("an order about what is not there is refused alone, beside orders that are read") {
    DOCTEST_CHECK(planned("paint the bear black and rotate the house by 30 degrees", Bear, "bear") ==
                  "recolour(bear, black) ; refuse(not in scene, house)");
    DOCTEST_CHECK(planned("rotate the house and paint it black", Bear, "bear") ==
                  "refuse(not in scene, house)");
}

}  // namespace sentence_forms_test
