// Tables of English words; nothing but data and the look-up of it.
#include "engine/language/lexicon.h"

#include <algorithm>
#include <array>
#include <unordered_map>
#include <utility>

namespace gse::language {
namespace {

struct ClassList {
    WordClass word_class;
    std::string_view words;  // a blank between them
};

constexpr ClassList Classes[] = {
    {WordClass::IndefiniteArticle, "a an"},
    {WordClass::DefiniteArticle, "the"},
    {WordClass::Possessive, "its his her their"},
    {WordClass::Demonstrative, "some this that"},
    {WordClass::Caption, "photo picture of"},
    {WordClass::Pronoun, "it him her them itself himself herself"},
    {WordClass::Joiner, "wearing with holding has having carrying plus and made into as"},
    {WordClass::Stop,
     "on in at under beside near behind over by from to is of standing sitting lying turned changed"},
    {WordClass::Turning, "made of into as"},
    {WordClass::Having, "wearing with has having holding carrying in"},
    {WordClass::Beside, "wearing with and holding has having on under beside near carrying plus to behind"},
    {WordClass::Contentless, "add remove without no turn make it front side back left right view"},
    {WordClass::MakingVerb, "make turn paint colour color dye"},
    {WordClass::Copula, "is are becomes looks turns"},
    {WordClass::Colour, "red blue green yellow purple orange black white pink brown grey gray"},
    {WordClass::Material,
     "wooden wood stone golden gold silver metal metallic bronze copper iron steel glass marble clay wax "
     "plastic paper leather"},
    {WordClass::State, "rusty furry shiny old new tiled"},
    {WordClass::Ground,
     "grass sand snow water tiles floor lake ground lawn meadow field beach sea ocean river ice street road "
     "gravel mud soil earth carpet rug desert forest sky pavement asphalt concrete background"}};

constexpr std::pair<std::string_view, Relation> Prepositions[] = {{"above", Relation::Above},
                                                                  {"alongside", Relation::Beside},
                                                                  {"atop", Relation::Above},
                                                                  {"before", Relation::Before},
                                                                  {"behind", Relation::Behind},
                                                                  {"below", Relation::Under},
                                                                  {"beneath", Relation::Under},
                                                                  {"beside", Relation::Beside},
                                                                  {"by", Relation::Beside},
                                                                  {"close to", Relation::Beside},
                                                                  {"in back of", Relation::Behind},
                                                                  {"in front of", Relation::Before},
                                                                  {"left of", Relation::Left},
                                                                  {"near", Relation::Beside},
                                                                  {"next to", Relation::Beside},
                                                                  {"on", Relation::Above},
                                                                  {"on the left of", Relation::Left},
                                                                  {"on the right of", Relation::Right},
                                                                  {"on top of", Relation::Above},
                                                                  {"over", Relation::Above},
                                                                  {"right of", Relation::Right},
                                                                  {"to the left of", Relation::Left},
                                                                  {"to the right of", Relation::Right},
                                                                  {"under", Relation::Under},
                                                                  {"underneath", Relation::Under},
                                                                  {"upon", Relation::Above}};

struct PlaceList {
    std::string_view place, things;
};

constexpr PlaceList Places[] = {{"top", "hat crown cap helmet horns antlers halo headphones"},
                                {"front", "sunglasses glasses moustache mask"},
                                {"neck", "scarf necklace collar tie beard bow"},
                                {"around", "flames fire smoke wings snow"}};

/// Words of one meaning stand in one line; lines of one kind follow each other.
struct Meaning {
    std::string_view kind, words;
};

constexpr Meaning Meanings[] = {
    {"animal", "bear cub teddy grizzly panda"},
    {"animal", "dog puppy hound poodle spaniel terrier wolf"},
    {"animal", "cat kitten kitty tomcat"},
    {"animal", "duck duckling goose swan"},
    {"animal", "rabbit bunny hare"},
    {"animal", "bird chicken hen rooster parrot eagle owl penguin pigeon crow raven"},
    {"animal", "horse pony donkey zebra mule"},
    {"animal", "cow bull ox calf bison"},
    {"animal", "sheep lamb goat ram"},
    {"animal", "lion tiger leopard panther"},
    {"animal", "fox mouse rat squirrel hamster hedgehog"},
    {"animal", "pig boar hog piglet"},
    {"animal", "elephant giraffe rhino hippo camel"},
    {"animal", "monkey ape gorilla"},
    {"animal", "frog toad turtle lizard crocodile snake dinosaur dragon"},
    {"animal", "fish shark whale dolphin"},
    {"person", "man boy guy gentleman male"},
    {"person", "woman girl lady female"},
    {"person", "person child kid human baby people figure"},
    {"vehicle", "car automobile auto sedan taxi vehicle"},
    {"vehicle", "truck lorry van bus pickup"},
    {"vehicle", "bike bicycle motorcycle motorbike scooter"},
    {"vehicle", "boat ship yacht canoe"},
    {"vehicle", "train tram locomotive"},
    {"vehicle", "plane aeroplane airplane aircraft jet"},
    {"seat", "chair armchair seat"},
    {"seat", "sofa couch settee"},
    {"seat", "stool bench"},
    {"furniture", "table desk"},
    {"furniture", "bed cot"},
    {"furniture", "shelf bookcase cupboard cabinet wardrobe"},
    {"vessel", "vase urn jug pitcher"},
    {"vessel", "pot bowl cup mug pan kettle"},
    {"vessel", "bottle jar glass"},
    {"building", "house home hut cottage cabin building"},
    {"building", "castle tower church temple"},
    {"plant", "tree oak pine palm fir birch"},
    {"plant", "bush shrub hedge"},
    {"plant", "flower rose tulip daisy sunflower plant"},
    {"plant", "mushroom toadstool fungus"},
    {"plant", "apple pear orange lemon banana fruit"},
    {"round thing", "ball sphere globe orb football basketball"},
    {"sculpture", "statue sculpture bust figurine monument"},
    {"headwear", "hat cap sombrero beanie beret fedora bonnet"},
    {"headwear", "crown tiara diadem"},
    {"headwear", "helmet hood"},
    {"eyewear", "glasses spectacles goggles"},
    {"eyewear", "sunglasses shades"},
    {"neckwear", "scarf shawl"},
    {"neckwear", "tie necktie bow"},
    {"neckwear", "necklace collar chain"},
    {"blaze", "flames flame fire blaze"},
    {"wings", "wings wing"},
    {"colour", "red crimson scarlet ruby cherry maroon burgundy vermilion"},
    {"colour", "blue azure navy cobalt sapphire indigo cyan teal turquoise"},
    {"colour", "green emerald lime olive mint jade"},
    {"colour", "yellow amber lemon"},
    {"colour", "orange tangerine apricot peach"},
    {"colour", "purple violet lilac lavender magenta mauve"},
    {"colour", "pink rose fuchsia"},
    {"colour", "brown tan chestnut beige chocolate"},
    {"colour", "black ebony jet"},
    {"colour", "white ivory snowy"},
    {"colour", "grey gray ash charcoal"},
    {"metal", "golden gold gilded brass"},
    {"metal", "silver chrome platinum"},
    {"metal", "metal metallic iron steel aluminium bronze copper tin"},
    {"wood", "wooden wood timber oaken pine"},
    {"mineral", "stone rock granite marble concrete brick"},
    {"mineral", "glass crystal ice"},
    {"ground", "grass lawn meadow turf field"},
    {"ground", "sand beach desert dune"},
    {"ground", "snow ice frost"},
    {"ground", "water lake sea ocean river pond"},
    {"ground", "tiles tiled floor ground pavement carpet rug"}};

constexpr std::pair<std::string_view, PartShape> PartShapes[] = {{"head", PartShape::Head},
                                                                 {"upper half", PartShape::UpperHalf},
                                                                 {"top half", PartShape::UpperHalf},
                                                                 {"upper part", PartShape::UpperHalf},
                                                                 {"lower half", PartShape::LowerHalf},
                                                                 {"bottom half", PartShape::LowerHalf},
                                                                 {"lower part", PartShape::LowerHalf}};

constexpr std::pair<std::string_view, std::string_view> Irregular[] = {
    {"men", "man"},     {"women", "woman"}, {"children", "child"}, {"people", "person"}, {"mice", "mouse"},
    {"geese", "goose"}, {"feet", "foot"},   {"teeth", "tooth"},    {"oxen", "ox"},       {"sheep", "sheep"}};

template <class F> void for_each_word(std::string_view words, F&& f) {
    for (std::size_t begin = 0; begin < words.size();) {
        const auto end = std::min(words.find(' ', begin), words.size());
        f(words.substr(begin, end - begin));
        begin = end + 1;
    }
}

template <class Table> auto value_of(const Table& table, std::string_view word) {
    const auto found = std::find_if(std::begin(table), std::end(table),
                                    [&](const auto& entry) { return entry.first == word; });
    return found == std::end(table) ? std::nullopt : std::optional(found->second);
}

}  // namespace

bool is_a(std::string_view word, WordClass classes) {
    static const auto all = [] {
        std::unordered_map<std::string_view, std::uint32_t> map;
        for (const auto& list : Classes)
            for_each_word(list.words, [&](std::string_view each) {
                map[each] |= static_cast<std::uint32_t>(list.word_class);
            });
        return map;
    }();
    const auto found = all.find(word);
    return found != all.end() && (found->second & static_cast<std::uint32_t>(classes)) != 0;
}

std::optional<Relation> relation_named(std::string_view preposition) {
    return value_of(Prepositions, preposition);
}

const std::vector<std::string>& compound_prepositions() {
    static const std::vector<std::string> all = [] {
        std::vector<std::string> compounds;
        for (const auto& entry : Prepositions)
            if (entry.first.find(' ') != std::string_view::npos) compounds.emplace_back(entry.first);
        return compounds;
    }();
    return all;
}

std::vector<std::string_view> kindred_groups(std::string_view word) {
    const auto holds = [word](const Meaning& meaning) {
        bool found = false;
        for_each_word(meaning.words, [&](std::string_view each) { found = found || each == word; });
        return found;
    };
    std::vector<std::string_view> groups;
    for (const auto& meaning : Meanings)
        if (holds(meaning)) groups.push_back(meaning.words);
    const std::size_t same = groups.size();
    for (const auto& meaning : Meanings) {
        if (!holds(meaning)) continue;
        for (const auto& other : Meanings)
            if (other.kind == meaning.kind && !holds(other)) groups.push_back(other.words);
    }
    return same == 0 ? std::vector<std::string_view>() : groups;
}

std::string_view irregular_singular(std::string_view plural) {
    return value_of(Irregular, plural).value_or(std::string_view());
}

std::optional<PartShape> shape_of_part(std::string_view part) { return value_of(PartShapes, part); }

std::optional<std::string_view> listed_place(std::string_view thing) {
    static const auto all = [] {
        std::unordered_map<std::string_view, std::string_view> map;
        for (const auto& list : Places)
            for_each_word(list.things, [&](std::string_view each) { map[each] = list.place; });
        return map;
    }();
    const auto found = all.find(thing);
    return found == all.end() ? std::nullopt : std::optional(found->second);
}

}  // namespace gse::language
