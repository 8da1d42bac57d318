// GLFW window, device, swapchain and Dear ImGui put together into frames.
#include "engine/window/window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <utility>

#include "engine/base/log.h"
#include "engine/vulkan/device.h"
#include "engine/vulkan/resources.h"
#include "engine/window/input_queue.h"
#include "engine/window/key_names.h"
#include "engine/window/window_fonts.h"
#include "engine/window/window_imgui.h"
#include "engine/window/window_swapchain.h"

namespace gse::window {
namespace {

std::string last_glfw_error;
std::atomic<bool> wake_asked{false};

void on_glfw_error(int, const char* text) { last_glfw_error = text; }

constexpr int UsualWidth = 1600, UsualHeight = 900;  // at scale 1

[[noreturn]] void fail(const std::string& what) {
    const std::string why = last_glfw_error.empty() ? "" : " (" + last_glfw_error + ")";
    throw Error(ErrorCode::Foreign, what + why,
                "a desktop session is needed (DISPLAY or WAYLAND_DISPLAY); the commands without a window "
                "work without one");
}

}  // namespace

struct Window::State {
    /// Initialises GLFW once for all windows.
    class Glfw {
    public:
        Glfw() {
            glfwSetErrorCallback(on_glfw_error);
            if (glfwInit() == GLFW_FALSE) fail("the window system cannot be reached");
        }
        ~Glfw() { glfwTerminate(); }
        Glfw(const Glfw&) = delete;
        Glfw& operator=(const Glfw&) = delete;
    };

    /// Resources of a frame in flight.
    struct Slot {
        std::uint64_t serial = 0;
        vk::raii::Semaphore acquired{nullptr};
    };

    explicit State(const WindowOptions& wanted);
    ~State();

    static State& of(GLFWwindow* window) { return *static_cast<State*>(glfwGetWindowUserPointer(window)); }
    void push(const InputQueue::Event& event) {
        came_in = true;
        input.push(event);
    }
    void make_window();
    void note_events();
    void fit_screen();
    void translate_texts();
    void make_instance();
    void make_device();
    void drop_device();
    void update_scale();
    bool start_frame();
    void finish_frame();
    void forget_commands();
    void draw_panels(vk::CommandBuffer target, std::uint32_t image);
    void copy_for_capture(vk::CommandBuffer target, std::uint32_t image);
    float desktop_scale() const;
    Slot& slot() { return slots[frame % slots.size()]; }

