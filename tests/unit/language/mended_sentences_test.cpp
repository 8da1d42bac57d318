// Sentences that the planner once read wrongly or refused, and those that it must refuse.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <string>

#include "engine/language/plan/plan_sentence.h"

namespace mended_sentences_test {

namespace {

using namespace gse::language;

struct Case {
    const char *scene, *source, *sentence, *plan;
};

const Case Mended[] = {
    {"brown horse; meadow", "horse", "horse w/ golden mane", "material(mane of horse, golden)"},
    {"brown horse; meadow", "horse", "make everything but the horse black and white",
     "recolour(scene except horse, black and white)"},
    {"gray cat; blue sofa; wooden floor", "cat", "cat wearing a tiny wizard hat and holding a wand",
     "add(wizard hat{tiny}, worn by, cat) ; add(wand, held by, cat)"},
    {"gray cat; blue sofa; wooden floor", "cat", "replace the floor with marble tiles",
     "ground(floor, tiles{marble})"},
    {"gray cat; blue sofa; wooden floor", "cat", "only the tail, make it black",
     "recolour(tail of cat, black)"},
    {"red car; house; road", "car", "car w/ black rims and tinted windows",
     "recolour(rims of car, black) ; alter(windows of car, tinted)"},
    {"red car; house; road", "car", "the car is parked on a beach", "ground(road, beach)"},
    {"red car; house; road", "car", "neither the car nor the house should change", "none(nothing asked)"},
    {"woman; white dress; brown hair; garden", "woman", "make her older, w/ gray hair",
     "alter(woman, older) ; recolour(hair, gray)"},
    {"woman; white dress; brown hair; garden", "woman", "a floral dress instead of the white one",
     "pattern(dress, floral)"},
    {"wooden table; white vase; green bottle; tiles", "vase", "make the vase as big as the bottle",
     "transform(vase, same size as, bottle)"},
    {"wooden table; white vase; green bottle; tiles", "table", "table with a checkered tablecloth",
     "add(tablecloth{checkered}, on, table)"},
    {"wooden table; white vase; green bottle; tiles", "table", "a round glass table",
     "alter(table, round) ; material(table, glass)"},
    {"wooden table; white vase; green bottle; tiles", "vase", "fill the vase w/ sand", "add(sand, in, vase)"},
    {"wooden table; white vase; green bottle; tiles", "vase", "everything should be blue except the bottle",
     "recolour(scene except bottle, blue)"},
    {"wooden table; white vase; green bottle; tiles", "vase", "knock over the vase",
     "pose(vase, knocked over)"},
    {"stone statue; ivy; pavement", "statue", "break off the statue's left arm",
     "remove(arm{left} of statue)"},
    {"red apple; green apple; yellow banana; plate", "banana", "peel the banana", "alter(banana, peeled)"},
    {"red apple; green apple; yellow banana; plate", "banana", "a riper banana", "alter(banana, riper)"},
    {"red apple; green apple; yellow banana; plate", "banana", "remove every fruit but the banana",
     "remove(apple[all])"},
    {"teddy bear; wooden chair; rug", "chair", "an armchair instead", "replace(chair, armchair)"},
    {"teddy bear; wooden chair; rug", "rug", "persian rug", "alter(rug, persian)"},
    {"teddy bear; wooden chair; rug", "teddy bear", "add a book, a cup of tea and a lamp next to the chair",
     "add(book, beside, chair) ; add(cup of tea, beside, chair) ; add(lamp, beside, chair)"},
    {"teddy bear; wooden chair; rug", "teddy bear", "lift the bear up by 20 cm",
     "transform(teddy bear, move up 20 cm)"},
    {"truck; crane; mud", "truck", "bigger wheels on the truck", "transform(wheels of truck, bigger)"},
    {"truck; crane; mud", "truck", "dirty truck, muddy tires",
     "material(truck, dirty) ; material(tires of truck, muddy)"},
    {"truck; crane; mud", "truck", "make it so the truck is facing right", "transform(truck, face right)"},
    {"truck; crane; mud", "truck", "shrink the truck to a quarter of its size",
     "transform(truck, scale 0.25)"},
    {"truck; crane; mud", "truck", "truck loaded w/ logs", "add(log[some], on, truck)"},
    {"penguin; ice", "penguin", "a family of penguins", "duplicate(penguin, some)"},
    {"brown dog; lawn", "dog", "floppier ears", "alter(ears of dog, floppier)"},
    {"brown dog; lawn", "dog", "the lawn needs some daisies", "add(daisy[some], on, lawn)"},
    {"brown dog; lawn", "dog", "everything but the dog in black and white",
     "recolour(scene except dog, black and white)"},
    {"yellow boat; water; wooden pier", "boat", "paint a red stripe on the boat",
     "pattern(boat, striped, red)"},
    {"yellow boat; water; wooden pier", "pier", "the pier's planks should be painted white",
     "recolour(planks of pier, white)"},
    {"yellow boat; water; wooden pier", "boat", "foggy morning", "environment(scene, foggy morning)"},
    {"robot; stone floor", "robot", "make the robot's eyes glow red",
     "material(eyes of robot, glowing) ; recolour(eyes of robot, red)"},
    {"robot; stone floor", "robot", "rusty robot w/ a missing arm",
     "material(robot, rusty) ; remove(arm of robot)"},
    {"robot; stone floor", "robot", "carpet instead of the stone floor", "ground(floor, carpet)"},
    {"robot; stone floor", "robot", "add wheels instead of legs", "replace(legs of robot, wheel[some])"},
    {"white church; green trees; gravel", "church", "autumn trees", "alter(trees, autumn)"},
    {"white church; green trees; gravel", "church", "the church in ruins", "alter(church, in ruins)"},
    {"white church; green trees; gravel", "church", "add a clock to the tower of the church",
     "add(clock, on, tower of church)"},
    {"white church; green trees; gravel", "church", "at golden hour, long shadows",
     "environment(scene, golden hour) ; environment(scene, long shadows)"},
    {"white church; green trees; gravel", "church", "birds circling above the church",
     "add(bird[some], above, church)"},
    {"birthday cake; wooden table", "cake", "paint the table legs gold & the top white",
     "recolour(legs of table, golden) ; recolour(top of table, white)"},
    {"knight; silver armor; castle; grass", "knight", "the knight wields a flaming sword",
     "add(sword{flaming}, held by, knight)"},
    {"knight; silver armor; castle; grass", "castle", "add flags to the castle's towers",
     "add(flag[some], on, towers of castle)"},
    {"knight; silver armor; castle; grass", "castle", "remove everything besides the castle and the grass",
     "remove(knight)"},
    {"knight; silver armor; castle; grass", "knight", "a dragon flying above the castle",
     "add(dragon, above, castle)"},
    {"lamp; blue book; red book; wooden desk; carpet", "desk",
     "add a laptop, a mug and some pens to the desk",
     "add(laptop, on, desk) ; add(mug, on, desk) ; add(pen[some], on, desk)"},
    {"dinosaur; sand", "dinosaur", "baby dinosaurs around the dinosaur",
     "add(dinosaur[some]{baby}, around, dinosaur)"},
    {"dinosaur; sand", "dinosaur", "make it breathe fire", "pose(dinosaur, breathing fire)"},
    {"dinosaur; sand", "dinosaur", "dinosaur w/o tail", "remove(tail of dinosaur)"},
    {"red bicycle; brick wall; pavement", "bicycle", "graffiti on the wall", "add(graffiti, on, wall)"},
    {"red bicycle; brick wall; pavement", "bicycle", "wrap the bike in christmas lights",
     "add(christmas lights, on, bicycle)"},
    {"girl; yellow raincoat; umbrella; street", "girl", "recolor her coat to navy",
     "recolour(raincoat, navy)"},
    {"girl; yellow raincoat; umbrella; street", "girl", "anime girl, big eyes, pink hair",
     "transform(eyes of girl, bigger) ; recolour(hair of girl, pink) ; style(girl, anime)"},
    {"girl; yellow raincoat; umbrella; street", "umbrella", "make it 50% bigger",
     "transform(umbrella, scale 1.5)"},
    {"girl; yellow raincoat; umbrella; street", "umbrella", "rainbow coloured umberlla",
     "pattern(umbrella, rainbow)"},
    {"black piano; wooden stool; wooden floor; window", "piano",
     "put a metronome and a candelabra on the piano",
     "add(metronome, on, piano) ; add(candelabra, on, piano)"},
    {"black piano; wooden stool; wooden floor; window", "stool", "a chair in place of the stool, please!",
     "replace(stool, chair)"},
    {"black piano; wooden stool; wooden floor; window", "window", "round window", "alter(window, round)"},
    {"black piano; wooden stool; wooden floor; window", "piano", "turn the piano toward the window",
     "refuse(not a sentence)"},
    {"black piano; wooden stool; wooden floor; window", "piano", "piano keys in rainbow colors",
     "pattern(keys of piano, rainbow)"},
    {"black piano; wooden stool; wooden floor; window", "piano", "marble floor", "material(floor, marble)"},
    {"black piano; wooden stool; wooden floor; window", "piano", "a dusty, old piano with missing keys",
     "material(piano, dusty) ; alter(piano, old) ; remove(keys of piano)"},
    {"white snowman; black hat; snow", "snowman", "three snowmen in a row", "duplicate(snowman, 3)"},
    {"green frog; lily pad; pond", "frog", "remove all but the frog", "remove(scene except frog)"},
    {"green frog; lily pad; pond", "frog", "would look better in purple", "recolour(frog, purple)"},
    {"white bed; gray pillow; wooden nightstand; carpet", "bed", "four-poster bed",
     "alter(bed, four-poster)"},
    {"white bed; gray pillow; wooden nightstand; carpet", "bed", "a cat curled up on the pillow",
     "add(cat, on, pillow)"},
    {"white bed; gray pillow; wooden nightstand; carpet", "bed", "king size bed", "alter(bed, king size)"},
    {"blue bus; bus stop; old man; street", "man", "give him a cane and a flat cap",
     "add(cane, held by, man) ; add(flat cap, worn by, man)"},
    {"blue bus; bus stop; old man; street", "bus", "hide the man behind the bus",
     "transform(man, move behind, bus)"},
    {"blue bus; bus stop; old man; street", "bus", "rainy evening, neon lights",
     "environment(scene, rainy evening) ; environment(scene, neon lights)"},
    {"castle; moat; stone bridge; grass", "castle", "make the bridge wooden and twice as long",
     "material(bridge, wooden) ; transform(bridge, longer)"},
    {"castle; moat; stone bridge; grass", "castle", "fill in the moat with flowers",
     "add(flower[some], in, moat)"},
    {"castle; moat; stone bridge; grass", "castle", "flags on the towers",
     "add(flag[some], on, towers of castle)"},
    {"white goat; fence; lawn", "goat", "remove its horns but keep the beard", "remove(horns of goat)"},
    {"black guitar; amp; wooden stage", "guitar", "the guitars neck should be maple",
     "material(neck of guitar, maple)"},
    {"purple octopus; rock; sand", "octopus", "put the octopus's head on the rock", "refuse(ambiguous)"},
    {"queen; golden crown; red dress; throne; carpet", "queen", "a silver crown, not a golden one",
     "material(crown, silver)"},
    {"queen; golden crown; red dress; throne; carpet", "throne", "wooden throne w/ a purple cushion on it",
     "material(throne, wooden) ; add(cushion{purple}, on, throne)"},
    {"gray elephant; savanna; tree", "elephant", "baby elephant next to the elephant",
     "add(elephant{baby}, beside, elephant)"},
    {"blue bird; birdcage; table", "bird", "open the cage door", "pose(door of birdcage, open)"},
    {"blue bird; birdcage; table", "bird", "make the birds wings green and its beak orange",
     "recolour(wings of bird, green) ; recolour(beak of bird, orange)"},
    {"blue bird; birdcage; table", "bird", "remove cage", "remove(birdcage)"},
    {"blue bird; birdcage; table", "bird", "golden cage, wooden table",
     "material(birdcage, golden) ; material(table, wooden)"},
    {"ship; sea; lighthouse", "ship", "don't move the ship, just paint it dark green",
     "recolour(ship, dark green)"},
};

const char* const CarAndHouse = "red car; house; road";

/// Sentences about a car before a house that leave a word unread, or name no thing.
const char* const Unread[] = {"kermit",
                              "the car's bumper should be zoll",
                              "remove everything but the zoll",
                              "turn the car toward the house",
                              "stack the cars and the zolls",
                              "make the car blue except the roof"};

std::string planned(const std::string& sentence, const char* scene, const char* source) {
    return to_string(plan::plan_sentence(sentence, plan::scene_words(scene), source));
}

}  // namespace

DOCTEST_TEST_CASE(
    "sentences that were read wrongly or refused come to the plans that a careful person reads") {
    for (const auto& [scene, source, sentence, plan] : Mended) {
        const std::string typed = sentence;
        DOCTEST_CAPTURE(typed);
        DOCTEST_CHECK(planned(typed, scene, source) == plan);
    }
}

DOCTEST_TEST_CASE("what is excepted is never changed, whatever the order") {
    const std::pair<std::string, std::string> Orders[] = {
        {"make everything", "blue"}, {"everything should be", "blue"}, {"paint everything", "blue"}};
    for (const std::string except : {"except", "but", "apart from"})
        for (const auto& [order, how] : Orders)
            for (const bool behind : {false, true}) {
                const std::string thing = " " + except + " the house";
                const auto typed = behind ? order + " " + how + thing
                                   : order.starts_with("everything")
                                       ? "everything" + thing + " should be " + how
                                       : order + thing + " " + how;
                DOCTEST_CAPTURE(typed);
                DOCTEST_CHECK(planned(typed, CarAndHouse, "car") == "recolour(scene except house, blue)");
            }
    for (const std::string except : {"except", "but", "besides"}) {
        const auto typed = "remove everything " + except + " the car and the road";
        DOCTEST_CAPTURE(typed);
        DOCTEST_CHECK(planned(typed, CarAndHouse, "car") == "remove(house)");
    }
}

DOCTEST_TEST_CASE("a sentence with a word that is not read is refused") {
    for (const std::string typed : Unread) {
        DOCTEST_CAPTURE(typed);
        DOCTEST_CHECK(planned(typed, CarAndHouse, "car").find("refuse(") != std::string::npos);
    }
}

}  // namespace mended_sentences_test
