// The window on whatever display there is: frames, textures, resizing, capture, scale, a lost device, no
// validation messages.
#ifdef GSE_WINDOW
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <doctest/doctest.h>
#include <imgui.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <thread>

#include "app/window/window_textures.h"
#include "engine/preview/splat_renderer.h"
#include "engine/vulkan/device.h"
#include "engine/window/window.h"
#include "tests/test_paths.h"

using namespace gse;

namespace {

bool display_present() {
    if (std::getenv("DISPLAY") != nullptr || std::getenv("WAYLAND_DISPLAY") != nullptr) return true;
    test::skip_missing("no display: DISPLAY is not set");
    return false;
}

app::WindowOptions small_window() {
    app::WindowOptions options;
    options.width = 320;
    options.height = 200;
    options.ui_scale = 1;
    options.validation = true;
    return options;
}

/// A borderless picture at the top left, 64 px wide.
void panel(ui::TextureId id) {
    ImGui::SetNextWindowPos({0, 0});
    ImGui::SetNextWindowSize({320, 200});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {0, 0});
    ImGui::Begin("picture", nullptr, ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoBackground);
    if (id != 0) ImGui::Image(reinterpret_cast<ImTextureID>(id), {64, 64});
    ImGui::TextUnformatted("text");
    ImGui::End();
    ImGui::PopStyleVar();
}

/// A frame with nothing but that.
void frame(app::Window& window, ui::TextureId id) {
    window.poll();
    if (!window.begin_frame()) return;
    panel(id);
    window.end_frame();
}

Image captured(app::Window& window, ui::TextureId id) {
    window.request_capture();
    frame(window, id);
    auto image = window.take_capture();
    DOCTEST_REQUIRE(image.has_value());
    return *image;
}

/// Red, green and blue of the capture at a pixel are those wanted, to 8 bits.
bool shows(const Image& image, int x, int y, std::array<float, 3> wanted) {
    for (int k = 0; k < 3; ++k)
        if (std::abs(image.at(x, y, k) - wanted[static_cast<std::size_t>(k)]) > 1.01f / 255) return false;
    return true;
}

std::shared_ptr<const Image> coloured(std::array<float, 3> colour) {
    auto image = std::make_shared<Image>(8, 8, 3);
    for (std::size_t i = 0; i < image->data.size(); ++i) image->data[i] = colour[i % 3];
    return image;
}

/// A renderer in the window, the way an application holds it.
class Viewport final : public app::DeviceClient {
public:
    Viewport(app::Window& window, const GaussianSet& set) : window_(window), set_(set) {
        window_.add_client(this);
        make_device(window_.device());
    }
    ~Viewport() override {
        window_.remove_client(this);
        drop_device();
    }
    void drop_device() override {
        if (id_ != 0) window_.remove_texture(id_);
        id_ = 0;
        revision_ = 0;
        renderer_.reset();
    }
    void make_device(vulkan::Device& device) override {
        renderer_.emplace(device);
        renderer_->upload(set_);
    }
    /// Call between begin_frame() and end_frame().
    ui::TextureId draw(const preview::FrameRequest& request) {
        renderer_->render(window_.commands(), request);
        if (renderer_->revision() != revision_) {
            if (id_ != 0) window_.remove_texture(id_);
            id_ = window_.add_texture(renderer_->view());
            revision_ = renderer_->revision();
        }
        return id_;
    }

private:
    app::Window& window_;
    GaussianSet set_;
    std::optional<preview::SplatRenderer> renderer_;
    ui::TextureId id_ = 0;
    std::uint64_t revision_ = 0;
};

/// A large white splat in the middle is seen at the middle of the picture, at any size, also after a lost
/// device.
void check_preview(app::Window& window) {
    GaussianData data;
    data.resize(1);
    data.position = {0, 0, 2};
    data.log_scale = {-1, -1, -1};
    data.rotation = {1, 0, 0, 0};
    data.opacity_logit = {8};
    data.sh = {2, 2, 2};
    Viewport viewport(window, GaussianSet{data});
    const auto check = [&](int size) {
        preview::FrameRequest request;
        request.camera.width = request.camera.height = size;
        request.camera.fx = request.camera.fy = size;
        request.camera.cx = request.camera.cy = 0.5 * size;
        ui::TextureId id = 0;
        for (int i = 0; i < 3; ++i) {
            window.poll();
            DOCTEST_REQUIRE(window.begin_frame());
            id = viewport.draw(request);
            window.end_frame();
        }
        const Image seen = captured(window, id);
        DOCTEST_CHECK(seen.at(32, 32, 0) > 0.95f);
        DOCTEST_CHECK(seen.at(2, 2, 0) < 0.2f);
    };
    check(64);
    check(33);
    window.device().pretend_lost();
    DOCTEST_CHECK_THROWS_AS(frame(window, 0), vulkan::DeviceLost);
    window.rebuild_device();
    check(33);
    check(128);
}

}  // namespace

