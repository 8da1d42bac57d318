// Completing and checking a request.
#include "engine/edit/request/checked_request.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "engine/base/error.h"
#include "engine/edit/request/edit_method.h"
#include "engine/edit/request/excluded_views.h"
#include "engine/edit/request/sentence_plan.h"
#include "engine/edit/words/change_words.h"
#include "engine/language/news.h"
#include "engine/language/words.h"

namespace gse::edit {
namespace {

constexpr const char* OpenMode = "auto";  // of EditWords: the sentence tells it

/// Lower-case words with one space between them; throws when there are none.
std::string phrase_of(const std::string& text, const char* what) {
    auto phrase = language::normalised_prompt(text);
    if (phrase.empty())
        throw Error(ErrorCode::InvalidArgument,
                    std::string("the ") + what + " \"" + text + "\" is not a word",
                    "give the word or the words that matter");
    return phrase;
}

void check_names(const EditRequest& request) {
    if (request.mode != OpenMode && !mode_named(request.mode))
        throw Error(ErrorCode::InvalidArgument, "\"" + request.mode + "\" is not an edit mode",
                    "use auto, modify, replace, add, remove or transform");
    if (std::find(Qualities.begin(), Qualities.end(), request.quality) == Qualities.end())
        throw Error(ErrorCode::InvalidArgument, "\"" + request.quality + "\" is not a quality",
                    "use draft, normal or fine");
    require_method(request.method);
    excluded_views_of(request.excluded_views);
}

std::string guess(const language::Sentence& sentence, const std::string& source, const News& news) {
    return news.read_target.empty() ? language::guessed_target(sentence, source, news.said)
                                    : news.read_target;
}

}  // namespace

CheckedRequest::CheckedRequest(const EditRequest& request, language::Sentence sentence, bool target_open)
    : EditSettings(request), mode(mode_named(request.mode)), prompt_(request.prompt),
      sentence_(std::move(sentence), request.source, request.target), part_of_(request.part_of),
      whole_scene_(request.whole_scene), description_(request.description), anchor_(request.anchor),
      target_open_(target_open) {}

EditWords CheckedRequest::words() const {
    return {source(), prompt_,      target(),     mode ? mode_name(*mode) : OpenMode,
            part_of_, whole_scene_, description_, anchor_};
}

EditRequest CheckedRequest::plain() const { return {words(), *this}; }

CheckedRequest CheckedRequest::with_target(std::string target) const {
    CheckedRequest other = *this;
    other.sentence_ = sentence_.with_target(std::move(target));
    return other;
}

CheckedRequest CheckedRequest::reworded(std::string prompt, std::string target) const {
    CheckedRequest other = *this;
    other.sentence_ = sentence_.reworded(prompt, std::move(target));
    other.prompt_ = std::move(prompt);
    return other;
}

CheckedRequest CheckedRequest::search_for(std::string thing) const {
    CheckedRequest other = *this;
    other.prompt_ = sentence_.before();
    other.sentence_ = {language::Sentence(other.prompt_), std::move(thing), source()};
    other.mode = EditMode::Modify;
    return other;
}

CheckedRequest CheckedRequest::search_for_anchor() const {
    CheckedRequest other = *this;
    const bool told = sentence_.sentence().contains(anchor_);
    other.prompt_ = told ? sentence_.prompt() : "a " + anchor_;
    other.sentence_ = {language::Sentence(other.prompt_), anchor_, anchor_};
    other.mode = EditMode::Modify;
    other.part_of_.clear();
    return other;
}

namespace {

/// Words of the sentence without those of the phrase that brings the part ("with blue ears").
std::vector<std::string> without_part(const language::Sentence& sentence, const std::string& part) {
    auto words = sentence.words();
    const auto at = sentence.position_of(part);
    const auto length = language::words_of(part).size();
    if (at == words.size()) return words;
    auto begin = at;
    while (begin > 0 && !language::is_a(words[begin], language::WordClass::Joiner)) --begin;
    if (begin == 0) return {};
    const auto first = words.begin();
    words.erase(first + static_cast<std::ptrdiff_t>(begin), first + static_cast<std::ptrdiff_t>(at + length));
    return words;
}

}  // namespace

CheckedRequest CheckedRequest::search_for_whole() const {
    const auto rest = language::Sentence(language::joined(without_part(sentence_.sentence(), source())));
    CheckedRequest other = *this;
    other.part_of_.clear();
    other.prompt_ = rest.contains(part_of_) ? rest.prompt() : "a " + part_of_;
    other.sentence_ = {language::Sentence(other.prompt_), part_of_, part_of_};
    other.mode = EditMode::Modify;
    other.target_open_ = false;
    return other;
}

CheckedRequest CheckedRequest::in_look_of_whole() const {
    CheckedRequest other = search_for_whole();
    auto words = other.sentence_.sentence().words();
    const auto at = other.sentence_.sentence().position_of(part_of_);
    const auto look = language::words_of(target());
    words.insert(words.begin() + static_cast<std::ptrdiff_t>(at), look.begin(), look.end());
    other.prompt_ = language::joined(words);
    other.sentence_ = {language::Sentence(other.prompt_), part_of_, target()};
    return other;
}

EditRequest with_target(EditRequest request, const News& news) {
    const auto source = language::normalised_prompt(request.source);
    if (request.target.empty() && !source.empty())
        request.target = guess(language::Sentence(request.prompt), source, news);
    return request;
}

namespace {

bool is_rearranged(const EditRequest& request) {
    const auto mode = mode_named(request.mode);
    return mode && !is_drawn(*mode);
}

/// Throws Error (InvalidArgument) for a transform that changes nothing, or cannot be read.
void require_change(const EditRequest& request) {
    const RearrangeSettings& settings = request;
    if (settings == RearrangeSettings{})
        throw Error(ErrorCode::InvalidArgument, "nothing says how the thing is moved, turned or resized",
                    "give the change in words (\"bigger\"), or a number such as the turn");
    if (settings.change.empty()) return;
    const auto change = placement_change(settings.change);
    if (change.needs_anchor() == request.anchor.empty())
        throw Error(ErrorCode::InvalidArgument,
                    fmt::format("the change \"{}\" {}", settings.change,
                                request.anchor.empty() ? "needs another thing" : "takes no other thing"),
                    request.anchor.empty() ? "name it with the anchor" : "leave the anchor out");
}

/// Completes a request in which nothing is drawn, and returns the sentence that describes the scene as it is.
language::Sentence complete_rearranged(EditRequest& request) {
    if (request.source.empty())
        throw Error(ErrorCode::InvalidArgument,
                    fmt::format("nothing says which thing mode {} is about", request.mode),
                    "name it with the source");
    if (request.whole_scene)
        throw Error(ErrorCode::InvalidArgument, "a whole scene is only changed in its look",
                    "name one thing, or leave out --whole-scene");
    request.source = phrase_of(request.source, "source");
    request.target = request.source;
    if (!request.part_of.empty()) request.part_of = phrase_of(request.part_of, "thing of the part");
    if (!request.anchor.empty()) request.anchor = phrase_of(request.anchor, "anchor");
    if (mode_named(request.mode) == EditMode::Transform) require_change(request);
    if (request.prompt.empty()) request.prompt = request.mode + " the " + request.source;
    const language::Sentence described(request.description);
    const auto& named = request.part_of.empty() ? request.source : request.part_of;
    return described.contains(named) ? described : language::Sentence("a " + named);
}

}  // namespace

CheckedRequest check(EditRequest request, const News& news) {
    check_fields(request);
    if (EditRequest planned = in_plan_words(request, news); is_rearranged(planned)) {
        check_names(planned);
        auto described = complete_rearranged(planned);
        return {planned, std::move(described), false};
    }
    language::Sentence sentence(request.prompt);
    if (sentence.empty())
        throw Error(ErrorCode::InvalidArgument, "the edit has no prompt",
                    "describe the scene after the edit in one sentence");
    check_names(request);
    const bool open = request.target.empty();
    if (!request.source.empty()) request.source = phrase_of(request.source, "source");
    if (!request.part_of.empty()) request.part_of = phrase_of(request.part_of, "thing of the part");
    if (request.whole_scene && request.mode == OpenMode) request.mode = mode_name(EditMode::Modify);
    if (request.whole_scene && request.mode != mode_name(EditMode::Modify))
        throw Error(ErrorCode::InvalidArgument, "a whole scene is only changed in its look",
                    "use --mode modify, or leave out --whole-scene");
    if (request.whole_scene && !request.part_of.empty())
        throw Error(ErrorCode::InvalidArgument, "an edit of the whole scene is about no part",
                    "leave out --part-of or --whole-scene");
    if (const auto problem = single_edit_problem(request, news)) throw *problem;
    request = in_plan_words(request, news);
    const bool reworded = open && !request.target.empty();
    if (reworded) sentence = language::Sentence(request.prompt);
    if (open && request.source.empty())
        throw Error(ErrorCode::InvalidArgument, "neither a source nor a target word is given",
                    "name what the edit is about, or the word of the sentence that is new");
    if (request.target.empty()) request.target = guess(sentence, request.source, news);
    request.target = phrase_of(request.target, "target");
    if (!sentence.contains(request.target))
        throw Error(ErrorCode::InvalidArgument,
                    "the prompt \"" + request.prompt + "\" does not contain the target word \"" +
                        request.target + "\"",
                    "use it in the sentence, or choose another target");
    if (request.source.empty()) request.source = request.target;
    return {request, std::move(sentence), open && !reworded};
}

EditRequest source_alone(EditRequest request) {
    request.target = language::normalised_prompt(request.source);
    request.prompt = "a " + request.target;
    request.mode = "modify";
    return request;
}

std::string instruction_of(const CheckedRequest& request) {
    return request.instruction.empty()
               ? language::instruction_for(request.sentence().sentence(), request.source())
               : request.instruction;
}

}  // namespace gse::edit
