"""The real window by keys alone: the sample, the prompt, a search, menus; and what a start does and does not
keep."""
import time
import unittest

from window import WindowTest


class Keyboard(WindowTest):
    def tab_to(self, window, name, presses=120):
        for _ in range(presses):
            here = window.state()["focus"]
            if here == name:
                return
            window.xdotool("key", "Tab")
            window.wait(lambda s: s["focus"] != here, "Tab did not move the focus", 20)
        self.fail(f"Tab never came to {name}; it is at {window.state()['focus']}")

    def test_without_a_mouse(self):
        window = self.open()
        self.tab_to(window, "start.sample")
        window.key("Return")
        window.wait(lambda s: s["splats"] > 0 and not s["busy"], "the sample did not open", 60)
        window.key("p")   # into the prompt
        window.type("sentence", "a blue bear on the grass")
        # faster than frames are drawn: nothing is lost
        window.xdotool("key", "shift+Tab", "type", "--delay", "0", "bear")
        self.assertEqual(window.steady("source"), "bear")
        self.assertEqual(window.state()["sentence"], "a blue bear on the grass")
        window.wait_widget("prompt.locate")   # enabled once both are in
        self.tab_to(window, "prompt.locate")
        window.picture("20_focus_on_locate")
        window.key("space")
        window.wait(lambda s: s["job"]["title"].startswith("Locate"), "Space did not press the button", 20)
        window.idle()
        self.assertEqual(window.state()["job"]["error"], "")
        self.assertGreater(window.state()["labelled"], 100)
        # The menus: Alt, to the right, down, Enter. Tab left the tint alone.
        window.key("Alt_L")
        window.wait_widget("menu.open", 10)
        window.picture("21_menu_by_alt")
        window.key("Right")
        window.wait_widget("menu.undo", 10)
        before = window.state()["undo_position"]
        window.key("Return")
        window.wait(lambda s: s["undo_position"] == before - 1, "Enter did not choose Undo", 10)
        # The threshold of the label, by arrows; one step of undo each.
        window.key("ctrl+shift+z")
        window.wait(lambda s: s["undo_position"] == before, "redo", 10)
        self.tab_to(window, "tab.Labels")
        window.key("Return")
        self.tab_to(window, "labels.threshold")
        position = window.state()["undo_position"]
        for _ in range(12):
            window.xdotool("key", "Right")
            time.sleep(0.1)
        # A clear label stays as it is over a range of thresholds: the step of undo shows that the threshold
        # moved.
        window.wait(lambda s: s["undo_position"] > position, "the arrows did not move the threshold", 10)
        window.picture("22_threshold_by_keys")
        window.key("shift+F1")
        time.sleep(0.5)
        window.picture("23_keys")
        window.key("Escape")
        self.assertEqual(window.close(), 0)

    def test_fits_the_screen_and_forgets_the_scale(self):
        window = self.open(width=1366, height=768, sized=False)
        width, height = window.state()["framebuffer"]
        self.assertLessEqual(width, 1366)
        self.assertLessEqual(height, 768)
        self.assertGreater(width, 1200)
        normal = window.widgets()["start.open"]["height"]
        self.assertEqual(window.close(), 0)
        window = self.open("--scale", "1.6", width=1366, height=768, sized=False)
        self.assertGreater(window.widgets()["start.open"]["height"], 1.4 * normal)
        self.assertEqual(window.close(), 0)
        window = self.open(width=1366, height=768, sized=False)
        self.assertEqual(window.widgets()["start.open"]["height"], normal)
        self.assertEqual(window.close(), 0)


if __name__ == "__main__":
    unittest.main()
