// Pictures for the panels on the window's device: images uploaded once, and one picture that changes every
// frame.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include "app/engine_names.h"
#include "engine/vulkan/resources.h"
#include "engine/window/window.h"
#include "ui/model/view_model.h"

namespace gse::app {

/// Uploads each Image object once (1, 3 or 4 channels, values 0..1) and drops it when the object has died.
/// Call it between begin_frame() and end_frame(); what does not fit into a frame's budget is answered with 0
/// and comes in a later frame.
class WindowTextures final : public ui::Textures, public DeviceClient {
public:
    explicit WindowTextures(Window& window);
    ~WindowTextures() override;

    ui::TextureId texture(const std::shared_ptr<const Image>& image) override;
    /// Some picture is still waiting for its turn: draw another frame soon.
    bool uploads_waiting() const { return waiting_; }

    void drop_device() override;
    void make_device(vulkan::Device& device) override;

private:
    struct Entry {
        std::weak_ptr<const Image> owner;
        vulkan::Texture texture;
        ui::TextureId id = 0;
    };
    void start_frame();
    void upload(const Image& image, Entry& entry);

    Window& window_;
    std::unordered_map<const Image*, Entry> entries_;
    std::uint64_t frame_ = ~0ull;
    std::size_t budget_ = 0;  // bytes left in this frame
    bool waiting_ = false;
};

/// A picture made anew on the CPU (the native preview, a film that plays): the newest pixels win, frames
/// never wait.
class StreamedPicture final : public DeviceClient {
public:
    explicit StreamedPicture(Window& window);
    ~StreamedPicture() override;

    /// Records the upload of width x height RGBA8 pixels into the frame under way.
    void update(std::span<const std::uint8_t> rgba, int width, int height);
    ui::TextureId id() const { return id_; }  // 0 = nothing yet
    int width() const { return width_; }
    int height() const { return height_; }

    void drop_device() override;
    void make_device(vulkan::Device& device) override;

private:
    struct Staging {
        vulkan::Buffer buffer;
        vulkan::Device::Ticket last_use;
    };
    Staging& free_staging(std::size_t bytes);

    Window& window_;
    vulkan::Texture texture_;
    std::vector<Staging> stagings_;
    ui::TextureId id_ = 0;
    int width_ = 0, height_ = 0;
};

}  // namespace gse::app
