// Captions that know which word names which part, and edit sentences.
#include <algorithm>
#include <cctype>

#include "engine/base/error.h"
#include "engine/laboratory/synth/words.h"

namespace gse::synth {
namespace {

std::vector<std::string> words_of(const std::string& text) {
    std::vector<std::string> words;
    std::string word;
    for (const char letter : text + ' ') {
        if (std::isalpha(static_cast<unsigned char>(letter)) != 0) {
            word += static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
        } else if (!word.empty()) {
            words.push_back(word);
            word.clear();
        }
    }
    return words;
}

/// Builds a caption word by word and remembers what each names.
class CaptionWriter {
public:
    void say(const std::string& words) {
        for (const auto& word : words_of(words)) append(word);
    }
    void name(const std::string& word, Part part) {
        const auto before = words_of(caption_.text);
        append(word);
        const int occurrence = static_cast<int>(std::count(before.begin(), before.end(), word));
        caption_.groundings.push_back({word, part, occurrence});
    }
    /// "a red", "an orange", "a": the article with an optional adjective.
    void article(const std::string& next) {
        const bool vowel = !next.empty() && std::string("aeiou").find(next.front()) != std::string::npos;
        say(vowel ? "an" : "a");
    }
    void comma() { caption_.text += ","; }
    bool empty() const { return caption_.text.empty(); }
    Caption take() { return std::move(caption_); }

private:
    void append(const std::string& word) {
        if (!caption_.text.empty()) caption_.text += ' ';
        caption_.text += word;
    }
    Caption caption_;
};

bool plural(const std::string& accessory) {
    return accessory == "sunglasses" || accessory == "glasses" || accessory == "flames" ||
           accessory == "wings" || accessory == "horns" || accessory == "headphones";
}

/// A noun with its adjective ("" = none) and article.
void noun_phrase(CaptionWriter& writer, const std::string& adjective, const std::string& noun, Part part) {
    if (!plural(noun)) writer.article(adjective.empty() ? noun : adjective);
    if (!adjective.empty()) writer.name(adjective, part);
    writer.name(noun, part);
}

bool chance(Random& random, double probability) { return random.uniform() < probability; }

/// The object in one of several ways: "a wooden chair", "a chair made of wood", "the red bear".
void object_phrase(CaptionWriter& writer, const SceneSpec& spec, bool with_material, Random& random) {
    static const std::vector<std::string> substances{"wooden", "stone",  "golden", "silver",
                                                     "bronze", "marble", "brick",  "lava"};
    const bool substance = contains(substances, spec.material);
    if (with_material && substance && chance(random, 0.25)) {
        noun_phrase(writer, "", spec.object, Part::Object);
        writer.say("made of");
        const std::string name = spec.material == "wooden"   ? "wood"
                                 : spec.material == "golden" ? "gold"
                                                             : spec.material;
        writer.name(name, Part::Object);
        return;
    }
    const std::string adjective = with_material ? spec.material : "";
    if (chance(random, 0.1)) {
        writer.say("the");
        if (!adjective.empty()) writer.name(adjective, Part::Object);
        writer.name(spec.object, Part::Object);
    } else {
        noun_phrase(writer, adjective, spec.object, Part::Object);
    }
}

/// "wearing a red hat", "with sunglasses", "in flames", "on fire", "with a crown".
void accessory_phrase(CaptionWriter& writer, const SceneSpec& spec, bool with_colour, Random& random) {
    if (spec.accessory == "flames") {
        if (chance(random, 0.2)) {
            writer.say("on");
            writer.name("fire", Part::Accessory);
            return;
        }
        writer.say(chance(random, 0.5) ? "in" : "with");
    } else {
        const bool worn = spec.accessory != "wings" && chance(random, 0.65);
        writer.say(worn ? "wearing" : "with");
    }
    const bool short_name = spec.accessory == "sunglasses" && chance(random, 0.15);
    noun_phrase(writer, with_colour ? spec.accessory_colour : "", short_name ? "glasses" : spec.accessory,
                Part::Accessory);
}

void ground_phrase(CaptionWriter& writer, const SceneSpec& spec, Random& random) {
    writer.say(chance(random, 0.2) ? "standing on" : "on");
    if (spec.ground == "tiles" && chance(random, 0.15)) {
        writer.say("a");
        writer.name("tiled", Part::Ground);
        writer.name("floor", Part::Ground);
        return;
    }
    if (chance(random, 0.75)) writer.say("the");
    const bool lake = spec.ground == "water" && chance(random, 0.1);
    writer.name(lake ? "lake" : spec.ground, Part::Ground);
}

/// Parts that an edit sentence has named so far.
struct EditReader {
    SceneSpec spec;
    std::string adjective;        // material word waiting for its noun
    bool removing = false;        // "without", "remove", "no": the next accessory goes
    bool accessory_last = false;  // the last noun was an accessory
    bool known = false;

