// The window without a device: an ImGui context fed by hand, the shell, and a fake application behind it.
#pragma once

#include <imgui.h>

#include <string>
#include <vector>

#include "tests/ui/support/fake_application.h"
#include "ui/frame/shell.h"

namespace gse::test {

class Harness {
public:
    struct Options {
        int width = 1280, height = 720;
        float scale = 1;
        Situation situation = Situation::Scene;
        bool pictures = false;  // render the viewport, attention and so on
    };
    explicit Harness(const Options& options);
    ~Harness();
    Harness(const Harness&) = delete;
    Harness& operator=(const Harness&) = delete;

    void frame(int count = 1);
    // Input, each followed by the frames that make it count
    void move(float x, float y);
    void press(int button = 0);
    void release(int button = 0);
    void click(float x, float y, int button = 0);
    /// Clicks the middle of a widget by its name; fails the test when it is not on the screen.
    void click(const std::string& name, int button = 0);
    void drag(ImVec2 from, ImVec2 to, int button = 0);
    void wheel(float notches);
    void key(int index);
    void hold(int index, bool down);
    void modifiers(bool shift, bool control, bool alt);
    void type(const std::string& text);
    /// True when a click on the widget, or the key, asks for what begins with `call`.
    bool asks(const std::string& widget, const std::string& call);
    bool key_asks(int index, const std::string& call);

    const ui::Rect* find(const std::string& name) const;
    ui::Rect rect(const std::string& name) const;  // fails the test when absent
    ImVec2 middle(const std::string& name) const;
    Image picture() const;

    FakeApplication application;
    ui::Shell shell;

private:
    Options options_;
    ImGuiContext* context_ = nullptr;
    Image font_;
};

}  // namespace gse::test