    WindowOptions options;
    Glfw glfw;
    void hand_on_input();
    InputQueue input;
    std::array<bool, 5> buttons_down{};  // of the mouse, as the frames have been told; ImGui's five
    bool came_in = false;                // since it was last asked for
    GLFWwindow* window = nullptr;
    std::optional<vulkan::Instance> instance;
    std::optional<vk::raii::SurfaceKHR> surface;
    std::optional<vulkan::Device> device;
    std::optional<Swapchain> swapchain;
    std::optional<ImGuiRenderer> renderer;
    std::array<Slot, ImGuiRenderer::FramesInFlight> slots;
    std::optional<vk::raii::CommandBuffer> commands;
    std::vector<DeviceClient*> clients;
    std::uint64_t frame = 0;
    bool frame_open = false, fonts_stale = true, undressed = false;
    const char* (*read_clipboard)(void*) = nullptr;  // ImGui's own
    void (*write_clipboard)(void*, const char*) = nullptr;
    void* clipboard_data = nullptr;
    std::string clipboard;
    float scale = 0, wanted_scale = 0;
    bool capture_wanted = false;
    std::optional<vulkan::Buffer> capture;
    std::uint64_t capture_serial = 0;
    vk::Extent2D capture_size;
    std::array<int, 4> windowed_place{};  // x, y, width, height before full screen
    bool is_fullscreen = false;
};

Window::State::State(const WindowOptions& wanted) : options(wanted), wanted_scale(wanted.ui_scale) {
    make_window();
    make_instance();
    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    auto& io = ImGui::GetIO();
    io.ConfigFlags |= ImGuiConfigFlags_NavEnableKeyboard;
    io.IniFilename = options.layout_file.empty() ? nullptr : options.layout_file.c_str();
    ImGui_ImplGlfw_InitForVulkan(window, true);
    glfwSetKeyCallback(window, [](GLFWwindow* target, int key, int code, int action, int modifiers) {
        // The others say nothing that could move.
        const bool named = key >= GLFW_KEY_SPACE && key < GLFW_KEY_ESCAPE;
        of(target).push(
            {false, named ? written_key(key, glfwGetKeyName(key, code)) : key, code, action, modifiers, 0});
    });
    glfwSetCharCallback(window, [](GLFWwindow* target, unsigned character) {
        of(target).push({true, 0, 0, 0, 0, character});
    });
    glfwSetMouseButtonCallback(window, [](GLFWwindow* target, int button, int action, int modifiers) {
        double x = 0, y = 0;
        glfwGetCursorPos(target, &x, &y);
        of(target).push(
            {false, 0, 0, action, modifiers, 0, button, static_cast<float>(x), static_cast<float>(y)});
    });
    translate_texts();
    make_device();
}

/// Maps a character for ImGui, which has 16 bits for it. The table of the panels (ui/model/glyphs.h) has
/// codes for larger ones.
void Window::State::translate_texts() {
    if (!options.take_character || !options.take_text || !options.give_text) return;
    auto& io = ImGui::GetIO();
    read_clipboard = io.GetClipboardTextFn;
    write_clipboard = io.SetClipboardTextFn;
    clipboard_data = io.ClipboardUserData;
    io.ClipboardUserData = this;
    io.GetClipboardTextFn = [](void* data) -> const char* {
        auto& self = *static_cast<State*>(data);
        const char* text = self.read_clipboard(self.clipboard_data);
        if (text == nullptr) return nullptr;
        self.clipboard = self.options.take_text(text);
        return self.clipboard.c_str();
    };
    io.SetClipboardTextFn = [](void* data, const char* text) {
        auto& self = *static_cast<State*>(data);
        self.write_clipboard(self.clipboard_data, self.options.give_text(text).c_str());
    };
}

void Window::State::hand_on_input() {
    auto& io = ImGui::GetIO();
    const ImVec2 cursor_before = io.MousePos;
    const bool held = input.click_waits();  // the cursor may have moved on since
    std::optional<ImVec2> clicked;
    for (const auto& event : input.next_frame(io.WantTextInput)) {
        if (event.button >= 0) {
            if (event.button < static_cast<int>(buttons_down.size()))
                buttons_down[static_cast<std::size_t>(event.button)] = event.action == GLFW_PRESS;
            clicked = ImVec2(event.x, event.y);
        } else if (event.character) {
            ImGui_ImplGlfw_CharCallback(
                window, options.take_character ? options.take_character(event.codepoint) : event.codepoint);
        } else {
            ImGui_ImplGlfw_KeyCallback(window, event.key, event.code, event.action, event.modifiers);
        }
    }
    ImGui_ImplGlfw_NewFrame();
    // The backend asks for the state of the mouse as it is now; a click counts where and when it was made.
    for (std::size_t button = 0; button < buttons_down.size(); ++button)
        io.MouseDown[button] = buttons_down[button];
    if (clicked) io.MousePos = *clicked;
    else if (held) io.MousePos = cursor_before;
    if (input.waiting()) Window::wake();  // the next frame is wanted at once
}

Window::State::~State() {
    drop_device();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
    surface.reset();
    instance.reset();
    glfwDestroyWindow(window);
}

void Window::State::make_window() {
    if (glfwVulkanSupported() == GLFW_FALSE)
        throw Error(ErrorCode::NotFound, "there is no Vulkan driver for this desktop",
                    "install a graphics driver; mesa-vulkan-drivers has one that needs no graphics card");
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);  // until its size is right
    glfwWindowHintString(GLFW_X11_CLASS_NAME, "gseditpro");
    window = glfwCreateWindow(options.width > 0 ? options.width : UsualWidth,
                              options.height > 0 ? options.height : UsualHeight, options.title.c_str(),
                              nullptr, nullptr);
    if (window == nullptr) fail("the window cannot be opened");
    if (options.width <= 0 || options.height <= 0) fit_screen();
    if (options.visible) glfwShowWindow(window);
    glfwSetWindowUserPointer(window, this);
    glfwSetDropCallback(window, [](GLFWwindow* target, int count, const char** names) {
        auto& self = of(target);
        self.came_in = true;
        std::vector<std::filesystem::path> paths;
        for (int i = 0; i < count; ++i) paths.emplace_back(names[i]);
        if (self.options.on_drop) self.options.on_drop(paths);
    });
    note_events();
}

