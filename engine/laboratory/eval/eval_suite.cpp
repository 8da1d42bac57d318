// Draws edits from all held-out combinations.
#include "engine/laboratory/eval/eval_suite.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>

#include "engine/base/check.h"
#include "engine/base/error.h"

namespace gse::bench {
namespace {

using synth::SceneSpec;

bool is_substance(const std::string& material) {
    return material == "wooden" || material == "stone" || material == "golden";
}

/// Words that name what comes.
struct Vocabulary {
    const std::vector<std::string>& objects = synth::object_words();
    const std::vector<std::string>& accessories = synth::accessory_words();
};

/// Words of an edit without seed, ground and accessory colour.
struct Combination {
    SceneSpec source, target;
    std::string key() const {
        const auto words =
            source.object + ' ' + source.material + ' ' + target.material + ' ' + target.accessory;
        return source.object == target.object ? words : words + ' ' + target.object;
    }
};

void for_each_spec(const Vocabulary& vocabulary, const auto& visit) {
    auto accessories = vocabulary.accessories;
    accessories.insert(accessories.begin(), "");
    for (const auto& object : vocabulary.objects)
        for (const auto& material : synth::material_words())
            for (const auto& accessory : accessories) {
                SceneSpec spec;
                spec.object = object;
                spec.material = material;
                spec.accessory = accessory;
                visit(spec);
            }
}

/// Another material, a colour or a substance; with or without an accessory that stays.
std::vector<Combination> material_changes(bool substance, bool with_accessory) {
    std::vector<Combination> list;
    for_each_spec({}, [&](const SceneSpec& target) {
        if (!synth::held_out(target) || is_substance(target.material) != substance) return;
        if (target.accessory.empty() == with_accessory) return;
        for (const auto& material : synth::material_words()) {
            SceneSpec source = target;
            source.material = material;
            // Without accessories hardly two materials of one object are held out: there only the target is.
            if (material != target.material && (!with_accessory || synth::held_out(source)))
                list.push_back({source, target});
        }
    });
    return list;
}

std::vector<Combination> additions(const std::vector<std::string>& accessories) {
    std::vector<Combination> list;
    for_each_spec({synth::object_words(), accessories}, [&](const SceneSpec& target) {
        if (target.accessory.empty() || !synth::held_out(target)) return;
        SceneSpec source = target;
        source.accessory.clear();
        list.push_back({source, target});
    });
    return list;
}

std::vector<Combination> ground_changes() {
    std::vector<Combination> list;
    for_each_spec({}, [&](const SceneSpec& spec) {
        if (synth::held_out(spec)) list.push_back({spec, spec});
    });
    return list;
}

/// Another object in the place of one; the new one's combination is held out.
std::vector<Combination> replacements(const std::vector<std::string>& objects, bool same_material) {
    std::vector<Combination> list;
    for_each_spec({objects, synth::accessory_words()}, [&](const SceneSpec& target) {
        if (!target.accessory.empty() || !synth::held_out(target)) return;
        for (const auto& object : synth::object_words())
            for (const auto& material : synth::material_words()) {
                if (object == target.object || (material == target.material) != same_material) continue;
                SceneSpec source = target;
                source.object = object;
                source.material = material;
                list.push_back({source, target});
            }
    });
    return list;
}

const std::string& pick(const std::vector<std::string>& words, Random& random) {
    return words[random.below(words.size())];
}

/// A colour for the accessory that differs from both materials; sometimes its natural look.
std::string accessory_colour(const Combination& words, Random& random) {
    const auto& colours = synth::accessory_colour_words(words.target.accessory);
    constexpr double natural_share = 0.15;  // as in random specs
    if (colours.empty() || random.uniform() < natural_share) return {};
    while (true) {
        const auto& colour = pick(colours, random);
        if (colour != words.source.material && colour != words.target.material) return colour;
    }
}

/// A combination that was not used yet, if there is one.
Combination choose(std::vector<Combination> list, std::set<std::string>& used, Random& random) {
    GSE_CHECK(!list.empty());
    std::vector<Combination> fresh;
    for (const auto& combination : list)
        if (!used.contains(combination.key())) fresh.push_back(combination);
    const auto& from = fresh.empty() ? list : fresh;
    const Combination chosen = from[random.below(from.size())];
    used.insert(chosen.key());
    return chosen;
}

constexpr const char* ColourRemap = "dye";
constexpr const char* Compound = "compound";

/// Colours that the bundled model does not look for: they are dyed, or (the metals) drawn.
const std::vector<std::string>& dyed_materials() {
    static const std::vector<std::string> words{"pink", "brown", "gray", "turquoise", "silver", "bronze"};
    return words;
}

std::vector<Combination> combinations_of(const std::string& kind, bool drawn_words, Random& random) {
    if (kind == "add")
        return additions(drawn_words ? synth::more_accessory_words() : synth::accessory_words());
    if (kind == "ground") return ground_changes();
    if (kind == "replace")
        return replacements(drawn_words ? synth::more_object_words() : synth::object_words(),
                            random.uniform() < 0.5);
    if (kind == ColourRemap) return material_changes(false, random.uniform() < 0.5);
    const bool with_accessory = random.uniform() < 0.5;
    return material_changes(kind == "material", with_accessory);
}

EvalCase make_case(const std::string& kind, bool drawn_words, std::set<std::string>& used, Random random) {
    Combination words = choose(combinations_of(kind, drawn_words, random), used, random);
    if (kind == ColourRemap) words.target.material = pick(dyed_materials(), random);
    const std::uint64_t seed = random.next();
    const std::string ground = pick(synth::ground_words(), random);
    words.target.accessory_colour = accessory_colour(words, random);
    if (!words.source.accessory.empty()) words.source.accessory_colour = words.target.accessory_colour;
    for (auto* spec : {&words.source, &words.target}) {
        spec->seed = seed;
        spec->ground = ground;
    }
    while (kind == "ground" && words.target.ground == ground)
        words.target.ground = pick(synth::ground_words(), random);
    EvalCase edit{
        kind, words.source, words.target, synth::full_caption(words.target).text, words.source.object, {},
        {}};
    if (kind == "ground") {
        edit.word = ground;
        edit.target_word = words.target.ground;
        edit.part = synth::Part::Ground;
    } else {
        edit.target_word = kind == "add"       ? words.target.accessory
                           : kind == "replace" ? words.target.object
                                               : words.target.material;
        edit.part = kind == "add" ? synth::Part::Accessory : synth::Part::Object;
    }
    return edit;
}

/// Changes of a case with several.
struct CompoundPattern {
    bool look, ground, add, accessory_look, replace;
};

/// Patterns in turn. Every look, place and thing of the world changes beside every other.
constexpr CompoundPattern CompoundPatterns[] = {
    {.look = true, .ground = false, .add = true, .accessory_look = false, .replace = false},
    {.look = true, .ground = false, .add = false, .accessory_look = true, .replace = false},
    {.look = false, .ground = true, .add = false, .accessory_look = false, .replace = true},
    {.look = true, .ground = true, .add = true, .accessory_look = false, .replace = false},
    {.look = true, .ground = true, .add = false, .accessory_look = false, .replace = false},
    {.look = true, .ground = true, .add = false, .accessory_look = true, .replace = false},
};

const std::string& another(const std::vector<std::string>& words, const std::vector<std::string>& taken,
                           Random& random) {
    for (;;) {
        const auto& word = pick(words, random);
        if (std::find(taken.begin(), taken.end(), word) == taken.end()) return word;
    }
}

/// Accessories that come in colours, so that theirs can change.
std::vector<std::string> coloured_accessories() {
    std::vector<std::string> list;
    for (const auto& word : synth::accessory_words())
        if (synth::accessory_colour_words(word).size() > 1) list.push_back(word);
    return list;
}

std::vector<Combination> combinations_of(const CompoundPattern& pattern, Random& random) {
    if (pattern.replace) return replacements(synth::object_words(), false);
    if (pattern.accessory_look) return additions(coloured_accessories());
    if (pattern.add) return additions(synth::accessory_words());
    return material_changes(random.uniform() < 0.5, false);
}

EvalCase make_compound(std::uint64_t number, std::set<std::string>& used, Random random) {
    const auto& pattern = CompoundPatterns[number % std::size(CompoundPatterns)];
    Combination words = choose(combinations_of(pattern, random), used, random);
    auto &source = words.source, &target = words.target;
    if (pattern.look) source.material = another(synth::material_words(), {target.material}, random);
    const std::uint64_t seed = random.next();
    source.seed = target.seed = seed;
    source.ground = target.ground = pick(synth::ground_words(), random);
    if (pattern.ground) target.ground = another(synth::ground_words(), {source.ground}, random);
    if (pattern.add) target.accessory_colour = accessory_colour(words, random);
    if (pattern.accessory_look) {
        source.accessory = target.accessory;
        const auto& colours = synth::accessory_colour_words(target.accessory);
        target.accessory_colour = another(colours, {source.material, target.material}, random);
        source.accessory_colour =
            another(colours, {source.material, target.material, target.accessory_colour}, random);
    }
    return {Compound, source, target, synth::full_caption(target).text, source.object, {}};
}

/// Sentence with "{}" in the place of the object, and what it asks for.
struct PlaceSentence {
    const char *kind, *text;
    AskedPlace asked;
};

const std::vector<PlaceSentence>& place_sentences() {
    static const std::vector<PlaceSentence> list{
        {"remove", "remove the {}", {.things = 0}},
        {"remove", "remove the {}", {.things = 0, .scanned = true}},
        {"resize", "make the {} bigger", {.size = 1.3}},
        {"resize", "make the {} smaller", {.size = 1 / 1.3}},
        {"resize", "the {} is twice its size", {.size = 2}},
        {"move", "move the {} to the left", {.right = -1}},
        {"move", "move the {} right 1 m", {.right = 1, .distance = 1}},
        {"move", "push the {} back", {.forward = -1}},
        {"rotate", "rotate the {} by 90 degrees", {.degrees = 90}},
        {"rotate", "turn the {} 45 degrees clockwise", {.degrees = -45}},
        {"rotate", "turn the {} around", {.degrees = 180}},
        {"duplicate", "two {}s", {.things = 2}},
        {"duplicate", "add another {}", {.things = 2}},
        {"duplicate", "three {}s", {.things = 3}},
    };
    return list;
}

/// A thing on a ground in a held-out combination, and a sentence of the kind, in turn.
EvalCase make_rearranged(const std::string& kind, std::uint64_t number, std::set<std::string>& used,
                         Random random) {
    std::vector<Combination> list;
    for_each_spec({}, [&](const SceneSpec& spec) {
        if (synth::held_out(spec) && spec.accessory.empty()) list.push_back({spec, spec});
    });
    SceneSpec spec = choose(std::move(list), used, random).source;
    spec.seed = random.next();
    spec.ground = pick(synth::ground_words(), random);
    std::vector<PlaceSentence> sentences;
    for (const auto& sentence : place_sentences())
        if (kind == sentence.kind) sentences.push_back(sentence);
    const auto& sentence = sentences[number % sentences.size()];
    EvalCase edit{kind, spec, spec, sentence.text, spec.object, {}};
    edit.prompt.replace(edit.prompt.find("{}"), 2, spec.object);
    edit.asked = sentence.asked;
    return edit;
}

std::string list_of(const std::vector<std::string>& words) {
    std::string list;
    for (const auto& word : words) list += (list.empty() ? "" : ", ") + word;
    return list;
}

}  // namespace

const std::vector<std::string>& eval_kinds() {
    static const std::vector<std::string> kinds{"recolour", "material", "add", "ground", "replace"};
    return kinds;
}

const std::vector<std::string>& rearranged_kinds() {
    static const std::vector<std::string> kinds{"remove", "resize", "move", "rotate", "duplicate"};
    return kinds;
}

bool is_rearranged(const std::string& kind) {
    const auto& kinds = rearranged_kinds();
    return std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
}

std::vector<EvalCase> make_suite(std::uint64_t seed, int count, const std::vector<std::string>& kinds,
                                 bool drawn_words) {
    auto known = eval_kinds();
    for (const char* kind : {ColourRemap, Compound}) known.emplace_back(kind);  // only where asked for
    known.insert(known.end(), rearranged_kinds().begin(), rearranged_kinds().end());
    for (const auto& kind : kinds)
        if (std::find(known.begin(), known.end(), kind) == known.end())
            throw Error(ErrorCode::InvalidArgument, "there is no kind of edit named \"" + kind + "\"",
                        "use " + list_of(known));
    if (kinds.empty())
        throw Error(ErrorCode::InvalidArgument, "no kind of edit is named", "use " + list_of(known));
    constexpr std::uint64_t OfWhatStays = 40000, OfReplacements = 50000, OfDyes = 60000, OfCompounds = 70000,
                            OfRearranged = 80000;  // random streams
    std::vector<EvalCase> suite;
    std::set<std::string> used, used_to_replace, used_to_dye, used_in_compounds, used_to_rearrange;
    std::uint64_t others = 0, replacements = 0, dyes = 0, compounds = 0, rearranged = 0;
    std::map<std::string, std::uint64_t> of_kind;
    for (int i = 0; i < count; ++i) {
        const auto& kind = kinds[static_cast<std::size_t>(i) % kinds.size()];
        if (kind == "replace")
            suite.push_back(make_case(kind, drawn_words, used_to_replace,
                                      Random::stream(seed, OfReplacements + replacements++)));
        else if (kind == ColourRemap)
            suite.push_back(make_case(kind, drawn_words, used_to_dye, Random::stream(seed, OfDyes + dyes++)));
        else if (kind == Compound) {
            const auto number = compounds++;
            suite.push_back(
                make_compound(number, used_in_compounds, Random::stream(seed, OfCompounds + number)));
        } else if (is_rearranged(kind))
            suite.push_back(make_rearranged(kind, of_kind[kind]++, used_to_rearrange,
                                            Random::stream(seed, OfRearranged + rearranged++)));
        else
            suite.push_back(make_case(kind, drawn_words, used, Random::stream(seed, OfWhatStays + others++)));
    }
    return suite;
}

}  // namespace gse::bench