DOCTEST_TEST_CASE("window shows pictures, survives resizing and a lost device") {
    if (!display_present()) return;
    const auto start = std::chrono::steady_clock::now();
    app::Window window(small_window());
    app::WindowTextures textures(window);
    frame(window, 0);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    std::printf("start to first frame: %.3f s on %s\n", seconds, window.device().info().name.c_str());

    auto image = coloured({1, 0.5f, 0});
    const auto show = [&] {
        ui::TextureId id = 0;
        window.poll();
        DOCTEST_REQUIRE(window.begin_frame());
        id = textures.texture(image);
        DOCTEST_CHECK(textures.texture(image) == id);
        window.end_frame();
        return captured(window, id);
    };
    DOCTEST_CHECK(shows(show(), 30, 30, {1, 0.5f, 0}));

    DOCTEST_SUBCASE("a new picture replaces a dead one") {
        image = coloured({0, 0.25f, 1});
        DOCTEST_CHECK(shows(show(), 30, 30, {0, 0.25f, 1}));
    }
    DOCTEST_SUBCASE("resizing") {
        for (int size = 100; size < 400; size += 60) {
            glfwSetWindowSize(window.handle(), size, size / 2);
            for (int i = 0; i < 4; ++i) {
                frame(window, 0);
                std::this_thread::sleep_for(std::chrono::milliseconds(5));
            }
        }
        const Image seen = captured(window, 0);
        DOCTEST_CHECK(seen.width == window.framebuffer_width());
    }
    DOCTEST_SUBCASE("a lost device is opened again") {
        window.device().pretend_lost();
        DOCTEST_CHECK_THROWS_AS(frame(window, 0), vulkan::DeviceLost);
        window.rebuild_device();
        DOCTEST_CHECK(shows(show(), 30, 30, {1, 0.5f, 0}));
    }
    DOCTEST_SUBCASE("scale") {
        const float before = ImGui::GetFontSize();
        window.set_ui_scale(2);
        frame(window, 0);
        DOCTEST_CHECK(ImGui::GetFontSize() == doctest::Approx(2 * before).epsilon(0.1));
    }
    DOCTEST_SUBCASE("a frame that was left in the middle") {
        DOCTEST_REQUIRE(window.begin_frame());
        DOCTEST_CHECK(shows(show(), 30, 30, {1, 0.5f, 0}));
    }
    DOCTEST_SUBCASE("a picture that changes") {
        app::StreamedPicture stream(window);
        for (int i = 0; i < 5; ++i) {
            const std::vector<std::uint8_t> pixels(4 * 16 * 16, static_cast<std::uint8_t>(i * 50));
            window.poll();
            DOCTEST_REQUIRE(window.begin_frame());
            stream.update(pixels, 16, 16);
            window.end_frame();
        }
        // alpha 200/255 over what is behind
        const Image seen = captured(window, stream.id());
        DOCTEST_CHECK(seen.at(30, 30, 0) > 0.5f);
    }
    DOCTEST_SUBCASE(
        "a picture that changes its size is seen in every frame, also by who asked for its handle before") {
        app::StreamedPicture stream(window);
        ui::TextureId known = 0;
        for (int size = 4; size < 40; size += 5) {
            const std::vector<std::uint8_t> pixels(4 * static_cast<std::size_t>(size * size), 255);
            window.poll();
            window.request_capture();
            DOCTEST_REQUIRE(window.begin_frame());
            stream.update(pixels, size, size);
            if (known == 0) known = stream.id();
            panel(known);
            window.end_frame();
            known = stream.id();
            const auto seen = window.take_capture();
            DOCTEST_REQUIRE(seen.has_value());
            DOCTEST_CHECK(shows(*seen, 30, 30, {1, 1, 1}));
        }
    }
    DOCTEST_SUBCASE("splats in the window, before and after the device is lost") { check_preview(window); }
    DOCTEST_SUBCASE("waking from another thread") {
        const std::jthread waker([] {
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
            app::Window::wake();
        });
        const auto before = std::chrono::steady_clock::now();
        for (int i = 0; i < 3; ++i) window.poll();
        window.wait(5);
        DOCTEST_CHECK(std::chrono::steady_clock::now() - before < std::chrono::seconds(4));
    }
    DOCTEST_SUBCASE("what came in is told once, however late it is asked for") {
        while (window.poll())
            std::this_thread::sleep_for(std::chrono::milliseconds(50));  // of the window's own coming up
        app::Window::wake();
        DOCTEST_CHECK(window.wait(0.05));
        app::Window::wake();
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        DOCTEST_CHECK(window.wait(0));
        DOCTEST_CHECK(!window.wait(0));
    }
    window.device().wait_idle();
    DOCTEST_CHECK(window.validation_messages() == 0);
}
#endif