/// Notes events that may change the shown window. ImGui's own callbacks, installed later, call these first.
void Window::State::note_events() {
    glfwSetWindowRefreshCallback(window, [](GLFWwindow* target) { of(target).came_in = true; });
    glfwSetFramebufferSizeCallback(window, [](GLFWwindow* target, int, int) { of(target).came_in = true; });
    glfwSetWindowCloseCallback(window, [](GLFWwindow* target) { of(target).came_in = true; });
    glfwSetWindowFocusCallback(window, [](GLFWwindow* target, int) { of(target).came_in = true; });
    glfwSetWindowIconifyCallback(window, [](GLFWwindow* target, int) { of(target).came_in = true; });
    glfwSetWindowContentScaleCallback(window,
                                      [](GLFWwindow* target, float, float) { of(target).came_in = true; });
    glfwSetCursorEnterCallback(window, [](GLFWwindow* target, int) { of(target).came_in = true; });
    glfwSetCursorPosCallback(window, [](GLFWwindow* target, double, double) { of(target).came_in = true; });
    glfwSetMouseButtonCallback(window, [](GLFWwindow* target, int, int, int) { of(target).came_in = true; });
    glfwSetScrollCallback(window, [](GLFWwindow* target, double, double) { of(target).came_in = true; });
}

/// Size of the window when the options leave it open: the usual size, with its frame inside the free area of
/// the screen. Panels and docks take the rest.
void Window::State::fit_screen() {
    GLFWmonitor* monitor = glfwGetPrimaryMonitor();
    if (monitor == nullptr) return;
    int x = 0, y = 0, width = 0, height = 0, left = 0, top = 0, right = 0, bottom = 0;
    glfwGetMonitorWorkarea(monitor, &x, &y, &width, &height);
    glfwGetWindowFrameSize(window, &left, &top, &right, &bottom);
    const auto fitting = [&](int asked, int usual, int room) {
        if (asked > 0) return asked;
        const int wanted = static_cast<int>(std::lround(static_cast<float>(usual) * desktop_scale()));
        return room > 0 ? std::min(wanted, room) : usual;
    };
    const int w = fitting(options.width, UsualWidth, width - left - right);
    const int h = fitting(options.height, UsualHeight, height - top - bottom);
    glfwSetWindowSize(window, w, h);
    glfwSetWindowPos(window, x + left + std::max(0, (width - left - right - w) / 2),
                     y + top + std::max(0, (height - top - bottom - h) / 2));
}

void Window::State::make_instance() {
    std::uint32_t count = 0;
    const char** names = glfwGetRequiredInstanceExtensions(&count);
    if (names == nullptr) fail("Vulkan cannot draw on this desktop");
    vulkan::InstanceOptions wanted;
    wanted.extensions.assign(names, names + count);
    wanted.validation = options.validation;
    instance.emplace(wanted);
    VkSurfaceKHR made = VK_NULL_HANDLE;
    if (glfwCreateWindowSurface(*instance->handle(), window, nullptr, &made) != VK_SUCCESS)
        fail("Vulkan cannot draw into the window");
    surface.emplace(instance->handle(), made);
}

void Window::State::make_device() {
    const auto target = static_cast<VkSurfaceKHR>(**surface);
    device.emplace(*instance, vulkan::DeviceOptions{options.device, target});
    swapchain.emplace(*device, target);
    renderer.emplace(*device, swapchain->render_pass());
    for (auto& one : slots) one = {0, vk::raii::Semaphore(device->handle(), vk::SemaphoreCreateInfo())};
    fonts_stale = true;
}

void Window::State::drop_device() {
    if (!device) return;
    try {
        device->wait_idle();
        device->queue().waitIdle();
    } catch (const std::exception&) {  // lost: nothing runs any more
    }
    forget_commands();
    capture.reset();
    for (auto& one : slots) one = {};
    renderer.reset();
    swapchain.reset();
    device.reset();
}

void Window::State::forget_commands() {
    if (commands) device->discard(std::move(*commands));
    commands.reset();
}

float Window::State::desktop_scale() const {
    float x = 1, y = 1;
    glfwGetWindowContentScale(window, &x, &y);
    return std::clamp(std::max(x, y), 0.5f, 4.0f);
}

/// Applies the scale to fonts and sizes. Glyphs are made for the pixels they are shown with.
void Window::State::update_scale() {
    const float now = wanted_scale > 0 ? std::clamp(wanted_scale, 0.5f, 4.0f) : desktop_scale();
    if (now == scale && !fonts_stale && !undressed) return;
    auto& io = ImGui::GetIO();
    auto& style = ImGui::GetStyle();
    if (now != scale || undressed || !io.Fonts->IsBuilt()) {
        scale = now;
        undressed = false;
        io.Fonts->Clear();
        if (options.dress) options.dress(*io.Fonts, style, scale);
        else dress_plainly(*io.Fonts, style, scale);
        if (!io.Fonts->IsBuilt()) io.Fonts->Build();
    }
    renderer->upload_fonts(**commands);
    fonts_stale = false;
}

