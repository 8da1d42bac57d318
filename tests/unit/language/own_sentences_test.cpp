// Sentences of our own about many scenes, and what changes no plan: courtesy, and an order beside it.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "engine/language/plan/plan_sentence.h"

namespace own_sentences_test {

namespace {

using namespace gse::language;

const char* const RedBear = "red bear; grass";

plan::Plan planned(const std::string& sentence, const char* scene = RedBear, const char* source = "bear") {
    return plan::plan_sentence(sentence, plan::scene_words(scene), source);
}

struct Case {
    const char *scene, *source, *sentence, *plan;
};

const Case Cases[] = {
    {"dog; lawn", "dog", "paint the dog green", "recolour(dog, green)"},
    {"wooden chair; rug", "chair", "the chair should be dark blue please", "recolour(chair, dark blue)"},
    {"wooden chair; rug", "chair", "chair made out of marble", "material(chair, marble)"},
    {"car; road", "car", "a rusty old car", "material(car, rusty) ; alter(car, old)"},
    {"man; blue jacket; street", "man", "give the man a mustache and sunglasses",
     "add(mustache, worn by, man) ; add(sunglasses, worn by, man)"},
    {"man; blue jacket; street", "man", "make his jacket leather", "material(jacket, leather)"},
    {"man; blue jacket; street", "man", "the man is holding a sword", "add(sword, held by, man)"},
    {"man; blue jacket; street", "man", "remove his jacket", "remove(jacket)"},
    {"statue; stone floor", "statue", "cover the statue with ivy", "add(ivy, on, statue)"},
    {"statue; stone floor", "statue", "turn the statue to bronze", "material(statue, bronze)"},
    {"statue; stone floor", "statue", "a pigeon on the statue's head", "add(pigeon, on, head of statue)"},
    {"statue; stone floor", "statue", "put a fountain next to the statue", "add(fountain, beside, statue)"},
    {"white vase; table", "vase", "make the vase taller and put roses in it",
     "transform(vase, taller) ; add(rose[some], in, vase)"},
    {"white vase; table", "vase", "replace the vase with a teapot", "replace(vase, teapot)"},
    {"red car; blue car; road", "car", "make the red car yellow", "recolour(car{red}, yellow)"},
    {"red car; blue car; road", "car", "delete the blue one", "remove(car{blue})"},
    {"house; garden", "house", "give the house a red roof", "recolour(roof of house, red)"},
    {"house; garden", "house", "paint the door of the house green", "recolour(door of house, green)"},
    {"house; garden", "house", "make it an igloo", "replace(house, igloo)"},
    {"house; garden", "house", "add a chimney to the house", "add(chimney, on, house)"},
    {"cat; sofa", "cat", "let the cat wear a bow tie", "add(bow tie, worn by, cat)"},
    {"cat; sofa", "cat", "a black cat sleeping on the sofa", "recolour(cat, black) ; pose(cat, sleeping)"},
    {"red bear; grass", "bear", "at sunset", "environment(scene, sunset)"},
    {"red bear; grass", "bear", "make it rainy", "environment(scene, rain)"},
    {"red bear; grass", "bear", "what if it were winter?", "environment(scene, winter)"},
    {"red bear; grass", "bear", "make everything look like a charcoal drawing",
     "style(scene, charcoal drawing)"},
    {"red bear; grass", "bear", "bear, blue, shiny", "recolour(bear, blue) ; material(bear, shiny)"},
    {"red bear; grass", "bear", "blue bear, top hat, monocle",
     "recolour(bear, blue) ; add(top hat, worn by, bear) ; add(monocle, worn by, bear)"},
    {"red bear; grass", "bear", "a plush bear", "material(bear, plush)"},
    {"red bear; grass", "bear", "I'd love to see the bear in a tutu", "add(tutu, worn by, bear)"},
    {"red bear; grass", "bear", "could the bear be yellow instead of red", "recolour(bear, yellow)"},
    {"red bear; grass", "bear", "not blue but green please", "recolour(bear, green)"},
    {"red bear; grass", "bear", "no changes", "none(nothing asked)"},
    {"red bear; grass", "bear", "leave it like that", "none(nothing asked)"},
    {"red bear; grass", "bear", "do not remove the bear", "none(nothing asked)"},
    {"red bear; grass", "bear", "keep the bear but make the grass yellow", "recolour(grass, yellow)"},
    {"red bear; grass", "bear", "everything but the bear should be gray",
     "recolour(scene except bear, gray)"},
    {"red bear; grass", "bear", "a gren bear", "recolour(bear, green)"},
    {"red bear; grass", "bear", "giv the bear a sacrf", "add(scarf, worn by, bear)"},
    {"red bear; grass", "bear", "turn the bear into a pengiun", "replace(bear, penguin)"},
    {"red bear; grass", "bear", "a bear waering a helmet", "add(helmet, worn by, bear)"},
    {"red bear; grass", "bear", "add two balloons above the bear", "add(balloon[2], above, bear)"},
    {"red bear; grass", "bear", "three butterflies around the bear", "add(butterfly[3], around, bear)"},
    {"red bear; grass", "bear", "I want five bears", "duplicate(bear, 5)"},
    {"red bear; grass", "bear", "clone the bear", "duplicate(bear, 2)"},
    {"red bear; grass", "bear", "shift the bear a little to the right", "transform(bear, move right)"},
    {"red bear; grass", "bear", "turn it by 45 degrees", "transform(bear, rotate 45)"},
    {"red bear; grass", "bear", "flip the bear upside down", "transform(bear, flip)"},
    {"red bear; grass", "bear", "lift the bear 1 meter", "transform(bear, move up 1 m)"},
    {"red bear; grass", "bear", "make the bear look to the left", "transform(bear, face left)"},
    {"red bear; grass", "bear", "the bear stands on a wooden floor", "ground(grass, floor{wooden})"},
    {"red bear; grass", "bear", "swap the grass for lava", "ground(grass, lava)"},
    {"red bear; grass", "bear", "a bear riding a bicycle", "add(bicycle, ridden by, bear)"},
    {"red bear; grass", "bear", "a bear in a spacesuit", "add(spacesuit, worn by, bear)"},
    {"red bear; grass", "bear", "make the bear into an astronaut", "replace(bear, astronaut)"},
    {"red bear; grass", "bear", "make the bear smile", "pose(bear, smile)"},
    {"red bear; grass", "bear", "make him look scary", "alter(bear, scary)"},
    {"red bear; grass", "bear", "give it blue eyes", "recolour(eyes of bear, blue)"},
    {"red bear; grass", "bear", "a bear with a white belly", "recolour(belly of bear, white)"},
    {"red bear; grass", "bear", "paint the left ear pink and the right ear purple",
     "recolour(ear{left} of bear, pink) ; recolour(ear{right} of bear, purple)"},
    {"red bear; grass", "bear", "dye its feet and paws black",
     "recolour(feet of bear, black) ; recolour(paws of bear, black)"},
    {"red bear; grass", "bear", "remove the bear's ears", "remove(ears of bear)"},
    {"red bear; blue hat; grass", "bear", "make the hat bigger", "transform(hat, bigger)"},
    {"red bear; blue hat; grass", "bear", "take off its hat", "remove(hat)"},
    {"red bear; blue hat; grass", "bear", "a bear without a hat", "remove(hat)"},
    {"red bear; blue hat; grass", "bear", "swap the hat for a crown", "replace(hat, crown)"},
    {"red bear; blue hat; grass", "bear", "no hat, no scarf", "remove(hat)"},
    {"red bear; blue hat; grass", "hat", "a green hat", "recolour(hat, green)"},
    {"bear; dog; grass", "bear", "put the dog to the left of the bear", "transform(dog, move left of, bear)"},
    {"bear; dog; grass", "bear", "the dog is blue and the bear is green",
     "recolour(dog, blue) ; recolour(bear, green)"},
    {"bear; dog; grass", "bear", "remove the dog and give the bear a collar",
     "remove(dog) ; add(collar, worn by, bear)"},
    {"bear; dog; grass", "bear", "make the dog the same size as the bear",
     "transform(dog, same size as, bear)"},
    {"bear; dog; grass", "bear", "only the dog should stay", "remove(bear)"},
    {"flower pot; shelf; book[some]", "pot", "a cactus in the flower pot", "add(cactus, in, flower pot)"},
    {"horse; field", "horse", "turn the horse into a unicorn", "replace(horse, unicorn)"},
    {"horse; field", "horse", "the horse should have wings like pegasus", "add(wings, worn by, horse)"},
    {"horse; field", "horse", "a zebra", "replace(horse, zebra)"},
    {"horse; field", "horse", "brown horse with a white mane",
     "recolour(horse, brown) ; recolour(mane of horse, white)"},
    {"person; jeans; white shirt; park", "person", "make her older", "alter(person, older)"},
    {"person; jeans; white shirt; park", "person", "she should be sitting", "pose(person, sitting)"},
    {"teapot; wooden table", "teapot", "make the teapot purple", "recolour(teapot, purple)"},
    {"teapot; wooden table", "teapot", "put a lemon beside the teapot", "add(lemon, beside, teapot)"},
    {"teapot; wooden table", "teapot", "remove the lid", "remove(lid of teapot)"},
    {"bench; park; trash can", "bench", "get rid of the trash can", "remove(trash can)"},
    {"bench; park; trash can", "bench", "paint the bench white and the trash can green",
     "recolour(bench, white) ; recolour(trash can, green)"},
    {"bench; park; trash can", "bench", "move the trash can behind the bench",
     "transform(trash can, move behind, bench)"},
    {"bench; park; trash can", "bench", "the bench is longer", "transform(bench, longer)"},
    {"bicycle; wall; street", "bicycle", "hang a basket on the bicycle", "add(basket, on, bicycle)"},
    {"bicycle; wall; street", "bicycle", "turn the bicycle into a motorbike", "replace(bicycle, motorbike)"},
    {"bicycle; wall; street", "bicycle", "mirror the bicycle", "transform(bicycle, mirror)"},
    {"woman; red dress; beach", "woman", "make her dress blue", "recolour(dress, blue)"},
    {"woman; red dress; beach", "woman", "a mermaid", "replace(woman, mermaid)"},
    {"woman; red dress; beach", "woman", "the dress with white dots", "pattern(dress, spotted, white)"},
    {"woman; red dress; beach", "woman", "without the dress", "remove(dress)"},
    {"tractor; farm", "tractor", "paint the tractor bright green", "recolour(tractor, bright green)"},
    {"tractor; farm", "tractor", "the tractor's tires should be white", "recolour(tires of tractor, white)"},
    {"tractor; farm", "tractor", "a scarecrow to the right of the tractor",
     "add(scarecrow, right of, tractor)"},
    {"tractor; farm", "tractor", "put hay bales behind the tractor", "add(hay bale[some], behind, tractor)"},
    {"tractor; farm", "tractor", "make it look abandoned", "alter(tractor, abandoned)"},
    {"armchair; green pillow; carpet", "armchair", "throw away the pillow", "remove(pillow)"},
    {"armchair; green pillow; carpet", "armchair", "change the pillow's color from green to orange",
     "recolour(pillow, orange)"},
    {"armchair; green pillow; carpet", "armchair", "leather armchair", "material(armchair, leather)"},
    {"armchair; green pillow; carpet", "armchair", "the armchair in zebra print", "pattern(armchair, zebra)"},
    {"lion; savanna", "lion", "the lion is roaring", "pose(lion, roaring)"},
    {"lion; savanna", "lion", "swap the lion with a tiger", "replace(lion, tiger)"},
    {"lion; savanna", "lion", "a snow leopard in the savanna", "replace(lion, snow leopard)"},
    {"lion; savanna", "lion", "no lion anymore", "remove(lion)"},
    {"lion; savanna", "lion", "put a zebra far behind the lion", "add(zebra, behind, lion)"},
    {"cake; plate", "cake", "put five candles on the cake", "add(candle[5], on, cake)"},
    {"cake; plate", "cake", "pink frosting on top", "add(frosting{pink}, on, cake)"},
    {"cake; plate", "cake", "make the plate square", "alter(plate, square)"},
    {"boy; skateboard; street", "boy", "he wears a green hoodie and ripped jeans",
     "add(hoodie{green}, worn by, boy) ; add(jeans{ripped}, worn by, boy)"},
    {"boy; skateboard; street", "boy", "make the skateboard longer and purple",
     "transform(skateboard, longer) ; recolour(skateboard, purple)"},
    {"boy; skateboard; street", "boy", "a girl instead", "replace(boy, girl)"},
    {"red bear; grass", "bear", "give the bear wings", "add(wings, worn by, bear)"},
    {"red bear; grass", "bear", "move the bear up", "transform(bear, move up)"},
    {"red bear; grass", "bear", "change the color of the bear to blue", "recolour(bear, blue)"},
    {"red bear; grass", "bear", "give it a violet color", "recolour(bear, violet)"},
    {"red bear; grass", "bear", "make the bear violet", "recolour(bear, violet)"},
    {"red bear; grass", "bear", "can the bear be blue?", "recolour(bear, blue)"},
    {"red bear; grass", "bear", "the bear is holding balloons", "add(balloon[some], held by, bear)"},
    {"red bear; grass", "bear", "a red bear in a hood", "add(hood, worn by, bear)"},
    {"red bear; grass", "bear", "convert the scene to a cartoon", "style(scene, cartoon)"},
    {"red bear; grass", "bear", "the bear in the style of picasso", "style(bear, picasso)"},
    {"red bear; grass", "bear", "make the bear's eas pink", "refuse(not a sentence)"},
};

const char* const Orders[] = {"make the bear blue",        "give the bear a hat",
                              "remove the bear",           "turn the bear into a cat",
                              "put the bear on snow",      "make the bear's ears pink",
                              "move the bear to the left", "make it night",
                              "set the bear on fire",      "add two balls behind the bear"};
/// "{}" stands for the order.
const char* const Courtesies[] = {"please {}",
                                  "{}, thanks",
                                  "could you {}?",
                                  "i'd like you to {}",
                                  "let's {}",
                                  "hey, {}",
                                  "would it be possible to {}",
                                  "we have to {}",
                                  "how about you {}",
                                  "{}, 4k, highly detailed",
                                  "1. {}",
                                  "next, {}"};
const char* const Joints[] = {" and ", ". ", "; ", ", then ", ". after that ", " and also "};

std::string with(std::string text, const std::string& order) {
    return text.replace(text.find("{}"), 2, order);
}

std::vector<std::string> steps_of(const plan::Plan& plan) {
    std::vector<std::string> steps;
    for (const auto& step : plan.steps) steps.push_back(to_string(step));
    std::sort(steps.begin(), steps.end());
    return steps;
}

}  // namespace

DOCTEST_TEST_CASE("sentences of our own come to the plans that a careful person reads") {
    for (const auto& [scene, source, sentence, plan] : Cases) {
        const std::string typed = sentence;
        DOCTEST_CAPTURE(typed);
        DOCTEST_CHECK(to_string(planned(typed, scene, source)) == plan);
    }
}

DOCTEST_TEST_CASE("courtesy and noise around an order change nothing of its plan") {
    for (const std::string order : Orders)
        for (const auto* courtesy : Courtesies) {
            const auto typed = with(courtesy, order);
            DOCTEST_CAPTURE(typed);
            DOCTEST_CHECK(planned(typed) == planned(order));
        }
}

DOCTEST_TEST_CASE("two orders in one sentence are the steps of both") {
    const std::pair<std::string, std::string> Pairs[] = {
        {"make the bear blue", "add a tree next to the bear"},
        {"paint the grass yellow", "make the bear golden"},
        {"make the bear's ears pink", "give the bear a hat"},
        {"move the bear to the left", "make the bear bigger"},
        {"put the bear on snow", "make it night"}};
    for (const auto& [first, second] : Pairs)
        for (const std::string joint : Joints) {
            const auto typed = first + joint + second;
            DOCTEST_CAPTURE(typed);
            auto both = steps_of(planned(first));
            for (auto& step : steps_of(planned(second))) both.push_back(std::move(step));
            std::sort(both.begin(), both.end());
            DOCTEST_CHECK(steps_of(planned(typed)) == both);
        }
}

}  // namespace own_sentences_test
