// Shared by the tests of camera files: cameras around the middle, written in every form, and what is read.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "engine/base/json.h"
#include "engine/io/cameras/cameras.h"
#include "engine/io/image/image_file.h"
#include "tests/unit/io/io_helpers.h"

namespace gse::test {

namespace fs = std::filesystem;
using Json = nlohmann::json;

inline constexpr double Rounding =
    1e-9;  // of a rotation that goes through a quaternion or a scale, in doubles
inline constexpr double LensRounding = 1e-6;  // pixels; the right values were worked out from an angle

inline fs::path odd_folder() { return data_folder() / "odd"; }

/// `count` cameras around the middle, named a.png, b.png, ...
inline std::vector<View> ring(int count) {
    std::vector<View> views;
    for (int i = 0; i < count; ++i) {
        const Vec3 eye{4 * std::cos(i + 0.3), -1, 4 * std::sin(i + 0.3)};
        views.push_back({std::string(1, static_cast<char>('a' + i)) + ".png",
                         Camera::look_at(eye, {0, 0, 0}, {0, -1, 0}, 0.9, 64, 48), false});
    }
    return views;
}

inline std::string number_text(double value) {
    std::ostringstream out;
    out.precision(17);
    out << value;
    return out.str();
}

inline std::string image_line(const View& view, int number, int camera = 1) {
    const Quat q = quaternion(view.camera.rotation);
    const Vec3& t = view.camera.translation;
    std::string line = std::to_string(number);
    for (const double value : {q.w, q.x, q.y, q.z, t.x, t.y, t.z}) line += " " + number_text(value);
    return line + " " + std::to_string(camera) + " " + view.name + "\n";
}

inline constexpr const char* OnePinhole = "# cameras\n1 PINHOLE 64 48 66 66 32 24\n";

/// images.txt of these views, each with `points` as its second line.
inline std::string image_lines(const std::vector<View>& views, const std::string& points) {
    std::string text = "# images\n";
    for (std::size_t i = 0; i < views.size(); ++i)
        text += image_line(views[i], static_cast<int>(i) + 1) + points;
    return text;
}

/// Entries of a cameras.json for these views.
inline Json camera_entries(const std::vector<View>& views) {
    Json list = Json::array();
    for (const View& view : views) {
        const Mat3 world = view.camera.rotation.transposed();
        Json rotation = Json::array();
        for (int row = 0; row < 3; ++row) rotation.push_back({world(row, 0), world(row, 1), world(row, 2)});
        const Vec3 centre = view.camera.centre();
        list.push_back({{"img_name", view.name},
                        {"width", view.camera.width},
                        {"height", view.camera.height},
                        {"position", {centre.x, centre.y, centre.z}},
                        {"rotation", rotation},
                        {"fx", view.camera.fx},
                        {"fy", view.camera.fy}});
    }
    return list;
}

/// A transforms.json for these views, which are alike but for their poses.
inline Json transforms(const std::vector<View>& views) {
    const Camera& first = views.front().camera;
    Json file = {{"fl_x", first.fx}, {"fl_y", first.fy}, {"w", first.width}, {"h", first.height}};
    file["frames"] = Json::array();
    for (const View& view : views) {
        const Mat3 world = view.camera.rotation.transposed();
        const Vec3 centre = view.camera.centre();
        Json matrix = Json::array();
        for (int row = 0; row < 3; ++row)
            matrix.push_back({world(row, 0), -world(row, 1), -world(row, 2), centre[row]});
        matrix.push_back({0, 0, 0, 1});
        file["frames"].push_back({{"file_path", view.name}, {"transform_matrix", matrix}});
    }
    return file;
}

inline std::vector<std::string> names_of(const std::vector<View>& views) {
    std::vector<std::string> names;
    for (const View& view : views) names.push_back(view.name);
    return names;
}

inline double largest_difference(const Camera& a, const Camera& b) {
    double largest = length(a.centre() - b.centre());
    for (std::size_t i = 0; i < 9; ++i)
        largest = std::max(largest, std::abs(a.rotation.rows()[i] - b.rotation.rows()[i]));
    return largest;
}

/// The views are those of `expected`, in its order: names and poses.
inline void check_views(const std::vector<View>& views, const std::vector<View>& expected) {
    DOCTEST_REQUIRE(names_of(views) == names_of(expected));
    for (std::size_t i = 0; i < views.size(); ++i)
        DOCTEST_CHECK(largest_difference(views[i].camera, expected[i].camera) < Rounding);
}

/// The views are what a truth.json of the shared samples states.
inline void check_truth(const std::vector<View>& views, const fs::path& truth_file) {
    const Json truth = parse_json(read_file(truth_file), "the right values");
    DOCTEST_REQUIRE(views.size() == truth.size());
    for (std::size_t i = 0; i < views.size(); ++i) {
        const Camera& camera = views[i].camera;
        const Json& right = truth[i];
        DOCTEST_CHECK(views[i].name == right["name"].get<std::string>());
        DOCTEST_CHECK(camera.width == right["width"].get<int>());
        DOCTEST_CHECK(camera.height == right["height"].get<int>());
        DOCTEST_CHECK(std::abs(camera.fx - right["fx"].get<double>()) < LensRounding);
        DOCTEST_CHECK(std::abs(camera.fy - right["fy"].get<double>()) < LensRounding);
        DOCTEST_CHECK(std::abs(camera.cx - right["cx"].get<double>()) < LensRounding);
        DOCTEST_CHECK(std::abs(camera.cy - right["cy"].get<double>()) < LensRounding);
        for (int row = 0; row < 3; ++row) {
            DOCTEST_CHECK(std::abs(camera.centre()[row] - right["position"][row].get<double>()) < Rounding);
            for (int column = 0; column < 3; ++column)
                DOCTEST_CHECK(std::abs(camera.rotation(column, row) -
                                       right["rotation"][row][column].get<double>()) < Rounding);
        }
    }
}

/// Every word is in the text.
inline void check_says(const std::string& text, std::initializer_list<const char*> words) {
    DOCTEST_CAPTURE(text);
    for (const char* word : words) {
        DOCTEST_CAPTURE(word);
        DOCTEST_CHECK(text.find(word) != std::string::npos);
    }
}

/// One note, with these words.
inline void check_note(const CameraList& list, std::initializer_list<const char*> words) {
    DOCTEST_REQUIRE(list.notes.size() == 1);
    check_says(list.notes[0], words);
}

inline std::string message_of(const std::optional<Error>& error) {
    return error ? std::string(error->what()) : "no error";
}

inline std::string changed(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    DOCTEST_REQUIRE(at != std::string::npos);
    return text.replace(at, from.size(), to);
}

/// A COLMAP model of that ending with one image, so that its name tells which model was read.
inline void write_model(const fs::path& folder, const std::string& name, const char* ending = ".txt") {
    fs::create_directories(folder);
    std::vector<View> views = ring(1);
    views[0].name = name;
    write_file(folder / (std::string("cameras") + ending), OnePinhole);
    write_file(folder / (std::string("images") + ending), image_lines(views, "\n"));
}

inline void write_picture(const fs::path& path, int width, int height) {
    fs::create_directories(path.parent_path());
    write_png(path, Image(width, height, 3));
}

}  // namespace gse::test
