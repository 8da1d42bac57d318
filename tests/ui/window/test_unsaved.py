"""An edit that runs or waits is unsaved work: leaving asks, what is kept is offered again, also where the
scene is named."""
import json
import pathlib
import shutil
import time
import unittest

from window import PROGRAM, WindowTest


def sample_scene(folder, cameras=0):
    """The bundled scene as a file of the artist's own, with cameras beside it."""
    source = pathlib.Path(PROGRAM).resolve().parent
    while not (source / "assets/scenes/bear/scene.ply").exists():
        source = source.parent
    folder.mkdir()
    shutil.copy(source / "assets/scenes/bear/scene.ply", folder / "scene.ply")
    views = [{"id": i, "img_name": f"view{i}", "width": 64, "height": 64, "position": [0, 0, -4 - i],
                "rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "fx": 64, "fy": 64} for i in range(cameras)]
    if views:
        (folder / "cameras.json").write_text(json.dumps(views))
    return folder / "scene.ply"


class Unsaved(WindowTest):
    def begin_edit(self, window):
        window.write("prompt.source", "bear")
        window.write("prompt.sentence", "a blue bear")
        # takes long enough
        window.press("prompt.method.sds", lambda s: s["method"] == "sds", "the method was not chosen", 20)
        window.press("prompt.edit", lambda s: s["job"]["running"] or s["result_waiting"],
                     "the edit did not start")
        window.wait(lambda s: s["snapshots"] >= 1, "no snapshot came", 300)

    def save(self, window):
        window.key("ctrl+s")
        window.wait_widget("files.confirm")
        window.press("files.confirm", lambda s: s["project"] != "" and not s["unsaved"], "it was not saved")

    def test_leaving_in_the_middle_of_an_edit(self):
        scene = sample_scene(self.folder / "scenes")
        window = self.open(scene)
        window.wait(lambda s: s["splats"] > 0 and not s["busy"], "the scene did not open", 60)
        splats = window.state()["splats"]
        self.save(window)
        self.begin_edit(window)
        window.key("ctrl+q")
        window.wait_widget("question.0")
        window.picture("17_quit_asks")
        window.click("question.1")   # wait
        time.sleep(1)
        self.assertTrue(window.state()["job"]["running"] or window.state()["result_waiting"])
        window.press_close()
        window.wait_widget("question.0")
        window.press("question.0", lambda s: not s["job"]["running"], "the edit goes on")   # stop and keep
        self.assertEqual(window.ended(), 0)
        # Named on the command line: the offer lies over the scene.
        again = self.open(scene)
        again.wait(lambda s: s["splats"] == splats and not s["busy"], "the scene did not open", 60)
        again.wait_widget("recovery.recover.0")
        self.assertIn("recovery.thumbnail.0", again.widgets())
        self.assertEqual(again.state()["offers"], ["scene.gsep"])
        again.picture("18_recovery_offered")
        again.press("recovery.recover.0", lambda s: s["result_waiting"], "the edit did not come back")
        self.assertEqual(again.state()["offers"], [])
        again.picture("19_recovered")
        again.press("result.apply", lambda s: s["stack"] == 1, "the edit was not applied")
        again.key("ctrl+s")
        again.wait(lambda s: not s["unsaved"], "it was not saved", 30)
        again.key("ctrl+q")
        self.assertEqual(again.ended(), 0)
        last = self.open(self.folder / "scenes")   # the folder holds scene and project: it asks
        last.wait_widget("question.0", 60)
        last.picture("20_which")
        last.press("question.0", lambda s: s["stack"] == 1, "the project did not open")
        self.assertEqual(last.state()["offers"], [])
        self.assertEqual(last.close(), 0)

    def test_discarding_what_waits(self):
        window = self.open("--sample")
        window.wait(lambda s: s["splats"] > 0 and not s["busy"], "the sample did not open", 60)
        self.begin_edit(window)
        window.key("ctrl+q")
        window.wait_widget("question.2")
        # Not twice in a row: the next question has such a button, too.
        window.press("question.2", lambda s: not s["job"]["running"], "nothing was discarded", pause=15)
        window.wait(lambda s: not s["result_waiting"], "the edit waits")
        window.wait_widget("question.1", 60)   # the label that was found is unsaved too
        window.press("question.1", lambda s: False, "the window stays", pause=5)
        self.assertEqual(window.ended(), 0)
        again = self.open()
        self.assertEqual(again.state()["offers"], [])
        self.assertEqual(again.close(), 0)

    def test_a_folder_with_a_scene_and_cameras(self):
        scene = sample_scene(self.folder / "scenes", cameras=2)
        window = self.open(scene.parent)
        window.wait(lambda s: s["scene"] == str(scene), "the folder did not open", 60)
        window.wait(lambda s: not s["busy"], "no picture", 60)
        self.assertEqual([t for t in window.state()["toasts"] if "cannot" in t], [])
        for number in range(3):
            name = "screenshot.png" if number == 0 else f"screenshot-{number + 1}.png"
            window.key("F12")
            window.wait(lambda s: s["file_job"]["title"] == f"Screenshot {name}"
                        and not s["file_job"]["running"], f"no {name}", 60)
            self.assertTrue((scene.parent / name).exists(), name)
        widgets = window.widgets()
        toasts = {n: r for n, r in widgets.items() if n.startswith("toast.") and n.count(".") == 1}
        self.assertGreaterEqual(len(toasts), 1)
        window.picture("21_toasts")
        for name, toast in toasts.items():
            for other, rect in widgets.items():
                if other.startswith((name, "panel.")) or other == "viewport" or not rect["visible"]:
                    continue
                apart = (toast["x"] + toast["width"] <= rect["x"] + 1
                         or rect["x"] + rect["width"] <= toast["x"] + 1 or
                         toast["y"] + toast["height"] <= rect["y"] + 1
                         or rect["y"] + rect["height"] <= toast["y"] + 1)
                self.assertTrue(apart, f"{name} covers {other}")
        self.assertEqual(window.close(), 0)


if __name__ == "__main__":
    unittest.main()
