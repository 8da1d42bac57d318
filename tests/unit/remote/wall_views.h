// Views of a wall, drawings and requests for rounds of a server, and a cache in memory.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/answer_cache.h"
#include "engine/remote/views/round_drawing.h"
#include "tests/unit/remote/test_pictures.h"

namespace remote_walls {

using namespace gse;
using namespace gse::remote;
using namespace remote_pictures;

inline constexpr int Side = 128;
inline constexpr double Distance = 4;  // of the plane that the views show

/// A wall that faces the cameras, which stand beside each other.
inline std::vector<edit::EditView> views_of_wall(std::size_t count) {
    std::vector<edit::EditView> views;
    for (std::size_t v = 0; v < count; ++v) {
        edit::EditView view;
        auto& camera = view.view.camera;
        camera.width = camera.height = Side;
        camera.fx = camera.fy = Side;
        camera.cx = camera.cy = Side / 2.0;
        camera.translation = {-0.125 * static_cast<double>(v), 0, 0};  // 4 px of the picture
        view.view.name = "view " + std::to_string(v);
        view.rendered = view.original = waves(Side, -4.0 * static_cast<double>(v));
        view.depth = Image(Side, Side, 1, static_cast<float>(Distance));
        view.mask = disc(Side, 30, Side / 2.0 - 4.0 * static_cast<double>(v), Side / 2.0);
        views.push_back(std::move(view));
    }
    return views;
}

inline RemoteDrawing drawing_of(Agreement agreement, std::string_view family = "sd15") {
    return {{"a golden wall", "make the wall golden", ""}, family_named(family), agreement, Side};
}

inline edit::EditViewsRequest request_of(int round = 0) {
    edit::EditViewsRequest request;
    request.round = round, request.rounds = round + 1, request.seed = 17;
    return request;
}

/// Answers in memory.
class MemoryAnswers final : public AnswerCache {
public:
    std::optional<std::string> find(std::string_view question) override {
        const auto found = answers.find(std::string(question));
        return found == answers.end() ? std::nullopt : std::optional(found->second);
    }
    void keep(std::string_view question, std::string_view answer) override {
        answers[std::string(question)] = answer;
    }
    std::map<std::string, std::string> answers;
};

}  // namespace remote_walls
