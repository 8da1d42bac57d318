// The desktop window: GLFW window, Vulkan device and swapchain, Dear ImGui, one frame at a time. Everything
// here belongs to the main thread except wake().
//
//   Window window(options);
//   while (!window.should_close()) {
//       busy ? window.poll() : window.wait(0.25);
//       if (!window.begin_frame()) continue;      // minimised
//       renderer.render(window.commands(), ...);  // compute work of this frame, before the panels are drawn
//       ...ImGui calls...
//       window.end_frame();
//   }
//
// begin_frame() and end_frame() throw vulkan::DeviceLost when the device is gone: call rebuild_device() and
// go on.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/image.h"

struct GLFWwindow;
struct ImFontAtlas;
struct ImGuiStyle;

namespace gse::vulkan {
class Device;
}

namespace gse::window {

struct WindowOptions {
    std::string title = "GSEditPro";
    int width = 0, height = 0;  // screen coordinates; 0 = usual, or less where the screen is smaller
    float ui_scale = 0;         // 0 = as the desktop says
    std::string layout_file;    // where ImGui keeps the panels' places; empty = nowhere
    std::string device;         // index or part of the name of the graphics device; empty = the best
    bool validation = false;    // validation layers
    bool visible = true;
    /// Adds the fonts and sets colours and sizes for a scale. Plain ones when empty.
    std::function<void(ImFontAtlas&, ImGuiStyle&, float scale)> dress;
    std::function<void(const std::vector<std::filesystem::path>&)> on_drop;
    /// Filters of typed and pasted characters on their way to ImGui, and of text on its way to the clipboard.
    /// Empty = unchanged.
    std::function<unsigned(unsigned)> take_character;
    std::function<std::string(const std::string&)> take_text, give_text;
};

/// Owner of things on the graphics device that must be released and made again when the device is lost.
class DeviceClient {
public:
    virtual ~DeviceClient() = default;
    virtual void drop_device() = 0;
    virtual void make_device(vulkan::Device& device) = 0;
};

class Window {
public:
    explicit Window(const WindowOptions& options);
    ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    // Events
    bool poll();  // true when something came in since the last poll() or wait(): input, wake(), a change of
                  // the window
    bool wait(double seconds);  // the same; returns earlier then
    static void wake();         // from any thread
    bool should_close() const;  // the user asked for it
    void set_should_close(bool close);

    // Frames
    bool begin_frame();          // false: nothing to draw on (minimised)
    VkCommandBuffer commands();  // of the frame being recorded, outside the render pass
    void end_frame();
    void abandon_frame();  // after an exception between the two; begin_frame() does it too
    std::uint64_t frame_number() const;

    // Look
    void set_title(const std::string& title);
    void set_ui_scale(float scale);  // 0 = as the desktop says; takes effect with the next frame
    float ui_scale() const;
    void renew_fonts();  // dress again with the next frame
    void set_fullscreen(bool fullscreen);
    bool fullscreen() const;
    int framebuffer_width() const;  // pixels
    int framebuffer_height() const;

    // Pictures: an image view in layout eShaderReadOnlyOptimal -> handle for ImGui::Image (ImTextureID).
    std::uint64_t add_texture(VkImageView view, bool smooth = true);
    void replace_texture(std::uint64_t id,
                         VkImageView view);  // the handle stays; also in the middle of a frame
    void remove_texture(std::uint64_t id);   // may still be used by the frame being recorded

    // Device
    vulkan::Device& device();
    std::size_t validation_messages() const;
    void add_client(DeviceClient* client);
    void remove_client(DeviceClient* client);
    void rebuild_device();  // after vulkan::DeviceLost

    /// Asks for a copy of the next frame that is shown. Take it after end_frame(). [H,W,3] in 0..1.
    void request_capture();
    std::optional<Image> take_capture();

    GLFWwindow* handle() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace gse::window
