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
