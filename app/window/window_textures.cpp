// Uploads of pictures for the panels.
#include "app/window/window_textures.h"

#include <algorithm>
#include <cstring>

#include "engine/base/check.h"

namespace gse::app {
namespace {

constexpr std::size_t FrameBudget = 16u << 20;  // bytes a frame; the first picture of a frame always goes
constexpr auto PictureUsage = vk::ImageUsageFlagBits::eSampled | vk::ImageUsageFlagBits::eTransferDst;

std::uint8_t to_byte(float value) {
    return static_cast<std::uint8_t>(std::clamp(value, 0.0f, 1.0f) * 255.0f + 0.5f);  // NaN clamps to 0
}

void to_rgba8(const Image& image, std::uint8_t* out) {
    const float* in = image.data.data();
    const std::size_t count = image.pixel_count();
    for (std::size_t pixel = 0; pixel < count; ++pixel, out += 4) {
        if (image.channels == 1) {
            out[0] = out[1] = out[2] = to_byte(in[pixel]);
            out[3] = 255;
        } else {
            const float* values = in + pixel * static_cast<std::size_t>(image.channels);
            for (int k = 0; k < 3; ++k) out[k] = to_byte(values[k]);
            out[3] = image.channels == 4 ? to_byte(values[3]) : 255;
        }
    }
}

vulkan::Texture make_picture(vulkan::Device& device, int width, int height) {
    return vulkan::Texture(device, {.width = static_cast<std::uint32_t>(width),
                                    .height = static_cast<std::uint32_t>(height),
                                    .usage = PictureUsage,
                                    .name = "picture"});
}

vulkan::Buffer make_staging(vulkan::Device& device, std::size_t bytes) {
    return vulkan::Buffer(device, {.size = bytes,
                                   .usage = vk::BufferUsageFlagBits::eTransferSrc,
                                   .home = vulkan::BufferHome::Upload,
                                   .name = "picture staging"});
}

}  // namespace

WindowTextures::WindowTextures(Window& window) : window_(window) { window_.add_client(this); }

WindowTextures::~WindowTextures() {
    window_.remove_client(this);
    for (auto& [image, entry] : entries_) window_.remove_texture(entry.id);
}

void WindowTextures::start_frame() {
    if (frame_ == window_.frame_number()) return;
    frame_ = window_.frame_number();
    budget_ = FrameBudget;
    waiting_ = false;
    std::erase_if(entries_, [&](auto& item) {
        if (!item.second.owner.expired()) return false;
        window_.remove_texture(item.second.id);
        return true;
    });
}

ui::TextureId WindowTextures::texture(const std::shared_ptr<const Image>& image) {
    if (!image || image->width <= 0 || image->height <= 0) return 0;
    start_frame();
    auto& entry = entries_[image.get()];
    if (entry.id != 0 && entry.owner.lock() == image) return entry.id;
    if (entry.id != 0) {  // another object at the same address
        window_.remove_texture(entry.id);
        entry = {};
    }
    const std::size_t bytes = image->pixel_count() * 4;
    if (budget_ < bytes && budget_ < FrameBudget) {
        waiting_ = true;
        entries_.erase(image.get());
        return 0;
    }
    budget_ -= std::min(budget_, bytes);
    entry.owner = image;
    upload(*image, entry);
    return entry.id;
}

void WindowTextures::upload(const Image& image, Entry& entry) {
    GSE_CHECK(image.channels == 1 || image.channels == 3 || image.channels == 4);
    auto& device = window_.device();
    const vulkan::Buffer staging = make_staging(device, image.pixel_count() * 4);
    to_rgba8(image, staging.as<std::uint8_t>().data());
    entry.texture = make_picture(device, image.width, image.height);
    entry.texture.copy_from(window_.commands(), staging);
    entry.id = window_.add_texture(static_cast<VkImageView>(entry.texture.view()));
}

void WindowTextures::drop_device() {
    for (auto& [image, entry] : entries_) window_.remove_texture(entry.id);
    entries_.clear();
}

void WindowTextures::make_device(vulkan::Device&) {}  // pictures come back as they are asked for

StreamedPicture::StreamedPicture(Window& window) : window_(window) { window_.add_client(this); }

StreamedPicture::~StreamedPicture() {
    window_.remove_client(this);
    if (id_ != 0) window_.remove_texture(id_);
}

StreamedPicture::Staging& StreamedPicture::free_staging(std::size_t bytes) {
    auto& device = window_.device();
    for (auto& staging : stagings_)
        if (device.finished(staging.last_use)) {
            if (staging.buffer.size() < bytes) staging.buffer = make_staging(device, bytes);
            return staging;
        }
    stagings_.push_back({make_staging(device, bytes), {}});
    return stagings_.back();
}

void StreamedPicture::update(std::span<const std::uint8_t> rgba, int width, int height) {
    if (width <= 0 || height <= 0) return;
    const std::size_t bytes = static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4;
    GSE_CHECK_EQ(rgba.size(), bytes);
    auto& device = window_.device();
    if (!texture_ || width != width_ || height != height_) {
        texture_ = make_picture(device, width, height);
        const auto view = static_cast<VkImageView>(texture_.view());
        if (id_ != 0) window_.replace_texture(id_, view);  // panels may hold the handle already
        else id_ = window_.add_texture(view);
        width_ = width;
        height_ = height;
    }
    Staging& staging = free_staging(bytes);
    staging.last_use = device.ticket();
    std::memcpy(staging.buffer.mapped(), rgba.data(), bytes);
    texture_.copy_from(window_.commands(), staging.buffer);
}

void StreamedPicture::drop_device() {
    if (id_ != 0) window_.remove_texture(id_);
    id_ = 0;
    texture_ = {};
    stagings_.clear();
}

void StreamedPicture::make_device(vulkan::Device&) {}

}  // namespace gse::app
