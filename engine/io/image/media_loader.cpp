// Loads the library that reads image files and encodes films.
#include "engine/base/plugin.h"
#include "engine/io/image/media.h"

namespace gse::io {

Media& media() {
    static constexpr PluginName name{"libgse_media.so",
                                     "gse_media",
                                     "the library for images and films",
                                     "this build reads no image files and writes no films",
                                     "build with -DGSE_OPENCV=ON",
                                     "install libopencv-imgcodecs406 and libopencv-videoio406"};
    static Media* const library = reinterpret_cast<Media* (*)()>(load_plugin(name))();
    return *library;
}

}  // namespace gse::io
