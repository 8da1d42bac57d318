// Words of changes with their usual amounts.
#include "engine/edit/words/change_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/printable.h"

namespace gse::edit {
namespace {

constexpr double Grown = 1.3;       // factor of "bigger" and of every other size without a number
constexpr double QuarterTurn = 90;  // degrees of a turn without a number
constexpr double HalfHeight = 0.5;  // of its own height: a move up or down without a number
constexpr double LeastFactor = 0.01, LargestFactor = 100;
constexpr double FarthestMove = 1e6;  // scene units, or own sizes
constexpr int Some = 3, MostCopies = 100;

struct SizeWord {
    std::string_view word;
    ChangeKind kind;
    StretchExtent extent;
    double amount;
};
constexpr std::array<SizeWord, 9> SizeWords{
    {{"bigger", ChangeKind::Resize, {}, Grown},
     {"smaller", ChangeKind::Resize, {}, 1 / Grown},
     {"taller", ChangeKind::Stretch, StretchExtent::Height, Grown},
     {"shorter", ChangeKind::Stretch, StretchExtent::Height, 1 / Grown},
     {"wider", ChangeKind::Stretch, StretchExtent::Width, Grown},
     {"narrower", ChangeKind::Stretch, StretchExtent::Width, 1 / Grown},
     {"thicker", ChangeKind::Stretch, StretchExtent::Girth, Grown},
     {"thinner", ChangeKind::Stretch, StretchExtent::Girth, 1 / Grown},
     {"longer", ChangeKind::Stretch, StretchExtent::Length, Grown}}};

constexpr std::array<std::pair<std::string_view, MoveDirection>, 6> Ways{{{"left", MoveDirection::Left},
                                                                          {"right", MoveDirection::Right},
                                                                          {"up", MoveDirection::Up},
                                                                          {"down", MoveDirection::Down},
                                                                          {"forward", MoveDirection::Forward},
                                                                          {"back", MoveDirection::Back}}};

constexpr std::array<std::pair<std::string_view, AnchorPlace>, 9> Places{{{"on", AnchorPlace::On},
                                                                          {"beside", AnchorPlace::Beside},
                                                                          {"left of", AnchorPlace::Left},
                                                                          {"right of", AnchorPlace::Right},
                                                                          {"behind", AnchorPlace::Behind},
                                                                          {"in front of", AnchorPlace::Front},
                                                                          {"under", AnchorPlace::Under},
                                                                          {"above", AnchorPlace::Above},
                                                                          {"in", AnchorPlace::In}}};

/// Relations of new things, in which a thing that is there cannot be put by moving it alone.
constexpr std::array<std::string_view, 5> OtherRelations{"worn by", "held by", "ridden by", "around",
                                                         "between"};

/// The table's value for a word.
template <class Value, std::size_t N>
std::optional<Value> found_in(const std::array<std::pair<std::string_view, Value>, N>& table,
                              std::string_view word) {
    for (const auto& [name, value] : table)
        if (name == word) return value;
    return std::nullopt;
}

[[noreturn]] void refuse(const std::string& message, const std::string& hint) {
    throw Error(ErrorCode::InvalidArgument, message, hint);
}

[[noreturn]] void refuse_unknown(std::string_view text) {
    refuse(fmt::format("\"{}\" is no change of place or size", printable(text)),
           "say one like bigger, scale 2, move left, rotate 90, flip or mirror");
}

std::vector<std::string> words_of(std::string_view text) {
    std::vector<std::string> words;
    std::string word;
    for (const char letter : text) {
        if (letter != ' ') {
            word += letter;
            continue;
        }
        if (!word.empty()) words.push_back(word);
        word.clear();
    }
    if (!word.empty()) words.push_back(word);
    return words;
}

std::optional<double> number_in(const std::string& word) {
    double number = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(number))
        return std::nullopt;
    return number;
}

double factor_in(const std::string& word, std::string_view text) {
    const auto number = number_in(word);
    if (!number) refuse_unknown(text);
    if (!(*number >= LeastFactor && *number <= LargestFactor))
        refuse(fmt::format("a size cannot be multiplied by {}", word),
               fmt::format("choose a factor from {} to {}", LeastFactor, LargestFactor));
    return *number;
}

/// "2 m", "50 cm", "30 %" behind the way of a move.
void read_distance(PlacementChange& change, const std::vector<std::string>& words, std::string_view text) {
    const auto number = words.size() > 2 ? number_in(words[2]) : std::nullopt;
    const std::string unit = words.size() > 3 ? words[3] : "m";
    const double factor = unit == "m" ? 1 : unit == "cm" || unit == "%" ? 0.01 : 0;
    if (!number || factor == 0 || words.size() > 4) refuse_unknown(text);
    if (!(std::abs(*number) <= FarthestMove))
        refuse(fmt::format("{} is too far to move", words[2]), "choose a smaller distance");
    change.amount = *number * factor;
    change.unit = unit == "%" ? MoveUnit::OwnSize : MoveUnit::SceneUnit;
}

PlacementChange move_of(const std::vector<std::string>& words, std::string_view text) {
    PlacementChange change;
    const std::string_view rest = text.substr(text.find(words[0]) + words[0].size());
    const std::string_view relation = rest.substr(std::min(rest.find_first_not_of(' '), rest.size()));
    if (const auto place = found_in(Places, relation)) {
        change.kind = ChangeKind::Place;
        change.place = *place;
        return change;
    }
    if (std::find(OtherRelations.begin(), OtherRelations.end(), relation) != OtherRelations.end())
        refuse(fmt::format("a thing that is there cannot be moved so that it is \"{}\" another", relation),
               "ask for a new one, and remove this one");
    const auto way = words.size() > 1 ? found_in(Ways, words[1]) : std::nullopt;
    if (!way) refuse_unknown(text);
    change.kind = ChangeKind::Move;
    change.way = *way;
    change.amount = *way == MoveDirection::Up || *way == MoveDirection::Down ? HalfHeight : 1;
    if (words.size() > 2) read_distance(change, words, text);
    return change;
}

/// Turns to the left bring the front to the left of who looks at it: clockwise as seen from above.
PlacementChange turn_of(const std::vector<std::string>& words, std::string_view text) {
    PlacementChange change;
    change.kind = ChangeKind::Turn;
    change.amount = QuarterTurn;
    std::size_t next = 1;
    if (next < words.size())
        if (const auto number = number_in(words[next])) {
            if (!(std::abs(*number) <= 3600))
                refuse(fmt::format("{} degrees are too many to turn", words[next]), "turn by less");
            change.amount = *number;
            ++next;
        }
    if (next < words.size()) {
        const std::string& sense = words[next++];
        if (sense == "clockwise" || sense == "left") change.amount = -change.amount;
        else if (sense != "counterclockwise" && sense != "right") refuse_unknown(text);
    }
    if (next < words.size()) refuse_unknown(text);
    return change;
}

PlacementChange face_of(const std::vector<std::string>& words, std::string_view text) {
    const auto way = words.size() == 2 ? found_in(Ways, words[1]) : std::nullopt;
    if (!way) refuse_unknown(text);
    if (*way == MoveDirection::Up || *way == MoveDirection::Down)
        refuse(fmt::format("a thing does not face {} by turning where it stands", words[1]),
               "set the tilt in degrees");
    PlacementChange change;
    change.kind = ChangeKind::Face;
    change.way = *way;
    return change;
}

PlacementChange of_kind(ChangeKind kind) {
    PlacementChange change;
    change.kind = kind;
    return change;
}

}  // namespace

