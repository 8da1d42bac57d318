// Messages to the artist: short notices over the viewport, one question at a time, and the log.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/shared_queue.h"
#include "ui/commands/command.h"
#include "ui/view_model.h"

namespace gse::app {

/// An answer to a question, and what it does (empty = nothing).
struct AskedAnswer {
    ui::AskedQuestion::Answer answer;
    std::function<void()> act;
};

/// Main thread only; lines of the log come in from any thread.
class Notices {
public:
    /// Takes the log over; `wake` (may be empty) is called from the thread that logs.
    explicit Notices(std::function<void()> wake);
    ~Notices();
    Notices(const Notices&) = delete;
    Notices& operator=(const Notices&) = delete;

    /// Shows a notice, unless it or a longer form of it is shown already. `action` belongs to the button.
    void toast(std::string text, bool is_error = false, std::string button = {},
               std::function<void()> action = {});
    /// Shows an error and logs it.
    void report(const Error& error);
    /// Asks; another question takes the place of one without an answer.
    void ask(std::string title, std::string text, std::vector<AskedAnswer> answers);

    /// Takes the lines of the log and drops notices that were shown long enough. Call once per frame.
    void refresh();
    bool shows_toasts() const { return !toasts_.empty(); }
    void show(ui::NoticePart& model) const;

    void run(const ui::NoticeCommand& command);

private:
    using Clock = std::chrono::steady_clock;
    struct ToastState {
        ui::Toast toast;
        Clock::time_point born;
        std::function<void()> action;
    };
    template <class C> void on(const C& command);
    void dismiss(std::size_t index);

    std::vector<ToastState> toasts_;
    ui::AskedQuestion question_;
    std::vector<std::function<void()>> answers_;  // to the question
    std::vector<ui::LogLine> log_;
    std::shared_ptr<SharedQueue<ui::LogLine>> arriving_ = std::make_shared<SharedQueue<ui::LogLine>>();
};

}  // namespace gse::app
