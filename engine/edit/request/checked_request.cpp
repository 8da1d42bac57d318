// Completing and checking a request.
#include "engine/edit/request/checked_request.h"

#include <algorithm>
#include <utility>

#include "engine/base/error.h"
#include "engine/edit/request/edit_method.h"
#include "engine/edit/request/excluded_views.h"
#include "engine/language/news.h"
#include "engine/language/words.h"

namespace gse::edit {
namespace {

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
    if (request.mode != "auto" && !mode_named(request.mode))
        throw Error(ErrorCode::InvalidArgument, "\"" + request.mode + "\" is not an edit mode",
                    "use auto, modify, replace or add");
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

CheckedRequest::CheckedRequest(EditRequest request, language::Sentence sentence, bool target_open)
    : EditRequest(std::move(request)), words_(std::move(sentence), source, target),
      target_open_(target_open) {}

EditRequest with_target(EditRequest request, const News& news) {
    const auto source = language::normalised_prompt(request.source);
    if (request.target.empty() && !source.empty())
        request.target = guess(language::Sentence(request.prompt), source, news);
    return request;
}

CheckedRequest check(EditRequest request, const News& news) {
    check_fields(request);
    language::Sentence sentence(request.prompt);
    if (sentence.empty())
        throw Error(ErrorCode::InvalidArgument, "the edit has no prompt",
                    "describe the scene after the edit in one sentence");
    check_names(request);
    const bool open = request.target.empty();
    if (!request.source.empty()) request.source = phrase_of(request.source, "source");
    if (open && request.source.empty())
        throw Error(ErrorCode::InvalidArgument, "neither a source nor a target word is given",
                    "name what the edit is about, or the word of the sentence that is new");
    if (open) request.target = guess(sentence, request.source, news);
    request.target = phrase_of(request.target, "target");
    if (!sentence.contains(request.target))
        throw Error(ErrorCode::InvalidArgument,
                    "the prompt \"" + request.prompt + "\" does not contain the target word \"" +
                        request.target + "\"",
                    "use it in the sentence, or choose another target");
    if (request.source.empty()) request.source = request.target;
    return {std::move(request), std::move(sentence), open};
}

EditRequest source_alone(EditRequest request) {
    request.target = language::normalised_prompt(request.source);
    request.prompt = "a " + request.target;
    request.mode = "modify";
    return request;
}

}  // namespace gse::edit