    void read(const std::string& word) {
        static const std::vector<std::string> joints{"on",  "in",      "with",    "wearing",
                                                     "and", "without", "standing"};
        if (contains(joints, word)) finish();  // "made of gold on ...": no noun follows the adjective
        if (word == "without" || word == "remove" || word == "no") {
            removing = true;
        } else if (one_of(material_words(), more_material_words(), word)) {
            adjective = word;
            known = true;
        } else if (one_of(object_words(), more_object_words(), word)) {
            spec.object = word;
            if (!adjective.empty()) spec.material = adjective;
            noun(false);
        } else if (one_of(accessory_words(), more_accessory_words(), word)) {
            read_accessory(word);
        } else if (one_of(ground_words(), more_ground_words(), word)) {
            spec.ground = word;
            noun(false);
        }
    }
    void finish() {
        if (adjective.empty()) return;
        if (!accessory_last) spec.material = adjective;
        else if (!accessory_colour_words(spec.accessory).empty()) spec.accessory_colour = adjective;
        adjective.clear();
    }

private:
    static bool one_of(const std::vector<std::string>& words, const std::vector<std::string>& more,
                       const std::string& word) {
        return contains(words, word) || contains(more, word);
    }
    void noun(bool accessory) {
        adjective.clear();
        removing = false;
        accessory_last = accessory;
        known = true;
    }
    void read_accessory(const std::string& word) {
        if (removing) {
            if (spec.accessory == word) spec.accessory = spec.accessory_colour = "";
            noun(false);
            return;
        }
        if (spec.accessory != word) spec.accessory_colour.clear();
        spec.accessory = word;
        if (!adjective.empty() && !accessory_colour_words(word).empty()) spec.accessory_colour = adjective;
        noun(true);
    }
};

}  // namespace

Caption full_caption(const SceneSpec& spec) {
    CaptionWriter writer;
    noun_phrase(writer, spec.material, spec.object, Part::Object);
    if (!spec.accessory.empty()) {
        writer.say(spec.accessory == "flames" ? "in" : spec.accessory == "wings" ? "with" : "wearing");
        noun_phrase(writer, spec.accessory_colour, spec.accessory, Part::Accessory);
    }
    writer.say("on the");
    writer.name(spec.ground, Part::Ground);
    return writer.take();
}

namespace {

void random_phrases(CaptionWriter& writer, const SceneSpec& spec, Random& random) {
    const bool accessory = !spec.accessory.empty();
    const double kind = random.uniform();
    const bool only_accessory = accessory && kind < 0.06;
    const bool only_object = kind >= 0.06 && kind < 0.16;
    if (only_accessory) {
        if (chance(random, 0.2)) writer.say("add");
        noun_phrase(writer, chance(random, 0.85) ? spec.accessory_colour : "", spec.accessory,
                    Part::Accessory);
    } else {
        const double opening = random.uniform();
        if (opening < 0.12) writer.say(opening < 0.06 ? "a photo of" : "a picture of");
        if (opening > 0.96) writer.say(opening > 0.98 ? "make it" : "turn it into");
        object_phrase(writer, spec, chance(random, 0.85), random);
        if (accessory && !only_object && chance(random, 0.88))
            accessory_phrase(writer, spec, chance(random, 0.85), random);
        if (!only_object && chance(random, 0.82)) ground_phrase(writer, spec, random);
    }
}

}  // namespace

Caption random_caption(const SceneSpec& spec, Random& random) {
    CaptionWriter writer;
    random_phrases(writer, spec, random);
    return writer.take();
}

Caption random_caption(const SceneSpec& spec, double azimuth, Random& random) {
    CaptionWriter writer;
    random_phrases(writer, spec, random);
    if (chance(random, 0.65)) {
        writer.comma();
        writer.say(chance(random, 0.75) ? sided_view_words(azimuth) : view_words(azimuth));
    }
    return writer.take();
}

SceneSpec apply_edit(const SceneSpec& spec, const std::string& sentence) {
    EditReader reader;
    reader.spec = spec;
    for (const auto& word : words_of(sentence)) reader.read(canonical_word(word));
    if (!reader.known) {
        std::string hint = "use words like:";
        for (const auto& list : {object_words(), material_words(), accessory_words(), ground_words()})
            for (const auto& word : list) hint += " " + word;
        throw Error(ErrorCode::NotFound,
                    "the sentence \"" + sentence + "\" names nothing of the synthetic world", hint);
    }
    reader.finish();
    return reader.spec;
}

}  // namespace gse::synth
