// Words of a scene as it is said: things with colours and materials, grounds among them.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gse::language::plan {

struct SceneThing {
    std::string noun;                     // "tree stump"
    std::vector<std::string> attributes;  // "gray", "stone"
    bool is_ground = false;
    bool is_worn = false;  // by a thing that stands before it
};

/// Things that the scene shows, in the order in which they are said.
struct SceneWords {
    std::vector<SceneThing> things;
    /// Index of the ground; nothing where none is said.
    std::optional<std::size_t> ground() const;
    /// Index of the only thing that is neither ground nor worn; nothing where there are several.
    std::optional<std::size_t> only_thing() const;
};

/// Reads "red bear; blue hat; grass".
SceneWords scene_words(std::string_view list);

}  // namespace gse::language::plan
