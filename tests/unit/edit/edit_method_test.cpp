// The table of methods: texts, choices and costs derive from it.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <set>
#include <string>

#include "engine/base/error.h"
#include "engine/edit/request/edit_method.h"

namespace edit_method_test {

using namespace gse;
using edit::EditMode;

DOCTEST_TEST_CASE("methods: each has a name of its own, and the first is the default") {
    std::set<std::string> names;
    for (const auto* method : edit::edit_methods()) {
        DOCTEST_CHECK(names.insert(method->name()).second);
        DOCTEST_CHECK(edit::method_named(method->name()) == method);
        for (const char* text : {method->description(), method->leader(), method->process()})
            DOCTEST_CHECK(std::string(text).size() > 10);
    }
    DOCTEST_CHECK(!names.contains("auto"));
    DOCTEST_CHECK(edit::method_named("auto") == edit::edit_methods().front());
    DOCTEST_CHECK(edit::method_named("magic") == nullptr);
    const auto choices = edit::method_names();
    DOCTEST_REQUIRE(choices.size() == names.size() + 1);
    DOCTEST_CHECK(std::string(choices.front()) == "auto");
}

DOCTEST_TEST_CASE("methods: help and refusals name all of them") {
    DOCTEST_CHECK(std::string(edit::method_help()) ==
                  "How the model leads the edit: views (it redraws some views, the scene is fitted to them), "
                  "sds (it pulls at every step, the paper's way) or auto (views, which come closer in less "
                  "time).");
    for (const char* name : edit::method_names())
        DOCTEST_CHECK(edit::methods_explained().find(std::string(name) + ": ") != std::string::npos);
    try {
        edit::require_method("magic");
        DOCTEST_FAIL("an unknown method was taken");
    } catch (const Error& error) { DOCTEST_CHECK(error.hint() == "use auto, views or sds"); }
    const auto& views = *edit::method_named("views");
    DOCTEST_CHECK(edit::why_unused(views, edit::GradientField) ==
                  "Has no effect now: views are redrawn and fitted to. It counts with method sds.");
    DOCTEST_CHECK(edit::why_unused(views, 0).empty());
}

DOCTEST_TEST_CASE("methods: every setting that is tagged counts with one of them") {
    const edit::EditRequest usual;
    edit::EditRequest::visit_fields(usual, [](const char* name, const auto&, const FieldHelp& help, auto...) {
        DOCTEST_CAPTURE(name);
        bool counts = false;
        for (const auto* method : edit::edit_methods()) counts |= method->counts(help.uses);
        DOCTEST_CHECK(counts);
    });
}

DOCTEST_TEST_CASE("methods: steps that are set are the steps of the edit, and cost work") {
    for (const auto* method : edit::edit_methods())
        for (const auto mode : {EditMode::Modify, EditMode::Replace, EditMode::Add}) {
            DOCTEST_CAPTURE(method->name());
            edit::EditRequest request;
            request.method = method->name();
            method->set_steps(request, mode, 60);
            DOCTEST_CHECK(edit::loop_steps(request, mode) == 60);
            DOCTEST_CHECK(!method->steps_help(request, mode).empty());
            const auto all = method->work(request, {}, mode, 0, true),
                       rest = method->work(request, {}, mode, 60, true);
            DOCTEST_CHECK(all.pulls + all.pictures() > 0);
            DOCTEST_CHECK(rest.pulls + rest.pictures() == 0);
            DOCTEST_CHECK((all.pictures() > 0) == method->draws_views());
        }
}

}  // namespace edit_method_test
