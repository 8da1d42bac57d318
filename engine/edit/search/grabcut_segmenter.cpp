// GrabCut over OpenCV, and the threshold that stands in for it.
#include "engine/edit/search/grabcut_segmenter.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "engine/base/check.h"
#include "engine/base/error.h"
#include "engine/base/memory_cache.h"

#ifdef GSE_HAVE_OPENCV
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#endif

namespace gse::edit {
namespace {

/// Calls visit(x, y) for the pixels of a disc around a click, at least the click's own pixel.
template <class F> void for_disc(const Image& image, const PointPrompt& point, double radius_px, F&& visit) {
    const auto from = [&](double centre, int size) {
        return static_cast<int>(std::clamp(centre - radius_px - 1, 0.0, static_cast<double>(size)));
    };
    const auto to = [&](double centre, int size) {
        return static_cast<int>(std::clamp(centre + radius_px + 1, 0.0, static_cast<double>(size)));
    };
    for (int y = from(point.y, image.height); y < to(point.y, image.height); ++y)
        for (int x = from(point.x, image.width); x < to(point.x, image.width); ++x) {
            const bool own = x == static_cast<int>(point.x) && y == static_cast<int>(point.y);
            const double dx = x + 0.5 - point.x, dy = y + 0.5 - point.y;
            if (own || dx * dx + dy * dy <= radius_px * radius_px) visit(x, y);
        }
}

class ThresholdSegmenter : public Segmenter {
public:
    explicit ThresholdSegmenter(double level) : level_(level) {}
    Mask segment(const Image& image, const std::vector<PointPrompt>& points,
                 const std::optional<BoxPrompt>& box, const Image& hint) override {
        Mask mask(image.width, image.height);
        for (std::size_t i = 0; i < std::min(hint.data.size(), mask.data.size()); ++i)
            mask.data[i] = hint.data[i] >= level_ ? 1 : 0;
        if (hint.data.empty() && box)
            for (int y = 0; y < image.height; ++y)
                for (int x = 0; x < image.width; ++x)
                    mask.at(x, y) =
                        x + 0.5 >= box->x0 && x + 0.5 <= box->x1 && y + 0.5 >= box->y0 && y + 0.5 <= box->y1
                            ? 1
                            : 0;
        constexpr double radius = 0.02;  // of the width
        for (const auto& point : points)
            for_disc(image, point, radius * image.width,
                     [&](int x, int y) { mask.at(x, y) = point.positive ? 1 : 0; });
        return mask;
    }
    std::string name() const override { return "threshold"; }

private:
    double level_;
};

#ifdef GSE_HAVE_OPENCV

constexpr std::size_t MostAnswers = 512;  // 5 MB at 96 x 96

class GrabCutSegmenter : public Segmenter {
public:
    explicit GrabCutSegmenter(const GrabCutParameters& parameters) : parameters_(parameters) {}

    Mask segment(const Image& image, const std::vector<PointPrompt>& points,
                 const std::optional<BoxPrompt>& box, const Image& hint) override {
        GSE_CHECK_EQ(image.channels, 3);
        cv::Mat marks = trimap(image, points, box, hint);
        Mask result(image.width, image.height);
        if (both_present(marks)) cut_once(image, marks);
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x) {
                const auto mark = marks.at<std::uint8_t>(y, x);
                result.at(x, y) = mark == cv::GC_FGD || mark == cv::GC_PR_FGD ? 1 : 0;
            }
        return result;
    }
    std::string name() const override { return "grabcut"; }

private:
    cv::Mat trimap(const Image& image, const std::vector<PointPrompt>& points,
                   const std::optional<BoxPrompt>& box, const Image& hint) const {
        cv::Mat marks(image.height, image.width, CV_8UC1);
        const double margin = parameters_.box_margin * image.width;
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x) {
                const double value = hint.data.empty() ? 0 : hint.at(x, y, 0);
                const bool boxed = !box || (x + 0.5 >= box->x0 - margin && x + 0.5 <= box->x1 + margin &&
                                            y + 0.5 >= box->y0 - margin && y + 0.5 <= box->y1 + margin);
                int mark = value > parameters_.probable_inside ? cv::GC_PR_FGD : cv::GC_PR_BGD;
                if (!boxed && value < std::max(parameters_.certain_outside, parameters_.probable_inside))
                    mark = cv::GC_BGD;
                if (hint.data.empty() && box && boxed) mark = cv::GC_PR_FGD;
                marks.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(mark);
            }
        for (const auto& point : points)
            for_disc(image, point, parameters_.click_radius * image.width, [&](int x, int y) {
                marks.at<std::uint8_t>(y, x) =
                    static_cast<std::uint8_t>(point.positive ? cv::GC_FGD : cv::GC_BGD);
            });
        return marks;
    }

    /// GrabCut needs samples of both kinds.
    static bool both_present(const cv::Mat& marks) {
        const int inside = cv::countNonZero(marks == cv::GC_FGD) + cv::countNonZero(marks == cv::GC_PR_FGD);
        return inside > 0 && inside < marks.rows * marks.cols;
    }

    /// A threshold that is dragged leaves the marks of many views as they are: those are not cut again.
    void cut_once(const Image& image, cv::Mat& marks) {
        ContentHash question;
        question.image(image);
        question.bytes(marks.data, marks.total());
        const cv::Mat answer = answers_.get(question.key(), [&] {
            cut(image, marks);
            return marks.clone();
        });
        answer.copyTo(marks);
    }

    void cut(const Image& image, cv::Mat& marks) const {
        cv::Mat bytes(image.height, image.width, CV_8UC3);
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x)
                for (int c = 0; c < 3; ++c)
                    bytes.at<cv::Vec3b>(y, x)[c] = static_cast<std::uint8_t>(
                        std::lround(255 * std::clamp(image.at(x, y, c), 0.0f, 1.0f)));
        try {
            cv::Mat background, foreground;
            cv::setRNGSeed(1);  // its k-means starts at random
            cv::grabCut(bytes, marks, cv::Rect(), background, foreground, parameters_.iterations,
                        cv::GC_INIT_WITH_MASK);
        } catch (const cv::Exception& failure) {
            throw Error(ErrorCode::Foreign, std::string("the segmentation failed: ") + failure.what());
        }
    }

    GrabCutParameters parameters_;
    MemoryCache<cv::Mat> answers_{MostAnswers};  // marks after the cut, [H,W] bytes
};

#endif

}  // namespace

std::unique_ptr<Segmenter> make_threshold_segmenter(double level) {
    return std::make_unique<ThresholdSegmenter>(level);
}

#ifdef GSE_HAVE_OPENCV

bool grabcut_available() { return true; }

std::unique_ptr<Segmenter> make_grabcut_segmenter(const GrabCutParameters& parameters) {
    return std::make_unique<GrabCutSegmenter>(parameters);
}

#else

bool grabcut_available() { return false; }

std::unique_ptr<Segmenter> make_grabcut_segmenter(const GrabCutParameters&) {
    throw Error(ErrorCode::Unsupported, "this program was built without OpenCV, so there is no GrabCut",
                "build with GSE_OPENCV=ON");
}

#endif

std::unique_ptr<Segmenter> make_default_segmenter() {
    return grabcut_available() ? make_grabcut_segmenter() : make_threshold_segmenter();
}

}  // namespace gse::edit
