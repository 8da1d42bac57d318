// One picture at a time, on the thread that counts.
#include "app/session/view_pictures.h"

#include <algorithm>

#include "app/engine_names.h"
#include "app/session/shown_picture.h"

namespace gse::app {
namespace {

constexpr int WidthPx = 320, LeastPx = 16, MostPx = 640;  // of the whole picture, which the list crops

bool same_viewpoint(const Camera& a, const Camera& b) {
    return a.width == b.width && a.height == b.height && a.fx == b.fx && a.fy == b.fy && a.cx == b.cx &&
           a.cy == b.cy && a.rotation == b.rotation && a.translation == b.translation;
}

}  // namespace

void ViewPictures::take_document() {
    wanted_.clear();
    drawn_.clear();
}

void ViewPictures::want(std::size_t view) {
    if (std::find(wanted_.begin(), wanted_.end(), view) == wanted_.end()) wanted_.push_back(view);
}

void ViewPictures::refresh(const GaussianSet& set, const PictureRequest& shown) {
    if (wanted_.empty() || workspace_.jobs->works() || workspace_.jobs->counter.running()) return;
    const auto& views = workspace_.document.state().views;
    const std::size_t index = wanted_.front();
    wanted_.erase(wanted_.begin());
    if (index >= views.size()) return;
    const Camera camera = views[index].camera;
    if (std::any_of(drawn_.begin(), drawn_.end(),
                    [&](const auto& one) { return same_viewpoint(one.first, camera); }))
        return;
    PictureRequest request;
    request.set = set;
    request.antialiased = shown.antialiased;
    request.settings.sh_degree = shown.settings.sh_degree;
    request.settings.background = shown.settings.background;
    const double shape = static_cast<double>(camera.height) / std::max(1, camera.width);
    request.camera = camera.resized(WidthPx, std::clamp(static_cast<int>(WidthPx * shape), LeastPx, MostPx));
    auto picture = std::make_shared<std::shared_ptr<const Image>>();
    auto work = [picture, request](const JobControl&) {
        *picture = std::make_shared<const Image>(shown_picture(request));
    };
    auto done = [this, picture, camera, opened = workspace_.opened](const Error*) {
        if (opened == workspace_.opened && *picture != nullptr) drawn_.emplace_back(camera, *picture);
    };
    if (!workspace_.jobs->counter.start({"Draw a view", work, done})) wanted_.push_back(index);
}

std::vector<std::shared_ptr<const Image>> ViewPictures::of_views() const {
    std::vector<std::shared_ptr<const Image>> pictures;
    if (drawn_.empty()) return pictures;
    for (const View& view : workspace_.document.state().views) {
        const auto found = std::find_if(drawn_.begin(), drawn_.end(), [&](const auto& one) {
            return same_viewpoint(one.first, view.camera);
        });
        pictures.push_back(found == drawn_.end() ? nullptr : found->second);
    }
    return pictures;
}

}  // namespace gse::app
