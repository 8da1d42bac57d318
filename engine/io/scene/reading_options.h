// Settings of reading a scene, as the command line offers them.
#pragma once

namespace gse {

struct ReadingOptions {
    static constexpr const char* ActivatedHelp =
        "The PLY file holds sizes and opacities themselves, not their logarithms and logits; info says when "
        "a "
        "scene looks so.";

    bool activated = false;

    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        f("activated", self.activated, ActivatedHelp);
    }
};

}  // namespace gse
