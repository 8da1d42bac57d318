// The table of methods, and all texts that derive from it.
#include <fmt/format.h>

#include <array>
#include <vector>

#include "engine/base/error.h"
#include "engine/edit/request/edit_method.h"

namespace gse::edit {

// Each is defined in a file of its own.
const EditMethod& redrawn_views_method();
const EditMethod& score_distillation_method();

namespace {

constexpr const char* Auto = "auto";
constexpr const char* WhyFirst = "which come closer in less time";  // of the first method

/// "a, b or c" of texts.
std::string alternatives(const std::vector<std::string>& texts) {
    std::string list;
    for (std::size_t i = 0; i < texts.size(); ++i)
        list += (i == 0 ? "" : i + 1 == texts.size() ? " or " : ", ") + texts[i];
    return list;
}

}  // namespace

std::span<const EditMethod* const> edit_methods() {
    static const std::array methods{
        &redrawn_views_method(),
        &score_distillation_method(),
    };
    return methods;
}

const EditMethod* method_named(const std::string& name) {
    if (name == Auto) return edit_methods().front();
    for (const auto* method : edit_methods())
        if (method->name() == name) return method;
    return nullptr;
}

const EditMethod& method_of(const LoopSettings& settings) {
    const auto* method = method_named(settings.method);
    return method != nullptr ? *method : *edit_methods().front();
}

void require_method(const std::string& name) {
    if (method_named(name) != nullptr) return;
    const std::vector<std::string> names(method_names().begin(), method_names().end());
    throw Error(ErrorCode::InvalidArgument, "\"" + name + "\" is not a method", "use " + alternatives(names));
}

std::span<const char* const> method_names() {
    static const auto names = [] {
        std::vector<const char*> list{Auto};
        for (const auto* method : edit_methods()) list.push_back(method->name());
        return list;
    }();
    return names;
}

const char* method_help() {
    static const auto help = [] {
        std::vector<std::string> ways;
        for (const auto* method : edit_methods())
            ways.push_back(fmt::format("{} (it {})", method->name(), method->description()));
        ways.push_back(fmt::format("{} ({}, {})", Auto, edit_methods().front()->name(), WhyFirst));
        return "How the model leads the edit: " + alternatives(ways) + ".";
    }();
    return help.c_str();
}

const std::string& methods_explained() {
    static const auto lines = [] {
        auto text = fmt::format("{}: {}, {}.", Auto, edit_methods().front()->name(), WhyFirst);
        for (const auto* method : edit_methods())
            text += fmt::format("\n{}: the model {}.", method->name(), method->description());
        return text;
    }();
    return lines;
}

std::string why_unused(const EditMethod& method, unsigned field_uses) {
    if (method.counts(field_uses)) return {};
    std::vector<std::string> others;
    for (const auto* other : edit_methods())
        if (other->counts(field_uses)) others.emplace_back(other->name());
    return fmt::format("Has no effect now: {}. It counts with method {}.", method.process(),
                       alternatives(others));
}

int loop_steps(const LoopSettings& settings, EditMode mode) {
    return method_of(settings).steps(settings, mode);
}

}  // namespace gse::edit
