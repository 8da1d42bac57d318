// Sentences that were kept apart while the grammar was made: their plans, and those that are refused.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <string>

#include "engine/language/plan/plan_sentence.h"

namespace scene_sentences_test {

namespace {

using namespace gse::language;

const char* const Bear = "red bear; grass";
const char* const Bears = "red bear; red bear; grass";
const char* const Car = "red car; road";
const char* const Cars = "red car; blue car; road";
const char* const Chairs = "brown wooden chair; brown wooden chair; table; floor";
const char* const Frog = "red bear; green frog; grass";
const char* const Hat = "red bear; blue hat; grass";
const char* const House = "brick house; tree; gravel";
const char* const Man = "man; gray sweater; wall";
const char* const Sofa = "brown sofa; wooden table; floor";
const char* const Statue = "gray stone statue; grass";
const char* const Table = "brown wooden chair; white vase; yellow flower; table";
const char* const Tiles = "white vase; brown wooden chair; tiles";
const char* const Vase = "white vase; wooden table";

struct Case {
    const char *scene, *source, *sentence, *plan;
};

const Case Read[] = {
    {Statue, "statue", "a statue of a lion on the grass", "replace(statue, statue of lion)"},
    {Statue, "statue", "a mossy stone statue with a broken nose",
     "material(statue, mossy) ; alter(nose of statue, broken)"},
    {Bear, "bear", "give the bear a coat of white paint", "recolour(bear, white)"},
    {Vase, "vase", "glaze the vase blue", "recolour(vase, blue)"},
    {Vase, "vase", "lacquer the table black", "recolour(table, black)"},
    {Car, "car", "respray the car in metallic green", "recolour(car, metallic green)"},
    {Bear, "bear", "set a lantern down in front of the bear", "add(lantern, in front of, bear)"},
    {Bear, "bear", "insert a rock between the bear and the camera", "add(rock, in front of, bear)"},
    {Hat, "bear", "I'm not keen on the hat, take it away", "remove(hat)"},
    {Table, "chair", "remove everything from the table", "remove(vase) ; remove(flower)"},
    {Bear, "bear", "I want a moose where the bear is", "replace(bear, moose)"},
    {Bear, "bear", "my boss thinks the bear should wear a tie", "add(tie, worn by, bear)"},
    {Bear, "bear", "no green, please, make it purple", "recolour(bear, purple)"},
    {Bears, "bear", "remove one of the bears", "remove(bear[1])"},
    {Chairs, "chair", "just one chair, please", "remove(chair[1])"},
    {Bear, "bear", "a bear with a wood grain", "material(bear, wooden)"},
    {Bear, "bear", "a bear with a bowl of honey", "add(bowl of honey, beside, bear)"},
    {Bear, "bear", "bear hat red", "add(hat{red}, worn by, bear)"},
    {Bear, "bear", "a sks bear wearing a crown", "add(crown, worn by, bear)"},
    {Bear, "bear",
     "I have been looking at this bear for a while now and, honestly, red does not suit it at all, so could "
     "you please make it purple instead?",
     "recolour(bear, purple)"},
    {Bear, "", "the bear is too red", "recolour(bear, less red)"},
    {Bear, "bear", "a bear walking on water", "pose(bear, walking) ; ground(grass, water)"},
    {Bear, "bear", "swap the bear's color to lime green", "recolour(bear, lime green)"},
    {Bear, "bear", "have it painted pink", "recolour(bear, pink)"},
    {Bear, "bear", "pave the lawn with cobblestones", "ground(grass, cobblestones)"},
    {Bear, "bear", "put the bear on a wooden deck", "ground(grass, deck{wooden})"},
    {Bear, "bear", "crown the bear", "add(crown, worn by, bear)"},
    {Bear, "bear", "give the bear a balloon to hold", "add(balloon, held by, bear)"},
    {Hat, "bear", "strip the bear of its hat", "remove(hat)"},
    {Hat, "bear", "I don't like the hat, please remove it", "remove(hat)"},
    {Table, "chair", "the table should be empty", "remove(vase) ; remove(flower)"},
    {Bear, "bear", "where the bear is now, put a fountain", "replace(bear, fountain)"},
    {Bear, "bear", "bear to robot", "replace(bear, robot)"},
    {Bear, "bear", "a robot in the bear's place", "replace(bear, robot)"},
    {Bear, "bear", "the bear should float in the air", "pose(bear, floating)"},
    {Bear, "bear", "can i get this bear in purple please", "recolour(bear, purple)"},
    {Bear, "bear", "no bear, just a cat", "replace(bear, cat)"},
    {Bear, "bear", "please don't recolor the grass, only the bear: blue", "recolour(bear, blue)"},
    {Bear, "bear", "take it and paint it silver", "recolour(bear, silver)"},
    {Bear, "bear", "give him sunglasses and paint them pink", "add(sunglasses{pink}, worn by, bear)"},
    {Chairs, "chair", "add a third chair", "duplicate(chair[all], 3)"},
    {Bear, "bear", "a bear that looks like it's carved from jade", "material(bear, jade)"},
    {Vase, "vase", "a gold-rimmed vase", "material(rim of vase, golden)"},
    {Bear, "bear", "a salmon next to the bear", "add(salmon, beside, bear)"},
    {Bear, "bear", "a salmon colored bear", "recolour(bear, salmon)"},
    {Bear, "bear", "bear hat", "add(hat, worn by, bear)"},
    {Bear, "bear", "ultra detailed 3d render of a golden bear with a crown, octane",
     "material(bear, golden) ; add(crown, worn by, bear)"},
    {Bear, "bear",
     "The red color of the bear was never our first choice, and now that the brand has changed its colors, "
     "the bear has to be green, like the logo.",
     "recolour(bear, green)"},
    {Bear, "bear", "make it look like a Pixar movie", "style(scene, pixar movie)"},
    {Bear, "bear", "a claymation bear", "style(bear, claymation)"},
    {Bear, "bear", "a bear on a sunny day", "environment(scene, sunny day)"},
    {Frog, "frog", "remove both animals", "remove(bear) ; remove(frog)"},
    {Bear, "bear", "a brown teddy bear sitting on the grass", "replace(bear, teddy bear{brown})"},
    {Bear, "bear", "a red bear with a huge smile", "pose(bear, huge smile)"},
    {Bear, "bear", "a bear wearing a spacesuit in a field of flowers",
     "add(spacesuit, worn by, bear) ; environment(scene, field of flowers)"},
    {Bear, "bear", "a bear looking to the left", "transform(bear, face left)"},
    {Bear, "bear", "a red bear in the middle of a pond", "ground(grass, pond)"},
    {Bear, "bear", "I'd go with teal for the bear", "recolour(bear, teal)"},
    {Bear, "bear", "draw a red heart on its chest", "add(heart{red}, on, chest of bear)"},
    {Man, "man", "make his sweater striped red and white", "pattern(sweater, striped, red and white)"},
    {Hat, "bear", "pull the hat off the bear's head", "remove(hat)"},
    {Hat, "bear", "the bear is not wearing a hat anymore", "remove(hat)"},
    {Hat, "bear", "everything except the hat should stay", "remove(hat)"},
    {Bear, "bear", "put a dinosaur in place of the bear", "replace(bear, dinosaur)"},
    {Bear, "bear", "I don't want a bear, I want a fox", "replace(bear, fox)"},
    {Bear, "bear", "a bear twice as tall", "transform(bear, taller)"},
    {Bear, "bear", "move the bear away from the camera", "transform(bear, move back)"},
    {Bear, "bear", "pretty please, a crown for the bear", "add(crown, worn by, bear)"},
    {Bear, "bear", "the bear isn't blue, it's yellow", "recolour(bear, yellow)"},
    {Hat, "bear", "keep everything but the hat", "remove(hat)"},
    {Bear, "bear", "make it wear a crown and paint it gold", "add(crown{golden}, worn by, bear)"},
    {Bear, "bear", "a bear whose eyes are blue", "recolour(eyes of bear, blue)"},
    {Bear, "bear", "remove the bear and put a rabbit in its place", "replace(bear, rabbit)"},
    {Bear, "bear", "a dog chasing the bear", "add(dog, behind, bear)"},
    {Bear, "bear", "a bear wearing a t shirt", "add(t-shirt, worn by, bear)"},
    {Bear, "bear", "blue bear / red hat", "recolour(bear, blue) ; add(hat{red}, worn by, bear)"},
    {Bear, "bear", "remove bear add cat", "remove(bear) ; add(cat, in, scene)"},
    {Tiles, "", "vase on chair", "transform(vase, move on, chair)"},
    {Bear, "bear", "make the grass look like grass", "none(already so)"},
    {Bear, "bear", "a bear in front of a sunset", "environment(scene, sunset)"},
    {Bear, "bear", "a bear standing on one leg", "pose(bear, standing on one leg)"},
    {Bear, "bear", "the bear lies on its side", "pose(bear, lying on its side)"},
    {Cars, "", "swap the cars", "transform(car{red}, swap with, car{blue})"},
    {Bear, "bear", "change its color to maroon", "recolour(bear, maroon)"},
    {Bear, "bear", "carve it from ice", "material(bear, ice)"},
    {Bear, "bear", "put gravel under the bear", "ground(grass, gravel)"},
    {Bear, "bear", "lay a book on the grass", "add(book, on, grass)"},
    {Table, "chair", "empty table", "remove(vase) ; remove(flower)"},
    {Bear, "bear", "put a pig in the bear's place", "replace(bear, pig)"},
    {House, "house", "replace the tree with a lamp post", "replace(tree, lamp post)"},
    {Bear, "bear", "move the bear a meter forward", "transform(bear, move forward 1 m)"},
    {Bear, "bear", "the bear turned into a cat", "replace(bear, cat)"},
    {Bear, "bear", "the bear is on fire", "add(flames, on, bear)"},
    {Bear, "bear", "I'd appreciate a green bear", "recolour(bear, green)"},
    {Bear, "bear", "my kids would love to see the bear in a party hat", "add(party hat, worn by, bear)"},
    {Bear, "bear", "the bear is not red anymore, it is green", "recolour(bear, green)"},
    {Bear, "bear", "I don't like red, make it blue", "recolour(bear, blue)"},
    {House, "", "paint the house white and cut down the tree", "recolour(house, white) ; remove(tree)"},
    {Bear, "bear", "a bear beside a pile of gifts", "add(pile of gifts, beside, bear)"},
    {Vase, "vase", "a vase standing on a pile of bricks", "add(pile of bricks, under, vase)"},
    {Bear, "bear", "a bear with cherry lips", "recolour(lips of bear, cherry)"},
    {Bear, "bear", "gove the bear a hat", "add(hat, worn by, bear)"},
    {Bear, "bear", "cinematic photo of a golden bear wearing a crown, 35mm photograph, film, bokeh",
     "material(bear, golden) ; add(crown, worn by, bear)"},
    {Man, "man", "make him ten years younger", "alter(man, younger)"},
    {Man, "man", "raise his right hand", "pose(hand{right} of man, raised)"},
    {Bear, "bear", "give the bear a nice shade of purple", "recolour(bear, purple)"},
    {Bear, "bear", "red to blue", "recolour(bear, blue)"},
    {Bear, "bear", "make the bear look like it's carved out of wood", "material(bear, wooden)"},
    {Bear, "bear", "bring in a cat, sitting to the right of the bear", "add(cat, right of, bear)"},
    {Bear, "bear", "have a bird perch on the bear's head", "add(bird, on, head of bear)"},
    {Bear, "bear", "pile snow around the bear", "add(snow, around, bear)"},
    {Car, "car", "load a sofa onto the car", "add(sofa, on, car)"},
    {Bear, "bear", "let a giraffe take the place of the bear", "replace(bear, giraffe)"},
    {Bear, "bear", "bear to the right", "transform(bear, move right)"},
    {Bear, "bear", "place the bear closer to us", "transform(bear, move forward)"},
    {Bear, "bear", "if it's not too much trouble, paint the bear white", "recolour(bear, white)"},
    {Bear, "bear", "put it upside down", "transform(bear, flip)"},
    {Bear, "bear", "make it two bears", "duplicate(bear, 2)"},
    {Bear, "bear", "double the bears", "duplicate(bear, 2)"},
    {Bear, "bear", "a richer red for the bear", "recolour(bear, richer red)"},
    {Bear, "bear", "a bear as small as a mouse", "transform(bear, smaller)"},
    {Bear, "bear", "a bear hugging a teddy bear", "add(teddy bear, held by, bear)"},
    {Bear, "bear", "mak the bear gold", "material(bear, golden)"},
    {Bear, "bear", "a bear wit a crown", "add(crown, worn by, bear)"},
    {Bear, "bear", "a V* bear made of wood", "material(bear, wooden)"},
    {Bear, "bear", "a bear wearing a crown, by greg rutkowski", "add(crown, worn by, bear)"},
    {Bear, "bear", "a cartoon bear", "style(bear, cartoon)"},
    {Bear, "bear", "give the whole picture a vintage look", "style(scene, vintage)"},
    {Frog, "frog", "remove the other one", "remove(bear)"},
    {Bear, "bear", "add a hat; on second thought, no hat", "none(already so)"},
    {Bear, "bear", "a red bear under a rainbow", "add(rainbow, above, bear)"},
    {Bear, "bear", "apply a coat of gold to the bear", "material(bear, golden)"},
    {Hat, "bear", "make the bear take off its hat", "remove(hat)"},
    {Bear, "bear", "make a lion out of the bear", "replace(bear, lion)"},
    {Bear, "bear", "I want a unicorn there instead", "replace(bear, unicorn)"},
    {Bear, "bear", "the bear wears nothing", "none(already so)"},
    {Bear, "bear", "do not use red, use blue", "recolour(bear, blue)"},
    {Hat, "bear", "not the bear but the hat should be green", "recolour(hat, green)"},
    {House, "house", "put a wreath on the door of the house", "add(wreath, on, door of house)"},
    {Bear, "bear", "a bear with a wolf to its left", "add(wolf, left of, bear)"},
    {Bear, "bear", "a bear on a pedestal", "add(pedestal, under, bear)"},
    {Bear, "bear", "a chocolate cake next to the bear", "add(cake{chocolate}, beside, bear)"},
    {Bear, "bear", "anime style bear", "style(bear, anime)"},
    {Cars, "", "a yellow car and a blue car", "recolour(car{red}, yellow)"},
    {Bear, "bear", "make the bear from marshmallows", "material(bear, marshmallow)"},
    {Bear, "bear", "change the texture of the bear to wood", "material(bear, wooden)"},
    {Bear, "bear", "put the bear in the desert", "ground(grass, desert)"},
    {Vase, "vase", "give the vase golden stripes", "pattern(vase, striped, golden)"},
    {Hat, "bear", "the bear takes off its hat", "remove(hat)"},
    {Bear, "bear", "a panda, not a bear", "replace(bear, panda)"},
    {Bear, "bear", "replace with a horse", "replace(bear, horse)"},
    {Bear, "bear", "I was hoping you could make the bear yellow", "recolour(bear, yellow)"},
    {Bear, "bear", "make it wooden, then put a hat on it",
     "material(bear, wooden) ; add(hat, worn by, bear)"},
    {Bear, "bear", "a bear with its tongue out", "pose(bear, tongue out)"},
    {Vase, "vase", "a vase painted blue", "recolour(vase, blue)"},
    {Bear, "bear", "a bear with lavender", "add(lavender, beside, bear)"},
    {Bear, "bear", "remove: bear", "remove(bear)"},
    {Bear, "bear", "make: blue", "recolour(bear, blue)"},
    {Bear, "bear", "highly detailed photo of a bear with a hat, dslr", "add(hat, worn by, bear)"},
    {Bear, "bear", "make the background blue", "environment(scene, blue background)"},
    {Bear, "bear", "the bear should stand on its hind legs", "pose(bear, standing on its hind legs)"},
    {Bear, "bear", "make it red... no, blue!", "recolour(bear, blue)"},
    {Hat, "bear", "i don't want the bear to wear a hat", "remove(hat)"},
    {Bear, "bear", "there's a crown on the bear", "add(crown, worn by, bear)"},
    {Bear, "bear", "could i see it in purple?", "recolour(bear, purple)"},
    {Bear, "bear", "make the bear stone and add moss on it", "material(bear, stone) ; add(moss, on, bear)"},
    {Bear, "bear", "a blu bear", "recolour(bear, blue)"},
    {Bear, "bear", "CROWN ON BEAR", "add(crown, worn by, bear)"},
    {Bear, "bear", "photo of a bear, (blue:1.4), snow", "recolour(bear, blue) ; ground(grass, snow)"},
    {Bear, "bear", "low poly bear", "style(bear, low poly)"},
    {Vase, "vase", "a red vase with a lid", "recolour(vase, red) ; add(lid, on, vase)"},
    {Bear, "bear", "make the bear light blue", "recolour(bear, light blue)"},
    {Bear, "bear", "make the bear's surface rough", "material(surface of bear, rough)"},
    {Bear, "bear", "put the bear behind bars", "add(bar[some], in front of, bear)"},
    {Hat, "bear", "off with the hat", "remove(hat)"},
    {Bear, "bear", "I only want the grass", "remove(bear)"},
    {Bear, "bear", "turn around the bear", "transform(bear, rotate 180)"},
    {Bear, "bear", "rotate 45 degrees", "transform(bear, rotate 45)"},
    {Bear, "bear", "a bee is flying around the bear", "add(bee, around, bear)"},
    {Bear, "bear", "sorry, I meant a blue bear", "recolour(bear, blue)"},
    {Bear, "bear", "please do not recolor the bear", "none(nothing asked)"},
    {Bear, "bear", "a green bear in a blue shirt and white shoes on sand",
     "recolour(bear, green) ; ground(grass, sand) ; add(shirt{blue}, worn by, bear) ; add(shoes{white}, worn "
     "by, bear)"},
    {Bear, "bear", "a bear with diamonds on it", "add(diamond[some], on, bear)"},
    {Bear, "bear", "a bear with a berad", "add(beard, worn by, bear)"},
    {Bear, "bear", "put snow", "ground(grass, snow)"},
    {Bear, "bear", "the color of the bear should be red", "none(already so)"},
    {Frog, "frog", "the frog should ride the bear", "transform(frog, move on, bear)"},
    {Bear, "bear", "only the grass please", "remove(bear)"},
    {Bear, "bear", "it would be lovely to have a green bear", "recolour(bear, green)"},
    {Hat, "bear", "I like the hat but make it yellow", "recolour(hat, yellow)"},
    {Bear, "bear", "a bear with purple hands and feet",
     "recolour(hands of bear, purple) ; recolour(feet of bear, purple)"},
    {Bear, "bear", "a slightly greener bear", "recolour(bear, greener)"},
    {Bear, "bear", "replcae the bear with a cta", "replace(bear, cat)"},
    {Bear, "bear", "a stunning photograph of a golden bear, golden hour, 85mm",
     "material(bear, golden) ; environment(scene, golden hour)"},
    {Bear, "bear", "a bear in the dark", "environment(scene, dark)"},
    {Bear, "bear", "put the bear in a meadow", "none(already so)"},
    {Hat, "bear", "throw the hat away", "remove(hat)"},
    {Bear, "bear", "a geen bear", "recolour(bear, green)"},
    {Bear, "bear", "wearing a crown", "add(crown, worn by, bear)"},
    {Bear, "bear", "a bear with long, white, curly hair",
     "transform(hair of bear, longer) ; recolour(hair of bear, white) ; alter(hair of bear, curly)"},
    {Bear, "bear", "a bear wearing a hat hat", "add(hat, worn by, bear)"},
    {Bear, "bear", "a blue blue bear", "recolour(bear, blue)"},
    {Bear, "bear", "paint the bear in the color blue", "recolour(bear, blue)"},
    {Bear, "bear", "I want that the bear has a hat", "add(hat, worn by, bear)"},
    {Bear, "bear", "give to the bear a crown", "add(crown, worn by, bear)"},
    {Bear, "bear", "a photo of sks bear wearing a hat", "add(hat, worn by, bear)"},
    {Bear, "bear", "blue bear, lens flare, cinematic, dramatic", "recolour(bear, blue)"},
    {Bear, "bear", "a blue bear, background blur", "recolour(bear, blue)"},
    {Bear, "bear", "put the bear on a marble floor", "ground(grass, floor{marble})"},
    {Bear, "bear", "make the lawn look like a desert", "ground(grass, desert)"},
    {Bear, "bear", "the bear is not blue", "none(already so)"},
    {Bear, "bear", "a golden bear, vivid, ultra hd", "material(bear, golden)"},
};

/// Sentences that a greedy reading takes for another order; the plan says that they are not understood.
const Case Refused[] = {
    {Bears, "bear", "one blue bear and one green bear", "refuse(ambiguous)"},
    {Sofa, "", "a cushion on the sofa and a rug under it", "refuse(not a sentence)"},
    {Bear, "bear", "a blue bare", "refuse(not a sentence)"},
    {Bear, "bear",
     "I know you cannot see the back of the bear in this picture, but if you could paint the whole of it in "
     "one single dark green, that would be perfect.",
     "refuse(not an edit)"},
    {Bear, "bear", "a bear and a rabbit holding hands", "refuse(not a sentence)"},
    {Bear, "bear", "\"make the bear blue\", he said", "refuse(not a sentence)"},
    {Bear, "bear", "a crown would look nice on the bear", "refuse(not a sentence)"},
    {Man, "man", "make the man smile and wave", "refuse(not a sentence)"},
    {Bear, "bear", "make the bear the same size as a mouse", "refuse(not a sentence)"},
};

std::string planned(const Case& each) {
    return to_string(plan::plan_sentence(each.sentence, plan::scene_words(each.scene), each.source));
}

}  // namespace

DOCTEST_TEST_CASE("sentences of many forms come to the plans that a careful person reads") {
    for (const auto& each : Read) {
        const std::string typed = each.sentence;
        DOCTEST_CAPTURE(typed);
        DOCTEST_CHECK(planned(each) == each.plan);
    }
}

DOCTEST_TEST_CASE("a sentence of which a word is in no step is refused") {
    for (const auto& each : Refused) {
        const std::string typed = each.sentence;
        DOCTEST_CAPTURE(typed);
        DOCTEST_CHECK(planned(each) == each.plan);
    }
}

}  // namespace scene_sentences_test
