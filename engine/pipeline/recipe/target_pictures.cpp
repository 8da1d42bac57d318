// Files of pictures for views: colours of a square.
#include "engine/pipeline/recipe/target_pictures.h"

#include <algorithm>

#include <fmt/format.h>

#include "engine/base/error.h"
#include "engine/base/printable.h"
#include "engine/io/image/image_file.h"
#include "engine/remote/views/acceptance.h"
#include "engine/remote/views/view_frame.h"

namespace gse::pipeline {
namespace {

constexpr int LeastSide = 64;

Image as_colour(const Image& read) {
    Image picture(read.width, read.height, 3);
    const auto step = static_cast<std::size_t>(read.channels);
    for (std::size_t i = 0; i < picture.pixel_count(); ++i)
        for (std::size_t c = 0; c < 3; ++c)
            picture.data[i * 3 + c] = read.data[i * step + (step < 3 ? 0 : c)];
    return picture;
}

}  // namespace

std::vector<remote::OwnPicture> read_target_pictures(const remote::ServerSettings& settings) {
    std::vector<remote::OwnPicture> pictures;
    for (const auto& text : settings.target_picture) {
        const auto [view, file] = remote::target_picture_of(text);
        if (std::any_of(pictures.begin(), pictures.end(),
                        [&view = view](const auto& other) { return other.view == view; }))
            throw Error(ErrorCode::InvalidArgument,
                        fmt::format("the view \"{}\" has two pictures", printable(view)),
                        "leave one of them out");
        auto picture = as_colour(read_image(file));
        if (!remote::is_square(picture) || std::min(picture.width, picture.height) < LeastSide)
            throw Error(ErrorCode::InvalidArgument,
                        fmt::format("the picture has {} x {} pixels, and views are squares of {} or more",
                                    picture.width, picture.height, LeastSide),
                        "paint over a picture that --views-only writes", file);
        const int side = std::max(picture.width, picture.height);
        pictures.push_back({view, remote::at_side(picture, side)});
    }
    return pictures;
}

}  // namespace gse::pipeline
