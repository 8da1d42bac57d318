// Text and lines by OpenCV.
#include "engine/io/drawing.h"

#include <algorithm>
#include <cmath>

#ifdef GSE_HAVE_OPENCV
#include <opencv2/imgproc.hpp>
#endif

namespace gse {

#ifdef GSE_HAVE_OPENCV

namespace {

constexpr int Font = cv::FONT_HERSHEY_SIMPLEX;
constexpr double CapitalHeight = 21;   // of the font at scale 1, pixels
constexpr int SubpixelBits = 4;

cv::Mat view_of(Image& image) { return {image.height, image.width, CV_32FC3, image.data.data()}; }
cv::Scalar scalar(const DrawColour& colour) { return {colour[0], colour[1], colour[2]}; }

/// OpenCV blends antialiased lines into 8-bit pictures only: they are drawn as coverage first.
template <class Draw>
void blend(Image& image, const DrawColour& colour, Draw draw) {
    if (image.channels != 3 || image.pixel_count() == 0) return;
    cv::Mat coverage = cv::Mat::zeros(image.height, image.width, CV_8UC1);
    draw(coverage);
    cv::Mat picture = view_of(image);
    cv::Mat share;
    coverage.convertTo(share, CV_32F, 1.0 / 255);
    cv::cvtColor(share, share, cv::COLOR_GRAY2BGR);
    const cv::Mat paint(picture.size(), CV_32FC3, scalar(colour));
    picture += share.mul(paint - picture);
}

}  // namespace

void draw_text(Image& image, double x, double y, const std::string& text, double height, const DrawColour& colour) {
    blend(image, colour, [&](cv::Mat& coverage) {
        cv::putText(coverage, text, {static_cast<int>(std::lround(x)), static_cast<int>(std::lround(y))}, Font,
                    height / CapitalHeight, cv::Scalar(255), 1, cv::LINE_AA);
    });
}

double text_width(const std::string& text, double height) {
    int baseline = 0;
    return cv::getTextSize(text, Font, height / CapitalHeight, 1, &baseline).width;
}

void draw_polyline(Image& image, std::span<const std::array<double, 2>> points, double thickness, const DrawColour& colour) {
    const auto fixed = [](double value) { return static_cast<int>(std::lround(value * (1 << SubpixelBits))); };
    const auto drawable = [](const std::array<double, 2>& p) {
        constexpr double Far = 1e6;   // pixels; fixed-point coordinates overflow beyond
        return std::abs(p[0]) < Far && std::abs(p[1]) < Far;
    };
    const int width = std::max(1, static_cast<int>(std::lround(thickness)));
    blend(image, colour, [&](cv::Mat& coverage) {
        for (std::size_t i = 1; i < points.size(); ++i) {
            const auto &a = points[i - 1], &b = points[i];
            if (!drawable(a) || !drawable(b)) continue;
            cv::line(coverage, {fixed(a[0]), fixed(a[1])}, {fixed(b[0]), fixed(b[1])}, cv::Scalar(255), width, cv::LINE_AA,
                     SubpixelBits);
        }
    });
}

#else

void draw_text(Image&, double, double, const std::string&, double, const DrawColour&) {}
double text_width(const std::string&, double) { return 0; }
void draw_polyline(Image&, std::span<const std::array<double, 2>>, double, const DrawColour&) {}

#endif

}  // namespace gse
