// Small pictures of the scene from the document's views, drawn beside the frames when they are asked for.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "app/session/preview_host.h"
#include "app/session/state/workspace.h"
#include "engine/base/image.h"

namespace gse::app {

class ViewPictures {
public:
    explicit ViewPictures(Workspace& workspace) : workspace_(workspace) {}
    /// Another document is open: none of its views is drawn.
    void take_document();
    /// Has a view of the document drawn.
    void want(std::size_t view);
    /// Draws the next one of `set`, with the settings of the viewport's picture. Once per frame.
    void refresh(const GaussianSet& set, const PictureRequest& shown);
    /// [views] null = not drawn yet. A view that was moved is not drawn yet.
    std::vector<std::shared_ptr<const Image>> of_views() const;

private:
    Workspace& workspace_;
    std::vector<std::size_t> wanted_;
    std::vector<std::pair<Camera, std::shared_ptr<const Image>>> drawn_;
};

}  // namespace gse::app
