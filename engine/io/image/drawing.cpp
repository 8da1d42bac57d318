// Text and lines by OpenCV.
#include "engine/io/image/drawing.h"

#include <algorithm>
#include <cmath>

#ifdef GSE_HAVE_OPENCV
#include <opencv2/imgproc.hpp>
#endif

namespace gse {

#ifdef GSE_HAVE_OPENCV

namespace {

constexpr int Font = cv::FONT_HERSHEY_SIMPLEX;
constexpr double CapitalHeight = 21;  // of the font at scale 1, pixels
constexpr int SubpixelBits = 4;

cv::Mat view_of(Image& image) { return {image.height, image.width, CV_32FC3, image.data.data()}; }
cv::Scalar scalar(const DrawColour& colour) { return {colour[0], colour[1], colour[2]}; }

/// Blends lines into `area`, drawn as coverage first. OpenCV blends antialiased lines into 8-bit pictures
/// only.
template <class Draw> void blend(Image& image, cv::Rect area, const DrawColour& colour, Draw draw) {
    area &= cv::Rect(0, 0, image.width, image.height);
    if (image.channels != 3 || area.empty()) return;
    cv::Mat coverage = cv::Mat::zeros(area.size(), CV_8UC1);
    draw(coverage, area.tl());
    cv::Mat picture = view_of(image)(area);
    cv::Mat share;
    coverage.convertTo(share, CV_32F, 1.0 / 255);
    cv::cvtColor(share, share, cv::COLOR_GRAY2BGR);
    const cv::Mat paint(picture.size(), CV_32FC3, scalar(colour));
    picture += share.mul(paint - picture);
}

bool drawable(const std::array<double, 2>& p) {
    constexpr double Far = 1e6;  // pixels; fixed-point coordinates overflow beyond
    return std::abs(p[0]) < Far && std::abs(p[1]) < Far;
}

/// Area that lines between the points cover, with the room of their thickness.
cv::Rect area_of(std::span<const std::array<double, 2>> points, int width) {
    cv::Rect area;
    for (const auto& p : points)
        if (drawable(p))
            area |= cv::Rect(static_cast<int>(p[0]) - width - 2, static_cast<int>(p[1]) - width - 2,
                             2 * width + 5, 2 * width + 5);
    return area;
}

}  // namespace

void draw_text(Image& image, double x, double y, const std::string& text, double height,
               const DrawColour& colour) {
    const cv::Point start(static_cast<int>(std::lround(x)), static_cast<int>(std::lround(y)));
    int below = 0;
    const cv::Size size = cv::getTextSize(text, Font, height / CapitalHeight, 1, &below);
    constexpr int room = 3;
    const cv::Rect area(start.x - room, start.y - size.height - room, size.width + 2 * room,
                        size.height + below + 2 * room);
    blend(image, area, colour, [&](cv::Mat& coverage, const cv::Point& corner) {
        cv::putText(coverage, text, start - corner, Font, height / CapitalHeight, cv::Scalar(255), 1,
                    cv::LINE_AA);
    });
}

double text_width(const std::string& text, double height) {
    int baseline = 0;
    return cv::getTextSize(text, Font, height / CapitalHeight, 1, &baseline).width;
}

void draw_polyline(Image& image, std::span<const std::array<double, 2>> points, double thickness,
                   const DrawColour& colour) {
    const auto fixed = [](double value) {
        return static_cast<int>(std::lround(value * (1 << SubpixelBits)));
    };
    const int width = std::max(1, static_cast<int>(std::lround(thickness)));
    blend(image, area_of(points, width), colour, [&](cv::Mat& coverage, const cv::Point& corner) {
        for (std::size_t i = 1; i < points.size(); ++i) {
            const auto &a = points[i - 1], &b = points[i];
            if (!drawable(a) || !drawable(b)) continue;
            const auto place = [&](const std::array<double, 2>& p) {
                return cv::Point(fixed(p[0] - corner.x), fixed(p[1] - corner.y));
            };
            cv::line(coverage, place(a), place(b), cv::Scalar(255), width, cv::LINE_AA, SubpixelBits);
        }
    });
}

#else

void draw_text(Image&, double, double, const std::string&, double, const DrawColour&) {}
double text_width(const std::string&, double) { return 0; }
void draw_polyline(Image&, std::span<const std::array<double, 2>>, double, const DrawColour&) {}

#endif

}  // namespace gse
