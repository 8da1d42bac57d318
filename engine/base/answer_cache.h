// Cache of costly answers.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace gse {

/// Questions and answers are bytes; a question names all that its answer follows from. May be used from
/// several threads.
class AnswerCache {
public:
    virtual ~AnswerCache() = default;
    virtual std::optional<std::string> find(std::string_view question) = 0;
    virtual void keep(std::string_view question, std::string_view answer) = 0;
};

}  // namespace gse
