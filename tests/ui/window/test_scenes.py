"""Scenes change under the window: nothing of the last one is left, a project says that it only refers to its
scene, and a scene that moved is found again, all by clicks and keys."""
import time
import unittest

from test_unsaved import sample_scene
from window import WindowTest


class Scenes(WindowTest):
    def choose(self, window, path):
        """Types a path into the file dialog and enters it."""
        window.wait_widget("files.path")
        window.click("files.path")
        window.key("ctrl+a")
        window.xdotool("type", "--delay", "20", str(path))
        window.key("Return")

    def test_another_scene_and_one_that_moved(self):
        first, second = sample_scene(self.folder / "first"), sample_scene(self.folder / "second")
        window = self.open(first)
        window.wait(lambda s: s["splats"] > 0 and not s["busy"], "the scene did not open", 90)
        window.write("prompt.source", "bear")
        window.write("prompt.sentence", "a blue bear on the grass")
        window.click("prompt.locate")
        window.wait(lambda s: s["labelled"] > 0, "nothing was found")
        window.idle()
        self.saves_without_an_ending(window)
        self.opens(window, second)
        self.loses(window, first)
        self.assertEqual(window.close(), 0)

    def saves_without_an_ending(self, window):
        window.key("ctrl+s")
        window.wait_widget("files.name")
        window.click("files.name")
        window.key("ctrl+a")
        window.xdotool("type", "--delay", "20", "work")
        window.press("files.confirm", lambda s: s["project"].endswith("work.gsep") and not s["unsaved"],
                     "it was not saved")
        window.wait(lambda s: any("does not hold it" in toast for toast in s["toasts"]),
                    "nothing says that the scene is not in the project", 10)
        window.picture("scenes_1_saved")
        self.assertNotEqual(window.state()["saved_at"], "")

    def opens(self, window, scene):
        window.key("ctrl+o")
        self.choose(window, scene)
        window.wait(lambda s: s["scene"] == str(scene) and not s["busy"], "the other scene did not open", 60)
        window.picture("scenes_2_another")
        state = window.state()
        self.assertEqual((state["source"], state["sentence"], state["saved_at"], state["project"]),
                         ("", "", "", ""))
        self.assertEqual((state["views_attended"], state["labelled"], state["job"]["title"]), (0, 0, ""))
        self.assertFalse([toast for toast in state["toasts"] if "labelled" in toast or "hold it" in toast])

    def loses(self, window, scene):
        moved = self.folder / "elsewhere.ply"
        scene.rename(moved)
        window.key("ctrl+o")
        self.choose(window, scene.parent / "work.gsep")
        window.wait(lambda s: s["lost_scene"] == str(scene), "nothing says that the scene is gone", 30)
        window.wait_widget("lost.find")
        window.picture("scenes_3_gone")
        window.click("lost.find")
        self.choose(window, moved)
        window.wait(lambda s: s["scene"] == str(moved) and s["labelled"] > 0, "the scene was not found", 60)
        self.assertEqual(window.state()["lost_scene"], "")
        self.assertTrue(window.state()["unsaved"])   # the project does not know the place yet
        time.sleep(0.5)
        window.picture("scenes_4_found")


if __name__ == "__main__":
    unittest.main()