bool Window::State::start_frame() {
    int width = 0, height = 0;
    glfwGetFramebufferSize(window, &width, &height);
    if (width <= 0 || height <= 0 || glfwGetWindowAttrib(window, GLFW_ICONIFIED) == GLFW_TRUE) return false;
    device->wait(slot().serial);
    if (!commands) commands.emplace(device->begin_commands());  // else those of an abandoned frame go on
    update_scale();
    hand_on_input();
    ImGui::NewFrame();
    frame_open = true;
    return true;
}

void Window::State::draw_panels(vk::CommandBuffer target, std::uint32_t image) {
    const vk::ClearValue clear(vk::ClearColorValue(std::array<float, 4>{0.07f, 0.07f, 0.08f, 1.0f}));
    const vk::Rect2D area({0, 0}, swapchain->extent());
    target.beginRenderPass({swapchain->render_pass(), swapchain->framebuffer(image), area, clear},
                           vk::SubpassContents::eInline);
    renderer->draw(target, *ImGui::GetDrawData(), frame % slots.size());
    target.endRenderPass();
    if (capture_wanted && swapchain->can_copy()) copy_for_capture(target, image);
}

void Window::State::copy_for_capture(vk::CommandBuffer target, std::uint32_t image) {
    capture_size = swapchain->extent();
    const std::uint64_t bytes = std::uint64_t{capture_size.width} * capture_size.height * 4;
    capture.emplace(*device, vulkan::BufferDescription{.size = bytes,
                                                       .usage = vk::BufferUsageFlagBits::eTransferDst,
                                                       .home = vulkan::BufferHome::Readback,
                                                       .name = "capture"});
    const vk::ImageSubresourceRange range(vk::ImageAspectFlagBits::eColor, 0, 1, 0, 1);
    const auto move = [&](vk::ImageLayout from, vk::ImageLayout to) {
        const auto any = vk::AccessFlagBits::eMemoryRead | vk::AccessFlagBits::eMemoryWrite;
        const vk::ImageMemoryBarrier barrier(any, any, from, to, VK_QUEUE_FAMILY_IGNORED,
                                             VK_QUEUE_FAMILY_IGNORED, swapchain->image(image), range);
        target.pipelineBarrier(vk::PipelineStageFlagBits::eAllCommands,
                               vk::PipelineStageFlagBits::eAllCommands, {}, {}, {}, barrier);
    };
    move(vk::ImageLayout::ePresentSrcKHR, vk::ImageLayout::eTransferSrcOptimal);
    const vk::BufferImageCopy region(0, 0, 0, {vk::ImageAspectFlagBits::eColor, 0, 0, 1}, {},
                                     {capture_size.width, capture_size.height, 1});
    target.copyImageToBuffer(swapchain->image(image), vk::ImageLayout::eTransferSrcOptimal, capture->handle(),
                             region);
    move(vk::ImageLayout::eTransferSrcOptimal, vk::ImageLayout::ePresentSrcKHR);
    vulkan::full_barrier(target);
}

void Window::State::finish_frame() {
    ImGui::Render();
    frame_open = false;
    int width = 0, height = 0;
    glfwGetFramebufferSize(window, &width, &height);
    const auto w = static_cast<std::uint32_t>(std::max(width, 0)),
               h = static_cast<std::uint32_t>(std::max(height, 0));
    std::optional<std::uint32_t> image;
    if (w > 0 && h > 0 && (swapchain->fits(w, h) || swapchain->resize(w, h)))
        image = swapchain->acquire(*slot().acquired);
    const vk::CommandBuffer target = **commands;
    if (image) draw_panels(target, *image);
    vulkan::guarded("recording a frame", [&] { target.end(); });
    vulkan::Device::Submission work{.commands = target};
    if (image) {
        work.wait = *slot().acquired;
        work.wait_stage = vk::PipelineStageFlagBits::eColorAttachmentOutput;
        work.signal = swapchain->drawn(*image);
    }
    slot().serial = device->submit(work);
    device->recycle(std::move(*commands), slot().serial);
    commands.reset();
    if (image) {
        if (capture_wanted && capture) {
            capture_wanted = false;
            capture_serial = slot().serial;
        }
        swapchain->present(*image);
    }
    ++frame;
}

Window::Window(const WindowOptions& options) : state_(std::make_unique<State>(options)) {}
Window::~Window() = default;

