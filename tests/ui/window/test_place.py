"""Things placed and removed in the real window: handles are dragged, in steps while Ctrl is held, numbers are
typed, a labelled thing is deleted and its hole healed, a brush heals, an order removes, a second scene is put
in; each is undone."""
import pathlib
import unittest

from window import WindowTest

SAMPLE = pathlib.Path(__file__).resolve().parents[3] / "assets/scenes/bear/scene.ply"


class Place(WindowTest):
    def start(self):
        """The sample with its bear labelled."""
        window = self.open()
        window.click("start.sample")
        window.wait(lambda s: s["splats"] > 0 and not s["busy"], "the sample did not open")
        window.write("prompt.source", "bear")
        window.key("ctrl+l")
        window.wait(lambda s: s["labelled"] > 0 and not s["job"]["running"], "the bear is not labelled", 120)
        return window

    def undo(self, window, stack):
        window.click("viewport", 0.9, 0.2)  # no field has the keys
        window.key("ctrl+z")
        window.wait(lambda s: s["stack"] == stack, f"{stack} edits are not left", 20)

    def test_handles_and_numbers_place_what_is_labelled(self):
        window = self.start()
        splats = window.state()["splats"]
        window.click("tool.place")
        window.wait_widget("gizmo.side")
        window.picture("place_01_handles")
        window.drag("gizmo.side", [(0.5, 0.5), (4, 0.5), (7, 0.5)])
        window.wait(lambda s: s["stack"] == 1, "the thing was not moved", 20)
        window.drag("gizmo.turn", [(0.5, 0.5), (2, 2), (4, 3)], keys=("ctrl",))
        window.picture("place_02_dragged")
        self.assertEqual(window.state()["stack"], 1)  # one step while nothing else is done
        self.assertEqual(window.state()["splats"], splats)
        self.undo(window, 0)

        window.click("tab.Labels")
        window.scroll_to("place.open", "panel.Labels")
        if "place.move_right" not in window.widgets():
            window.click("place.open")
        window.scroll_to("place.resize", "panel.Labels")
        window.type_number("place.resize", "1.5")
        window.wait(lambda s: s["stack"] == 1, "the typed size changed nothing", 20)
        window.picture("place_03_typed")
        self.undo(window, 0)
        window.close()

    def test_a_second_scene_is_put_in_and_dragged(self):
        window = self.open()
        window.click("start.sample")
        window.wait(lambda s: s["splats"] > 0 and not s["busy"], "the sample did not open")
        splats = window.state()["splats"]
        window.click("menu.File")
        window.click("menu.put_in")
        window.wait_widget("files.path")
        window.click("files.path")
        window.key("ctrl+a")
        window.xdotool("type", "--delay", "20", str(SAMPLE))
        window.key("Return")
        window.wait(lambda s: s["stack"] == 1 and s["splats"] == 2 * splats, "it was not put in", 60)
        self.assertEqual(window.state()["labelled"], splats)
        window.wait_widget("gizmo.ground")
        window.picture("place_08_put_in")
        window.drag("gizmo.ground", [(0.5, 0.5), (4, 2), (6, 3)])
        window.wait(lambda s: s["stack"] == 2, "it was not dragged", 20)
        self.undo(window, 1)
        self.undo(window, 0)
        window.close()

    def test_a_thing_is_deleted_and_its_hole_healed(self):
        window = self.start()
        splats = window.state()["splats"]
        window.click("viewport", 0.9, 0.2)
        window.key("ctrl+Delete")
        window.wait(lambda s: s["stack"] == 1 and not s["job"]["running"], "nothing was deleted", 60)
        window.picture("place_04_healed")
        self.assertLess(window.state()["splats"], splats)
        self.assertEqual(window.state()["labelled"], 0)
        self.undo(window, 0)
        window.wait(lambda s: s["splats"] == splats, "the thing did not come back", 20)

        window.key("j")
        window.drag("viewport", [(0.3, 0.85), (0.34, 0.85), (0.4, 0.86)])
        window.wait(lambda s: s["stack"] == 1 and not s["job"]["running"], "the brush healed nothing", 60)
        window.picture("place_05_brush")
        window.key("Escape")
        self.undo(window, 0)

        window.click("tab.Prompt")
        window.write("prompt.sentence", "remove the bear")
        window.wait_widget("prompt.edit", enabled=True)
        window.picture("place_06_order")
        window.click("prompt.edit")
        window.wait(lambda s: s["result_waiting"] and not s["job"]["running"], "no result waits", 120)
        window.picture("place_07_removed")
        window.click("result.apply")
        window.wait(lambda s: s["stack"] == 1, "the removal was not applied", 20)
        self.assertLess(window.state()["splats"], splats)
        self.undo(window, 0)
        window.close()


if __name__ == "__main__":
    unittest.main()
