// COLMAP sparse models in text: intrinsics of cameras, poses of images. Points are not read.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>

#include "engine/base/error.h"
#include "engine/io/cameras/cameras.h"
#include "engine/io/cameras/colmap_views.h"

namespace gse {
namespace {

constexpr std::string_view Blanks = " \t";
constexpr std::string_view ByteOrderMark = "\xef\xbb\xbf";
constexpr std::size_t WordsOfImage = 9;  // number, quaternion, translation, camera; then the name
constexpr std::size_t LongestWord = 24;  // bytes, in a message

/// Lines of a text, with their numbers.
class Lines {
public:
    explicit Lines(std::string_view text) : text_(text) {
        if (text_.starts_with(ByteOrderMark)) text_.remove_prefix(ByteOrderMark.size());
    }
    bool next(std::string_view& line) {
        if (text_.empty()) return false;
        ++number_;
        line = first();
        text_.remove_prefix(std::min(text_.find('\n'), text_.size() - 1) + 1);
        return true;
    }
    /// The line that next() would give; empty at the end.
    std::string_view first() const {
        std::string_view line = text_.substr(0, text_.find('\n'));
        if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
        return line;
    }
    bool at_end() const { return text_.empty(); }
    std::size_t number() const { return number_; }

private:
    std::string_view text_;
    std::size_t number_ = 0;
};

std::string_view next_word(std::string_view& rest) {
    const std::size_t begin = std::min(rest.find_first_not_of(Blanks), rest.size());
    rest.remove_prefix(begin);
    const std::size_t size = std::min(rest.find_first_of(Blanks), rest.size());
    const std::string_view word = rest.substr(0, size);
    rest.remove_prefix(size);
    return word;
}

std::size_t count_words(std::string_view rest) {
    std::size_t count = 0;
    while (!next_word(rest).empty()) ++count;
    return count;
}

template <class T> std::optional<T> as_number(std::string_view word) {
    T value{};
    const auto [end, failure] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (failure != std::errc{} || end != word.data() + word.size()) return std::nullopt;
    return value;
}

template <class T> T needed_number(std::string_view word) {
    const auto value = as_number<T>(word);
    if (!value)
        throw Error(ErrorCode::Malformed,
                    fmt::format("\"{}\" stands where a number belongs", word.substr(0, LongestWord)));
    return *value;
}

bool is_comment(std::string_view line) {
    const std::size_t first = line.find_first_not_of(Blanks);
    return first != std::string_view::npos && line[first] == '#';
}

bool is_blank(std::string_view line) { return line.find_first_not_of(Blanks) == std::string_view::npos; }

/// A camera from what follows its number: model, width, height, parameters.
io::Intrinsics intrinsics_of_line(std::string_view rest) {
    const io::ColmapModel& model = io::colmap_model(next_word(rest));
    const std::size_t words = count_words(rest);
    if (words < 2)
        throw Error(ErrorCode::Malformed,
                    fmt::format("the line ends before the image size of the {} camera", model.name));
    const auto width = needed_number<double>(next_word(rest));
    const auto height = needed_number<double>(next_word(rest));
    if (words - 2 != model.params)
        throw Error(ErrorCode::Malformed,
                    fmt::format("a {} camera needs {} parameters after the image size, and the line has {}",
                                model.name, model.params, words - 2),
                    "export the model from COLMAP again");
    std::array<double, io::MostColmapParams> params{};
    for (std::size_t p = 0; p < model.params; ++p) params[p] = needed_number<double>(next_word(rest));
    return io::colmap_intrinsics(model, width, height, {params.data(), model.params});
}

io::ColmapCameras parse_text_cameras(std::string_view text) {
    io::ColmapCameras cameras;
    Lines lines(text);
    std::string_view line;
    while (lines.next(line)) {
        if (is_comment(line) || is_blank(line)) continue;
        const std::string_view word = next_word(line);
        const auto id = as_number<std::uint32_t>(word);
        if (!id)
            throw Error(ErrorCode::Malformed,
                        fmt::format("line {} of cameras.txt begins with \"{}\" in place of a camera's number",
                                    lines.number(), word.substr(0, LongestWord)),
                        "the file is damaged or not from COLMAP");
        try {
            cameras.insert_or_assign(*id, intrinsics_of_line(line));
        } catch (const Error& error) {
            cameras.insert_or_assign(*id, Error(error.code(),
                                                fmt::format("camera {} in line {} of cameras.txt: {}", *id,
                                                            lines.number(), error.message()),
                                                error.hint()));
        }
    }
    return cameras;
}

/// First line of an image.
struct ImageLine {
    std::array<double, 7> pose{};
    std::uint32_t camera = 0;
    std::string_view name;  // may hold blanks
};

ImageLine parse_image_line(std::string_view line) {
    if (const std::size_t words = count_words(line); words < WordsOfImage)
        throw Error(ErrorCode::Malformed,
                    fmt::format("an image needs {} numbers and a name, and the line has {} entries",
                                WordsOfImage, words));
    ImageLine image;
    next_word(line);  // image number
    for (double& value : image.pose) value = needed_number<double>(next_word(line));
    image.camera = needed_number<std::uint32_t>(next_word(line));
    line.remove_prefix(std::min(line.find_first_not_of(Blanks), line.size()));
    image.name = line;
    return image;
}

/// True for an image's line where another image's points should be: some tools leave the lines of points out.
/// Points are threes of numbers; a line of numbers is an image only where it cannot be points.
bool is_image_line(std::string_view line, const io::ColmapCameras& cameras) {
    const std::string_view whole = line;
    if (!as_number<std::uint32_t>(next_word(line))) return false;
    for (int i = 0; i < 7; ++i)
        if (!as_number<double>(next_word(line))) return false;
    const auto camera = as_number<std::uint32_t>(next_word(line));
    if (!camera || is_blank(line)) return false;
    bool numbers_only = true;
    while (numbers_only && !is_blank(line)) numbers_only = as_number<double>(next_word(line)).has_value();
    return !numbers_only || (cameras.contains(*camera) && count_words(whole) % 3 != 0);
}

/// Skips the points of an image. Their line may be empty, so that blank lines count, and may be missing.
void skip_points(Lines& lines, const io::ColmapCameras& cameras) {
    std::string_view line;
    while (is_comment(lines.first())) lines.next(line);
    if (!is_image_line(lines.first(), cameras)) lines.next(line);
}

}  // namespace

CameraList parse_colmap_text(std::string_view camera_text, std::string_view image_text) {
    const io::ColmapCameras cameras = parse_text_cameras(camera_text);
    io::ColmapViews views(cameras);
    Lines lines(image_text);
    std::string_view line;
    while (lines.next(line)) {
        if (is_comment(line) || is_blank(line)) continue;
        try {
            const ImageLine image = parse_image_line(line);
            views.add(image.name, image.pose, image.camera);
        } catch (const Error& error) {
            views.leave_out(fmt::format("line {} of images.txt", lines.number()), error);
        }
        skip_points(lines, cameras);
    }
    return views.finish();
}

}  // namespace gse