bool Window::poll() {
    glfwPollEvents();
    const bool woken = wake_asked.exchange(false);
    return std::exchange(state_->came_in, false) || woken;
}
bool Window::wait(double seconds) {
    glfwWaitEventsTimeout(std::max(seconds, 0.0));
    return poll();
}
void Window::wake() {
    wake_asked = true;
    glfwPostEmptyEvent();
}
bool Window::should_close() const { return glfwWindowShouldClose(state_->window) == GLFW_TRUE; }
void Window::set_should_close(bool close) {
    glfwSetWindowShouldClose(state_->window, close ? GLFW_TRUE : GLFW_FALSE);
}

bool Window::begin_frame() {
    abandon_frame();
    return state_->start_frame();
}

VkCommandBuffer Window::commands() { return static_cast<VkCommandBuffer>(**state_->commands); }

void Window::end_frame() {
    try {
        state_->finish_frame();
    } catch (...) {
        state_->forget_commands();  // their state is not known
        throw;
    }
}

void Window::abandon_frame() {
    if (state_->frame_open) ImGui::EndFrame();
    state_->frame_open = false;
}

std::uint64_t Window::frame_number() const { return state_->frame; }
void Window::set_title(const std::string& title) { glfwSetWindowTitle(state_->window, title.c_str()); }
void Window::set_ui_scale(float scale) { state_->wanted_scale = scale; }
void Window::renew_fonts() { state_->undressed = true; }
float Window::ui_scale() const { return state_->scale > 0 ? state_->scale : state_->desktop_scale(); }
bool Window::fullscreen() const { return state_->is_fullscreen; }
GLFWwindow* Window::handle() const { return state_->window; }

void Window::set_fullscreen(bool fullscreen) {
    State& state = *state_;
    if (fullscreen == state.is_fullscreen) return;
    auto& place = state.windowed_place;
    GLFWmonitor* monitor = glfwGetPrimaryMonitor();
    if (fullscreen && monitor != nullptr) {
        glfwGetWindowPos(state.window, &place[0], &place[1]);
        glfwGetWindowSize(state.window, &place[2], &place[3]);
        const GLFWvidmode* mode = glfwGetVideoMode(monitor);
        glfwSetWindowMonitor(state.window, monitor, 0, 0, mode->width, mode->height, mode->refreshRate);
        state.is_fullscreen = true;
    } else if (!fullscreen) {
        glfwSetWindowMonitor(state.window, nullptr, place[0], place[1], place[2], place[3], GLFW_DONT_CARE);
        state.is_fullscreen = false;
    }
}

int Window::framebuffer_width() const {
    int width = 0, height = 0;
    glfwGetFramebufferSize(state_->window, &width, &height);
    return width;
}

int Window::framebuffer_height() const {
    int width = 0, height = 0;
    glfwGetFramebufferSize(state_->window, &width, &height);
    return height;
}

std::uint64_t Window::add_texture(VkImageView view, bool smooth) {
    return state_->renderer->add_texture(view, smooth);
}
void Window::replace_texture(std::uint64_t id, VkImageView view) {
    state_->renderer->replace_texture(id, view);
}
void Window::remove_texture(std::uint64_t id) {
    if (state_->renderer) state_->renderer->remove_texture(id);
}

vulkan::Device& Window::device() { return *state_->device; }
std::size_t Window::validation_messages() const { return state_->instance->message_count(); }
void Window::add_client(DeviceClient* client) { state_->clients.push_back(client); }
void Window::remove_client(DeviceClient* client) { std::erase(state_->clients, client); }

void Window::rebuild_device() {
    abandon_frame();
    for (auto* client : state_->clients) client->drop_device();
    state_->drop_device();
    state_->make_device();
    for (auto* client : state_->clients) client->make_device(*state_->device);
    log::info("the graphics device was opened again: {}", state_->device->info().name);
}

void Window::request_capture() { state_->capture_wanted = true; }

std::optional<Image> Window::take_capture() {
    State& state = *state_;
    if (state.capture_wanted || !state.capture) return std::nullopt;
    state.device->wait(state.capture_serial);
    const auto pixels = state.capture->as<std::uint8_t>();
    Image image(static_cast<int>(state.capture_size.width), static_cast<int>(state.capture_size.height), 3);
    const bool swap = state.swapchain->is_bgra();
    for (std::size_t pixel = 0; pixel < image.pixel_count(); ++pixel)
        for (std::size_t channel = 0; channel < 3; ++channel)
            image.data[pixel * 3 + channel] =
                static_cast<float>(pixels[pixel * 4 + (swap ? 2 - channel : channel)]) / 255.0f;
    state.capture.reset();
    return image;
}

}  // namespace gse::window
