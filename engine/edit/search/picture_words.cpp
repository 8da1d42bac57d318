// One part of the sentence after the other, each with the mean over what is not known yet.
#include "engine/edit/search/picture_words.h"

#include <algorithm>
#include <limits>
#include <map>

#include "engine/base/check.h"
#include "engine/language/grammar.h"
#include "engine/language/lexicon.h"
#include "engine/language/words.h"

namespace gse::edit {
namespace {

using Words = std::vector<std::string>;

constexpr double SameWord = 0.98;  // cosine of the sentences of two words that the encoder cannot tell apart

/// A sentence in parts; empty parts are left out.
struct Description {
    std::string look, thing, worn_look, worn, ground;

    std::string text() const {
        std::string text = "a " + (look.empty() ? "" : look + " ") + thing;
        if (!worn.empty())
            text += (worn.ends_with('s') ? " with " : " with a ") +
                    (worn_look.empty() ? "" : worn_look + " ") + worn;
        if (!ground.empty()) text += " on the " + ground;
        return text;
    }
};

/// Reads pictures that are given as one vector.
class Reader {
public:
    Reader(VocabularyRanker& recognition, const Words& things, const std::vector<Image>& pictures)
        : recognition_(recognition), things_(things), seen_(recognition.mean_of(pictures)) {}

    double fit(const Description& description) { return recognition_.fit(description.text(), seen_); }

    /// Mean over the things, whichever it is.
    double fit_of_any(Description description) {
        double sum = 0;
        for (const auto& thing : things_) {
            description.thing = thing;
            sum += fit(description);
        }
        return sum / static_cast<double>(things_.size());
    }

    /// In the look that fits best.
    double fit_of_worn(Description description, const std::string& worn, const Words& looks) {
        description.worn = worn;
        double most = fit_of_any(description);
        for (const auto& look : looks) {
            description.worn_look = look;
            most = std::max(most, fit_of_any(description));
        }
        return most;
    }

    /// Puts the word that fits best into a part of the sentence, or leaves it empty.
    void read(Description& description, std::string Description::*part, const Words& words) {
        std::string best;
        double most = fit_of_any(description);
        for (const auto& word : words) {
            description.*part = word;
            const double fits = fit_of_any(description);
            if (fits > most) most = fits, best = word;
        }
        description.*part = best;
    }

private:
    VocabularyRanker& recognition_;
    const Words& things_;
    std::vector<float> seen_;
};

/// The lead of a word over others with their fits; those that mean the same to the encoder do not count.
WordLead lead_over(VocabularyRanker& recognition, const std::string& word,
                   const std::map<std::string, double>& fits) {
    double most = -std::numeric_limits<double>::infinity();
    std::string rival;
    for (const auto& [other, fit] : fits) {
        const bool same = other == word || recognition.likeness("a " + word, "a " + other) > SameWord;
        if (!same && fit > most) most = fit, rival = other;
    }
    const double own = fits.at(word);
    if (!(most > -std::numeric_limits<double>::infinity())) return {0, own, word};
    return {own - most, std::max(own, most), own >= most ? word : rival};
}

bool holds(const Words& words, const std::string& word) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

}  // namespace

WordKinds kinds_of(const std::vector<std::string>& known) {
    using language::WordClass;
    WordKinds kinds;
    for (const auto& word : known) {
        if (!language::says_something(word)) continue;
        if (language::is_a(word, language::Description)) kinds.looks.push_back(word);
        else if (language::is_ground(word)) kinds.grounds.push_back(word);
        else if (language::has_usual_place(word)) kinds.worn.push_back(word);
        else if (!language::is_a(word, WordClass::Caption | WordClass::MakingVerb))
            kinds.things.push_back(word);
    }
    return kinds;
}

std::optional<WordLead> lead_of(VocabularyRanker& recognition, const std::string& word,
                                const std::vector<Image>& pictures) {
    GSE_CHECK(recognition.available() && !pictures.empty());
    const WordKinds kinds = kinds_of(recognition.known());
    const auto words = language::words_of(word);
    const std::string name = words.empty() ? word : words.back();  // "red hat"
    const bool worn = holds(kinds.worn, name);
    if (kinds.things.empty() || (!worn && !holds(kinds.things, name))) return std::nullopt;
    Reader reader(recognition, kinds.things, pictures);
    Description description;
    reader.read(description, &Description::ground, kinds.grounds);
    reader.read(description, &Description::look, kinds.looks);
    std::map<std::string, double> fits;
    if (worn) {
        fits[""] = reader.fit_of_any(description);
        for (const auto& one : kinds.worn) fits[one] = reader.fit_of_worn(description, one, kinds.looks);
    } else {
        reader.read(description, &Description::worn, kinds.worn);
        if (!description.worn.empty()) reader.read(description, &Description::worn_look, kinds.looks);
        for (const auto& thing : kinds.things) {
            description.thing = thing;
            fits[thing] = reader.fit(description);
        }
    }
    return lead_over(recognition, name, fits);
}

}  // namespace gse::edit
