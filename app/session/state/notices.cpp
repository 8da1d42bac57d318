// Messages to the artist: short notices over the viewport, one question at a time, and the log.
#include "app/session/state/notices.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <utility>

#include "engine/base/clock.h"
#include "engine/base/log.h"

namespace gse::app {
namespace {

constexpr double ToastSeconds = 7, ButtonToastSeconds = 12, ErrorToastSeconds = 20;
constexpr std::size_t MostToasts = 4, MostLogLines = 2000;

ui::LogLine line_now(log::Level level, std::string_view text) {
    return {level, fmt::format("{:%H:%M:%S}", fmt::localtime(std::time(nullptr))), std::string(text)};
}

double seconds_shown(const ui::Toast& toast) {
    if (toast.is_error) return ErrorToastSeconds;
    return toast.button.empty() ? ToastSeconds : ButtonToastSeconds;
}

}  // namespace

Notices::Notices(std::function<void()> wake) {
    log::set_sink([lines = arriving_, wake = std::move(wake)](log::Level level, std::string_view text) {
        lines->push(line_now(level, text));
        if (wake) wake();
    });
}

Notices::~Notices() { log::set_sink({}); }

void Notices::add(ToastState state) {
    // Repeated news, or news told at more length: one of them is enough.
    const auto& text = state.toast.text;
    std::erase_if(toasts_,
                  [&](const ToastState& old) { return text.find(old.toast.text) != std::string::npos; });
    if (std::any_of(toasts_.begin(), toasts_.end(),
                    [&](auto& old) { return old.toast.text.find(text) != std::string::npos; }))
        return;
    if (toasts_.size() >= MostToasts) toasts_.erase(toasts_.begin());
    toasts_.push_back(std::move(state));
}

void Notices::toast(std::string text, bool is_error, std::string button, std::function<void()> action) {
    add({{std::move(text), is_error, 0, std::move(button)}, Clock::now(), std::move(action)});
}

void Notices::toast_of_step(std::string text, std::string button, std::function<void()> action) {
    add({{std::move(text), false, 0, std::move(button)}, Clock::now(), std::move(action), step_now_()});
}

void Notices::report(const Error& error) {
    toast(error.what(), true);
    log_.push_back(line_now(log::Level::Error, error.what()));
}

void Notices::report_of_step(const Error& error) {
    add({{error.what(), true, 0, {}}, Clock::now(), {}, step_now_()});
    log_.push_back(line_now(log::Level::Error, error.what()));
}

void Notices::forget_undone(const std::function<bool(std::uint64_t)>& done) {
    std::erase_if(toasts_, [&](const ToastState& old) { return old.step != 0 && !done(old.step); });
}

void Notices::forget() {
    std::erase_if(toasts_, [this](const ToastState& old) { return old.born < reading_began_; });
    answers_.clear();
    question_.title.clear(), question_.text.clear(), question_.answers.clear();
}

void Notices::ask(std::string title, std::string text, std::vector<AskedAnswer> answers) {
    question_ = {question_.number + 1, std::move(title), std::move(text), {}};
    answers_.clear();
    for (auto& [answer, act] : answers) {
        question_.answers.push_back(std::move(answer));
        answers_.push_back(std::move(act));
    }
}

void Notices::refresh() {
    for (auto& line : arriving_->take()) {
        if (line.level == log::Level::Warning) toast(line.text);
        log_.push_back(std::move(line));
    }
    if (log_.size() > MostLogLines)
        log_.erase(log_.begin(), log_.end() - static_cast<std::ptrdiff_t>(MostLogLines));
    std::erase_if(toasts_, [](const ToastState& state) {
        return seconds_since(state.born) > seconds_shown(state.toast);
    });
    for (auto& state : toasts_) state.toast.age_seconds = seconds_since(state.born);
}

void Notices::show(ui::NoticePart& model) const {
    model.question = question_;
    model.log = log_;
    model.toasts.clear();
    for (const auto& state : toasts_) model.toasts.push_back(state.toast);
}

void Notices::dismiss(std::size_t index) {
    if (index < toasts_.size()) toasts_.erase(toasts_.begin() + static_cast<std::ptrdiff_t>(index));
}

template <> void Notices::on(const ui::command::Answer& command) {
    const auto answers = std::exchange(answers_, {});
    if (command.index < answers.size() && answers[command.index]) answers[command.index]();
}

template <> void Notices::on(const ui::command::DismissToast& command) { dismiss(command.index); }

template <> void Notices::on(const ui::command::PressToast& command) {
    if (command.index >= toasts_.size()) return;
    const auto action = toasts_[command.index].action;
    dismiss(command.index);
    if (action) action();
}

void Notices::run(const ui::NoticeCommand& command) {
    std::visit([this](const auto& one) { on(one); }, command);
}

}  // namespace gse::app
