// Messages to the artist: short notices over the viewport, one question at a time, and the log.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/shared_queue.h"
#include "ui/model/command.h"
#include "ui/model/view_model.h"

namespace gse::app {

/// An answer to a question, and what it does (empty = nothing).
struct AskedAnswer {
    ui::AskedQuestion::Answer answer;
    std::function<void()> act;
};

/// Main thread only; lines of the log come in from any thread.
class Notices {
    using Clock = std::chrono::steady_clock;

public:
    /// Takes the log over; `wake` (may be empty) is called from the thread that logs.
    explicit Notices(std::function<void()> wake);
    ~Notices();
    Notices(const Notices&) = delete;
    Notices& operator=(const Notices&) = delete;

    /// Shows a notice, unless it or a longer form of it is shown already. `action` belongs to the button.
    void toast(std::string text, bool is_error = false, std::string button = {},
               std::function<void()> action = {});
    /// Shows a notice that goes when the step of undo goes that was the last one when it came.
    void toast_of_step(std::string text, std::string button = {}, std::function<void()> action = {});
    /// Shows an error and logs it.
    void report(const Error& error);
    /// Shows an error of a search or edit: it goes as toast_of_step() says.
    void report_of_step(const Error& error);
    /// Asks; another question takes the place of one without an answer.
    void ask(std::string title, std::string text, std::vector<AskedAnswer> answers);

    /// Sets the function that gives the number of the document's last step.
    void follow(std::function<std::uint64_t()> step) { step_now_ = std::move(step); }
    /// Drops notices of steps that are undone, by the steps that `done` says are not.
    void forget_undone(const std::function<bool(std::uint64_t)>& done);
    /// Another document is being read: notices from now on are about it.
    void begin_reading() { reading_began_ = Clock::now(); }
    /// Drops the notices before that and an open question, of a document that is gone. The log stays.
    void forget();

    /// Takes the lines of the log and drops notices that were shown long enough. Call once per frame.
    void refresh();
    bool shows_toasts() const { return !toasts_.empty(); }
    void show(ui::NoticePart& model) const;

    void run(const ui::NoticeCommand& command);

private:
    struct ToastState {
        ui::Toast toast;
        Clock::time_point born;
        std::function<void()> action;
        std::uint64_t step = 0;  // that it goes with; 0 = none
    };
    template <class C> void on(const C& command);
    void add(ToastState state);
    void dismiss(std::size_t index);

    std::function<std::uint64_t()> step_now_ = [] { return std::uint64_t{0}; };
    Clock::time_point reading_began_{};
    std::vector<ToastState> toasts_;
    ui::AskedQuestion question_;
    std::vector<std::function<void()>> answers_;  // to the question
    std::vector<ui::LogLine> log_;
    std::shared_ptr<SharedQueue<ui::LogLine>> arriving_ = std::make_shared<SharedQueue<ui::LogLine>>();
};

}  // namespace gse::app
