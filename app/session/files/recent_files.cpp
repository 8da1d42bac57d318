// Pictures by the names of their files; a broken one is none.
#include "app/session/files/recent_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/io/files/user_files.h"
#include "engine/io/image/image_file.h"

namespace gse::app {
namespace {

constexpr std::size_t MostPictures = 8;  // as many as the start page lists

std::filesystem::path picture_folder() { return state_folder() / "recent"; }

std::filesystem::path picture_path(const std::filesystem::path& file) {
    return picture_folder() / fmt::format("{:016x}.png", std::hash<std::string>{}(file.string()));
}

std::shared_ptr<const Image> kept_picture(const std::filesystem::path& file) {
    std::error_code ignored;
    if (!std::filesystem::exists(picture_path(file), ignored)) return nullptr;
    try {
        return std::make_shared<const Image>(read_image(picture_path(file)));
    } catch (const Error&) { return nullptr; }
}

/// Removes the pictures of files that are not listed.
void remove_others(const std::vector<std::filesystem::path>& files) {
    std::set<std::filesystem::path> kept;
    for (const auto& file : files) kept.insert(picture_path(file));
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(picture_folder(), ignored))
        if (!kept.contains(entry.path())) std::filesystem::remove(entry.path(), ignored);
}

}  // namespace

void RecentFiles::list() {
    const auto files = load_recent();
    paths_.clear();
    pictures_.clear();
    for (const auto& file : files) {
        paths_.push_back(file.string());
        if (pictures_.size() < MostPictures) pictures_.push_back(kept_picture(file));
    }
}

void RecentFiles::add(const std::filesystem::path& path, Draw draw) {
    add_recent(path);
    list();
    waiting_ = {path, std::move(draw)};
}

void RecentFiles::refresh() {
    if (!waiting_ || workspace_.jobs->works() || workspace_.jobs->counter.running()) return;
    auto work = [path = waiting_->first, draw = waiting_->second, files = load_recent()](const JobControl&) {
        const auto picture = draw();
        if (picture == nullptr) return;
        std::filesystem::create_directories(picture_folder());
        remove_others(files);
        write_png(picture_path(path), *picture);
    };
    auto done = [this](const Error* error) {
        if (error != nullptr) log::warning("a recent file has no picture ({})", error->what());
        list();
    };
    if (workspace_.jobs->counter.start({"Draw a recent file", work, done})) waiting_.reset();
}

void RecentFiles::show(ui::DocumentPart& model) const {
    model.recent = paths_;
    model.recent_pictures = pictures_;
}

}  // namespace gse::app
