// The renderer: the shown state, changes of it, and reading back.
#include "engine/preview/splat_renderer.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "engine/base/check.h"
#include "engine/base/log.h"
#include "engine/preview/frame_recorder.h"
#include "engine/scene/depth_range.h"

namespace gse::preview {
namespace {

constexpr std::uint64_t LargestFinePicture = 4096 * 2304;  // pixels; larger ones get the larger tiles
constexpr double Forever = 1e18;                           // milliseconds

/// Mean of a sample of the positions, for the scale of the depth colours.
Vec3 middle_of(const GaussianSet& set) {
    const std::size_t step = std::max<std::size_t>(set.size() / 4096, 1);
    const auto position = set.position();
    Vec3 sum;
    double count = 0;
    for (std::size_t row = 0; row < set.size(); row += step) {
        const Vec3 place{position[row * 3], position[row * 3 + 1], position[row * 3 + 2]};
        if (!std::isfinite(place.x + place.y + place.z)) continue;
        sum = sum + place;
        count += 1;
    }
    return count > 0 ? sum / count : sum;
}

}  // namespace

struct SplatRenderer::State {
    /// Bytes that come back from the device some time after a frame.
    struct Readback {
        vulkan::Buffer buffer;
        vulkan::Device::Ticket ticket;  // null = nothing on its way

        void copy(vulkan::Device& device, vk::CommandBuffer commands, const vulkan::Buffer& from,
                  std::uint64_t bytes) {
            if (buffer.size() < bytes)
                buffer = vulkan::Buffer(device, {.size = bytes,
                                                 .usage = vk::BufferUsageFlagBits::eTransferDst,
                                                 .home = vulkan::BufferHome::Readback,
                                                 .name = "read back"});
            commands.copyBuffer(from.handle(), buffer.handle(), vk::BufferCopy(0, 0, bytes));
            vulkan::full_barrier(commands);
            ticket = device.ticket();
        }
    };

    State(vulkan::Device& on, const RendererOptions& wanted)
        : device(on), options(wanted), passes(on.shared<Passes>()), workspace(on, passes), clock(on),
          recorder(on, passes, workspace, clock), store(on, wanted.always_stage),
          portable(wanted.portable_blend || !on.info().is_cpu || on.info().subgroup_size != 8 ||
                   !on.info().subgroup_vote_and_broadcast) {}

    void advance_upload(vk::CommandBuffer commands, double milliseconds);
    void apply_values();
    FramePlan plan_frame(const FrameRequest& request, bool light);
    void record(vk::CommandBuffer commands, const FrameRequest& request, bool light);
    void receive();
    void finish(const FrameRequest& request, bool light);
    Image read_picture();
    Image read_light();

    vulkan::Device& device;
    RendererOptions options;
    Passes& passes;
    Workspace workspace;
    PassClock clock;
    FrameRecorder recorder;
    SceneStore store;
    bool portable;
    std::shared_ptr<const std::vector<float>> values;
    bool has_values = false;
    Vec3 middle;

