// Numbers with commas between.
#include "engine/pipeline/select/named_picture.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>

namespace gse::pipeline {

std::optional<NamedPicture> named_picture(const std::string& text, std::size_t count,
                                          const std::vector<std::size_t>& picture_counts) {
    std::vector<double> numbers;
    for (std::size_t begin = 0; begin <= text.size();) {
        const auto end = std::min(text.find(',', begin), text.size());
        const auto first = text.data() + begin, last = text.data() + end;
        double number = 0;
        const auto read = std::from_chars(first, last, number);
        if (read.ec != std::errc{} || read.ptr != last || !std::isfinite(number)) return std::nullopt;
        numbers.push_back(number);
        begin = end + 1;
    }
    if (numbers.size() < count || std::find(picture_counts.begin(), picture_counts.end(),
                                            numbers.size() - count) == picture_counts.end())
        return std::nullopt;
    NamedPicture picture;
    picture.place.assign(numbers.begin(), numbers.begin() + static_cast<std::ptrdiff_t>(count));
    const auto rest = numbers.size() - count;
    if (rest > 0) picture.parameters.azimuth = numbers[count];
    if (rest > 1) picture.parameters.elevation = numbers[count + 1];
    if (rest > 2) picture.parameters.zoom = numbers[count + 2];
    return picture;
}

}  // namespace gse::pipeline
