// The window without a device: an ImGui context fed by hand, the shell, and a fake application behind it.
#include "tests/ui/support/harness.h"

#include <stdexcept>

#include "tests/ui/support/soft_renderer.h"
#include "ui/keys/keys.h"
#include "ui/model/theme.h"

namespace gse::test {
namespace {

constexpr float FrameSeconds = 1.0f / 60;

void map_keys(ImGuiIO& io) {
    namespace key = ui::key;
    io.KeyMap[ImGuiKey_Tab] = key::Tab;
    io.KeyMap[ImGuiKey_LeftArrow] = key::Left;
    io.KeyMap[ImGuiKey_RightArrow] = key::Right;
    io.KeyMap[ImGuiKey_UpArrow] = key::Up;
    io.KeyMap[ImGuiKey_DownArrow] = key::Down;
    io.KeyMap[ImGuiKey_Home] = key::Home;
    io.KeyMap[ImGuiKey_End] = key::End;
    io.KeyMap[ImGuiKey_Delete] = key::Delete;
    io.KeyMap[ImGuiKey_Backspace] = key::Backspace;
    io.KeyMap[ImGuiKey_Space] = key::Space;
    io.KeyMap[ImGuiKey_Enter] = key::Enter;
    io.KeyMap[ImGuiKey_KeyPadEnter] = key::KeypadEnter;
    io.KeyMap[ImGuiKey_Escape] = key::Escape;
    io.KeyMap[ImGuiKey_A] = 'A';
    io.KeyMap[ImGuiKey_C] = 'C';
    io.KeyMap[ImGuiKey_V] = 'V';
    io.KeyMap[ImGuiKey_X] = 'X';
    io.KeyMap[ImGuiKey_Y] = 'Y';
    io.KeyMap[ImGuiKey_Z] = 'Z';
}

}  // namespace

Harness::Harness(const Options& options) : application(options.situation), options_(options) {
    context_ = ImGui::CreateContext();
    ImGui::SetCurrentContext(context_);
    auto& io = ImGui::GetIO();
    io.IniFilename = nullptr;
    io.DisplaySize = {static_cast<float>(options.width), static_cast<float>(options.height)};
    io.DeltaTime = FrameSeconds;
    map_keys(io);
    ui::dress(*io.Fonts, ImGui::GetStyle(), options.scale);
    font_ = font_picture(*io.Fonts);
    application.model().ui_scale = options.scale;
    frame(3);
}

Harness::~Harness() { ImGui::DestroyContext(context_); }

void Harness::frame(int count) {
    for (int index = 0; index < count; ++index) {
        application.refresh(options_.pictures);
        ImGui::NewFrame();
        for (const auto& command : shell.draw(application.model(), application)) application.run(command);
        ImGui::Render();
    }
}

void Harness::move(float x, float y) {
    ImGui::GetIO().MousePos = {x, y};
    frame(2);
}

void Harness::press(int button) {
    ImGui::GetIO().MouseDown[button] = true;
    frame();
}

void Harness::release(int button) {
    ImGui::GetIO().MouseDown[button] = false;
    frame(2);
}

void Harness::click(float x, float y, int button) {
    move(x, y);
    press(button);
    release(button);
}

void Harness::click(const std::string& name, int button) {
    const ImVec2 at = middle(name);
    click(at.x, at.y, button);
}

void Harness::drag(ImVec2 from, ImVec2 to, int button) {
    move(from.x, from.y);
    press(button);
    constexpr int Steps = 8;
    for (int step = 1; step <= Steps; ++step) {
        const float share = static_cast<float>(step) / Steps;
        ImGui::GetIO().MousePos = {from.x + (to.x - from.x) * share, from.y + (to.y - from.y) * share};
        frame();
    }
    release(button);
}

void Harness::wheel(float notches) {
    ImGui::GetIO().MouseWheel = notches;
    frame();
    frame(60);
}

void Harness::key(int index) {
    hold(index, true);
    hold(index, false);
}

void Harness::hold(int index, bool down) {
    ImGui::GetIO().KeysDown[index] = down;
    frame(2);
}

void Harness::modifiers(bool shift, bool control, bool alt) {
    auto& io = ImGui::GetIO();
    io.KeyShift = shift;
    io.KeyCtrl = control;
    io.KeyAlt = alt;
}

void Harness::type(const std::string& text) {
    ImGui::GetIO().AddInputCharactersUTF8(text.c_str());
    frame(2);
}

bool Harness::asks(const std::string& widget, const std::string& call) {
    application.calls.clear();
    click(widget);
    return application.asked(call);
}

bool Harness::key_asks(int index, const std::string& call) {
    application.calls.clear();
    key(index);
    return application.asked(call);
}

const ui::Rect* Harness::find(const std::string& name) const {
    const auto& widgets = shell.widgets();
    const auto found = widgets.find(name);
    return found == widgets.end() ? nullptr : &found->second;
}

ui::Rect Harness::rect(const std::string& name) const {
    const auto* rect = find(name);
    if (rect == nullptr) throw std::runtime_error("no widget \"" + name + "\" in this frame");
    return *rect;
}

ImVec2 Harness::middle(const std::string& name) const {
    const auto at = rect(name);
    return {at.x + at.width * 0.5f, at.y + at.height * 0.5f};
}

Image Harness::picture() const {
    ImGui::SetCurrentContext(context_);
    return render_draw_data(*ImGui::GetDrawData(), [this](ImTextureID id) -> const Image* {
        return id == nullptr
                   ? &font_
                   : application.picture(static_cast<std::uint64_t>(reinterpret_cast<std::uintptr_t>(id)));
    });
}

}  // namespace gse::test