    bool stale = true;  // the picture is not what the scene and the values say
    std::optional<FrameRequest> shown;
    FramePlan plan{};  // of the picture shown
    std::uint64_t revision = 0;
    std::uint64_t pairs_wanted = 0;
    Readback control_back, depth_back;
    int depth_width = 0, depth_height = 0;
    std::shared_ptr<const Image> depth;
    FrameStatistics statistics;
    bool overflowed = false, warned = false;
};

void SplatRenderer::State::apply_values() {
    const bool fits = values && values->size() == store.shown().size() && !values->empty();
    store.set_values(fits ? std::span<const float>(*values) : std::span<const float>());
    has_values = fits;
    stale = true;
}

void SplatRenderer::State::advance_upload(vk::CommandBuffer commands, double milliseconds) {
    if (store.advance(milliseconds)) {
        middle = middle_of(store.shown());
        stale = true;
        const bool fits = values && values->size() == store.shown().size() && !values->empty();
        if (fits != has_values || fits) apply_values();
    }
    store.flush(commands);
}

FramePlan SplatRenderer::State::plan_frame(const FrameRequest& request, bool light) {
    const Camera& camera = request.camera;
    FramePlan result;
    const auto pixels = static_cast<std::uint64_t>(camera.width) * static_cast<std::uint64_t>(camera.height);
    result.portable = portable || pixels > LargestFinePicture;
    result.division = divide(device.info(), device.info().is_cpu && !options.many_parts, result.portable,
                             store.shown().size(), pixels);
    result.mode = request.display.mode;
    result.stored_degree = store.shown().sh_degree();
    result.used_degree = std::clamp(request.display.sh_degree, 0, result.stored_degree);
    result.has_values = has_values;
    result.store_depth = request.want_depth;
    result.store_light = light;
    result.data =
        frame_data(request, result.division, {middle, fitted_near_plane(store.shown().spans(), camera)});
    return result;
}

void SplatRenderer::State::record(vk::CommandBuffer commands, const FrameRequest& request, bool light) {
    FramePlan next = plan_frame(request, light);
    const std::size_t rows = store.shown().size();
    WorkspaceSize size;
    size.rows = rows;
    size.width = static_cast<std::uint32_t>(request.camera.width);
    size.height = static_cast<std::uint32_t>(request.camera.height);
    size.pairs = std::max<std::uint64_t>(
        pairs_wanted, options.pair_capacity > 0 ? options.pair_capacity : (1u << 20) + 4 * rows);
    size.matrix = matrix_entries(next.division, request.camera.width, request.camera.height);
    size.depth = request.want_depth;
    size.light = light;
    store.flush(commands);
    if (workspace.reserve(size)) ++revision;
    next.data.counts.x = static_cast<std::uint32_t>(rows);
    next.data.counts.y = static_cast<std::uint32_t>(workspace.pair_capacity());
    recorder.record(commands, next, store.chunks());
    control_back.copy(device, commands, workspace.buffer(Workspace::Control), shaders::ControlWords * 4);
    if (request.want_depth) {
        depth_back.copy(device, commands, workspace.buffer(Workspace::Depths),
                        std::uint64_t{size.width} * size.height * 4);
        depth_width = request.camera.width;
        depth_height = request.camera.height;
    }
    clock.mark(commands, "read back");
    plan = next;
    shown = request;
    stale = false;
}

/// Takes results of earlier frames that have arrived.
void SplatRenderer::State::receive() {
    if (device.finished(control_back.ticket)) {
        control_back.ticket.reset();
        const auto words = control_back.buffer.as<std::uint32_t>();
        statistics.visible = words[shaders::ControlVisible];
        statistics.pairs = words[shaders::ControlPairs];
        statistics.unfinished_rows = words[shaders::ControlUnfinished];
        statistics.pass_ms = clock.read();
        statistics.device_ms = 0;
        for (const auto& [name, ms] : statistics.pass_ms) statistics.device_ms += ms;
        const std::uint64_t capacity = workspace.pair_capacity();
        statistics.dropped_pairs = statistics.pairs > capacity ? statistics.pairs - capacity : 0;
        overflowed = statistics.dropped_pairs > 0 && capacity < workspace.largest_pair_capacity();
        if (overflowed) pairs_wanted = statistics.pairs + statistics.pairs / 4;
        if (statistics.dropped_pairs > 0 && !overflowed && !warned) {
            warned = true;
            log::warning(
                "this view has more overlapping splats than the graphics device has room for; {} pairs are "
                "left out",
                statistics.dropped_pairs);
        }
    }
    if (device.finished(depth_back.ticket)) {
        depth_back.ticket.reset();
        auto image = std::make_shared<Image>(depth_width, depth_height, 1);
        std::memcpy(image->data.data(), depth_back.buffer.mapped(), image->data.size() * sizeof(float));
        depth = std::move(image);
    }
}

void SplatRenderer::State::finish(const FrameRequest& request, bool light) {
    for (int attempt = 0; attempt < 4; ++attempt) {
        device.run([&](vk::raii::CommandBuffer& commands) { record(*commands, request, light); });
        receive();
        if (!overflowed) break;
    }
}

Image SplatRenderer::State::read_picture() {
    auto& picture = workspace.picture();
    const vulkan::Buffer target(device, {.size = std::uint64_t{picture.width()} * picture.height() * 4,
                                         .usage = vk::BufferUsageFlagBits::eTransferDst,
                                         .home = vulkan::BufferHome::Readback,
                                         .name = "picture read back"});
    device.run([&](vk::raii::CommandBuffer& commands) { picture.copy_to(*commands, target); });
    Image image(static_cast<int>(picture.width()), static_cast<int>(picture.height()), 4);
    const auto bytes = target.as<std::uint8_t>();
    for (std::size_t i = 0; i < image.data.size(); ++i) image.data[i] = static_cast<float>(bytes[i]) / 255.0f;
    return image;
}

Image SplatRenderer::State::read_light() {
    const std::uint64_t bytes = std::uint64_t{plan.data.size.x} * plan.data.size.y * 24;
    Readback back;
    device.run([&](vk::raii::CommandBuffer& commands) {
        vulkan::full_barrier(*commands);
        back.copy(device, *commands, workspace.buffer(Workspace::Light), bytes);
    });
    Image image(static_cast<int>(plan.data.size.x), static_cast<int>(plan.data.size.y), 6);
    std::memcpy(image.data.data(), back.buffer.mapped(), bytes);
    return image;
}

SplatRenderer::SplatRenderer(vulkan::Device& device, const RendererOptions& options)
    : state_(std::make_unique<State>(device, options)) {}
SplatRenderer::~SplatRenderer() = default;

void SplatRenderer::upload(const GaussianSet& set) { state_->store.begin(set); }
bool SplatRenderer::uploading() const { return state_->store.busy(); }

void SplatRenderer::set_values(std::shared_ptr<const std::vector<float>> values) {
    if (values == state_->values) return;
    state_->values = std::move(values);
    const auto& wanted = state_->values;
    const std::size_t rows = state_->store.shown().size();
    if (!wanted || wanted->size() == rows) state_->apply_values();
    else if (!state_->store.busy()) GSE_CHECK_EQ(wanted->size(), rows);
}

void SplatRenderer::finish_upload() {
    state_->device.run(
        [&](vk::raii::CommandBuffer& commands) { state_->advance_upload(*commands, Forever); });
}

bool SplatRenderer::render(VkCommandBuffer commands, const FrameRequest& request, double upload_ms) {
    State& state = *state_;
    GSE_CHECK(request.camera.width > 0 && request.camera.height > 0);
    return vulkan::guarded("drawing the splats", [&] {
        state.receive();
        state.advance_upload(commands, upload_ms);
        const bool same = state.shown && state.shown->camera == request.camera &&
                          state.shown->display == request.display &&
                          (state.shown->want_depth || !request.want_depth);
        if (same && !state.stale && !state.overflowed) return false;
        state.overflowed = false;
        state.record(commands, request, false);
        return true;
    });
}

void SplatRenderer::invalidate() { state_->stale = true; }

bool SplatRenderer::incomplete() {
    state_->receive();
    return state_->overflowed;
}

VkImageView SplatRenderer::view() const {
    return static_cast<VkImageView>(state_->workspace.picture().view());
}
std::uint64_t SplatRenderer::revision() const { return state_->revision; }
int SplatRenderer::width() const { return state_->shown ? state_->shown->camera.width : 0; }
int SplatRenderer::height() const { return state_->shown ? state_->shown->camera.height : 0; }

const Camera& SplatRenderer::camera() const {
    static const Camera none;
    return state_->shown ? state_->shown->camera : none;
}

std::size_t SplatRenderer::size() const { return state_->store.shown().size(); }

std::uint64_t SplatRenderer::device_bytes() const {
    return state_->store.byte_size() + state_->workspace.byte_size();
}

std::uint64_t SplatRenderer::sent_bytes() const { return state_->store.sent_bytes(); }

FrameStatistics SplatRenderer::statistics() {
    state_->receive();
    return state_->statistics;
}

std::shared_ptr<const Image> SplatRenderer::depth() {
    state_->receive();
    return state_->depth;
}

Image SplatRenderer::draw(const FrameRequest& request) {
    if (uploading()) finish_upload();
    state_->finish(request, false);
    return state_->read_picture();
}

Image SplatRenderer::draw_light(const FrameRequest& request) {
    if (uploading()) finish_upload();
    state_->finish(request, true);
    return state_->read_light();
}

std::optional<Pick> SplatRenderer::pick(int x, int y) {
    State& state = *state_;
    if (!state.shown || x < 0 || y < 0 || x >= width() || y >= height()) return std::nullopt;
    State::Readback back;
    state.device.run([&](vk::raii::CommandBuffer& commands) {
        state.recorder.record_pick(*commands, state.plan, static_cast<std::uint32_t>(x),
                                   static_cast<std::uint32_t>(y));
        back.copy(state.device, *commands, state.workspace.buffer(Workspace::Control),
                  shaders::ControlWords * 4);
    });
    const auto words = back.buffer.as<std::uint32_t>();
    if (words[shaders::ControlPickedRow] == shaders::CulledKey) return std::nullopt;
    return Pick{words[shaders::ControlPickedRow],
                static_cast<double>(std::bit_cast<float>(words[shaders::ControlPickedDepth]))};
}

}  // namespace gse::preview
