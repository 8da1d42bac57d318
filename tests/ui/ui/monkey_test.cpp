// Nonsense from mouse and keyboard, seeded: the window must take it without an assertion, and draw in its
// place.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <array>
#include <cmath>

#include "engine/base/random.h"
#include "tests/ui/support/harness.h"
#include "ui/keys/keys.h"

namespace gse::test::monkey_test {
namespace {

namespace key = ui::key;
constexpr std::array<int, 38> Keys{'B',
                                   'R',
                                   'L',
                                   'F',
                                   'H',
                                   'N',
                                   'V',
                                   'W',
                                   'A',
                                   'S',
                                   'D',
                                   'Q',
                                   'E',
                                   'Z',
                                   'Y',
                                   'I',
                                   'O',
                                   '=',
                                   '-',
                                   key::LeftBracket,
                                   key::RightBracket,
                                   key::Grave,
                                   key::Tab,
                                   key::Escape,
                                   key::Enter,
                                   key::Delete,
                                   key::Left,
                                   key::Right,
                                   key::F1,
                                   key::F11,
                                   key::F12,
                                   key::F6,
                                   key::Up,
                                   key::Down,
                                   'P',
                                   'T',
                                   342,
                                   key::Space};
constexpr int Steps = 1500;

/// One random thing a hand may do.
void act(Harness& harness, Random& random) {
    auto& io = ImGui::GetIO();
    const auto& widgets = harness.shell.widgets();
    switch (random.below(8)) {
        case 0:
            io.MousePos = {static_cast<float>(random.uniform(-20, 1300)),
                           static_cast<float>(random.uniform(-20, 740))};
            break;
        case 1: io.MouseDown[random.below(3)] = true; break;
        case 2: io.MouseDown[0] = io.MouseDown[1] = io.MouseDown[2] = false; break;
        case 3: io.MouseWheel = static_cast<float>(random.uniform(-3, 3)); break;
        case 4: io.KeysDown[Keys[random.below(Keys.size())]] = random.uniform() < 0.5; break;
        case 5:
            harness.modifiers(random.uniform() < 0.3, random.uniform() < 0.3, random.uniform() < 0.2);
            break;
        case 6: io.AddInputCharactersUTF8(random.uniform() < 0.5 ? "bear 7" : "\xC3\xA4\xD0\xBC"); break;
        default: {
            // Somewhere on a widget, so that the nonsense reaches all of them.
            auto chosen = widgets.begin();
            std::advance(chosen, static_cast<std::ptrdiff_t>(random.below(widgets.size())));
            const auto& rect = chosen->second;
            io.MousePos = {rect.x + rect.width * static_cast<float>(random.uniform()),
                           rect.y + rect.height * static_cast<float>(random.uniform())};
        }
    }
}

}  // namespace

DOCTEST_TEST_CASE("nonsense from mouse and keyboard is survived") {
    for (const auto situation : {Situation::Nothing, Situation::Scene, Situation::Located, Situation::Editing,
                                 Situation::ResultWaiting})
        for (const std::uint64_t seed : {1u, 2u}) {
            Harness harness({1280, 720, 1, situation, false});
            Random random(seed * 77 + static_cast<std::uint64_t>(situation));
            for (int step = 0; step < Steps; ++step) {
                act(harness, random);
                harness.frame();
                const auto& camera = harness.application.model().camera;
                if (!std::isfinite(camera.translation.x + camera.fx))
                    DOCTEST_FAIL("the camera is not finite at step " << step);
            }
            DOCTEST_CHECK(harness.rect("viewport").width > 100);
        }
}

}  // namespace gse::test::monkey_test
