// Reading words of which nobody has said that they are a request.
#include "engine/edit/request/unchecked_request.h"

#include <optional>

#include "engine/edit/request/edit_method.h"

namespace gse::edit {

language::EditSentence unchecked_sentence(const EditRequest& request) {
    return {language::Sentence(request.prompt), request.source, request.target};
}

EditMode planned_mode(const EditRequest& request) {
    return language::decide_mode(unchecked_sentence(request), mode_named(request.mode), std::nullopt).first;
}

int planned_steps(const EditRequest& request) { return loop_steps(request, planned_mode(request)); }

std::string instruction_of(const EditRequest& request) {
    return request.instruction.empty()
               ? language::instruction_for(language::Sentence(request.prompt), request.source)
               : request.instruction;
}

}  // namespace gse::edit