PlacementChange placement_change(std::string_view text) {
    const auto words = words_of(text);
    if (words.empty()) refuse_unknown(text);
    for (const SizeWord& size : SizeWords)
        if (size.word == words[0] && (words.size() == 1 || (words.size() == 2 && size.amount > 1))) {
            PlacementChange change;
            change.kind = size.kind;
            change.extent = size.extent;
            change.amount = words.size() == 2 ? factor_in(words[1], text) : size.amount;
            return change;
        }
    if (words[0] == "scale" && words.size() == 2) {
        PlacementChange change;
        change.amount = factor_in(words[1], text);
        return change;
    }
    if (words[0] == "move") return move_of(words, text);
    if (words[0] == "rotate") return turn_of(words, text);
    if (words[0] == "face") return face_of(words, text);
    if (text == "flip") return of_kind(ChangeKind::Flip);
    if (text == "mirror") return of_kind(ChangeKind::Mirror);
    if (text == "swap with") return of_kind(ChangeKind::Swap);
    if (text == "same size as") return of_kind(ChangeKind::MatchSize);
    refuse_unknown(text);
}

int number_of_copies(std::string_view text) {
    if (text == "some") return Some;
    const auto number = number_in(std::string(text));
    if (!number || *number != std::floor(*number))
        refuse(fmt::format("\"{}\" is no number of things", printable(text)), "say how many");
    if (!(*number >= 1 && *number <= MostCopies))
        refuse(fmt::format("{} things cannot be made of one", text),
               fmt::format("choose a number from 1 to {}", MostCopies));
    return static_cast<int>(*number);
}

}  // namespace gse::edit
