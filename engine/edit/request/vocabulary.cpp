// Known words, near words, and the refusal.
#include "engine/edit/request/vocabulary.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/edit/words/dye_words.h"
#include "engine/language/lexicon.h"
#include "engine/language/vocabulary.h"
#include "engine/language/words.h"

namespace gse::edit {
namespace {

/// Words for the place of one that is to be made: those near to it. Failing these, all but the many names of
/// colours and patterns that are remapped.
std::string words_to_make(const std::string& word, const std::vector<std::string>& known,
                          const std::vector<std::string>& drawn) {
    const auto say = language::promptable_vocabulary(known, drawn);
    if (!language::nearest_words(word, say).empty()) return language::words_to_use(word, say);
    const auto dyes = dye_words(known);
    auto shown = known;
    for (const auto& candidate : drawn)
        if (std::find(dyes.begin(), dyes.end(), candidate) == dyes.end()) shown.push_back(candidate);
    return language::words_to_use(word, shown) + (dyes.empty() ? "" : ", or a colour or pattern by its name");
}

void require_anchor(const CheckedRequest& request, const std::vector<std::string>& known) {
    if (request.anchor().empty()) return;
    if (const auto unknown = language::unknown_word(known, request.anchor()); !unknown.empty())
        throw Error(ErrorCode::InvalidArgument,
                    fmt::format("the model does not know the word \"{}\" and cannot find it", unknown),
                    fmt::format("move the thing by numbers instead, or use {}",
                                language::words_to_use(unknown, known)));
}

/// Checks where the request is looked for.
void require_findable(const CheckedRequest& request, const std::vector<std::string>& known,
                      const std::vector<std::string>& say) {
    const bool part = !request.part_of().empty();
    const auto& sought = part ? request.part_of() : request.source();
    if (!part && language::names_scene_ground(sought)) return;  // told by the scene's shape
    if (const auto unknown = language::unknown_word(known, sought); !unknown.empty())
        throw Error(
            ErrorCode::InvalidArgument,
            language::vocabulary_contains(say, unknown)
                ? fmt::format("the model can draw \"{}\" but not find it", unknown)
                : fmt::format("the model does not know the word \"{}\" and cannot find it", unknown),
            fmt::format("label it by hand instead (--at X,Y clicks on it, --cut-out puts a box around it, "
                        "--the-thing takes the largest thing), or use {}",
                        language::words_to_use(unknown, known)));
    if (part && !language::shape_of_part(request.source()) &&
        !language::vocabulary_contains(known, request.source()))
        throw Error(
            ErrorCode::InvalidArgument,
            fmt::format("the model has no word for the part \"{}\" and cannot find it", request.source()),
            "label the part by hand, or choose a model of an open vocabulary");
}

}  // namespace

void require_known_words(const CheckedRequest& request, const std::vector<std::string>& known,
                         const std::vector<std::string>& drawn, bool labelled_by_hand,
                         const std::vector<std::string>& labels) {
    if (request.whole_scene() && !known.empty())
        throw Error(ErrorCode::InvalidArgument,
                    "the look of a whole scene is drawn by models of an open vocabulary alone",
                    "choose a model such as Stable Diffusion or InstructPix2Pix");
    require_findable_words(request, known, drawn, labelled_by_hand, labels);
    if (request.is_rearranged()) return;
    const auto say = language::promptable_vocabulary(known, drawn);
    const auto target = language::unknown_word(say, request.target());
    if (!target.empty())
        throw Error(ErrorCode::InvalidArgument,
                    fmt::format("the model does not know the word \"{}\" and cannot make it", target),
                    fmt::format("use {}", words_to_make(target, known, drawn)));
}

void require_findable_words(const CheckedRequest& request, const std::vector<std::string>& known,
                            const std::vector<std::string>& drawn, bool labelled_by_hand,
                            const std::vector<std::string>& labels) {
    const bool labelled =
        labelled_by_hand || (request.part_of().empty() && language::contains(labels, request.source()));
    if (!labelled && !request.whole_scene())
        require_findable(request, known, language::promptable_vocabulary(known, drawn));
    if (!language::contains(labels, request.anchor())) require_anchor(request, known);
}

}  // namespace gse::edit
