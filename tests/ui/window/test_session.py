"""An artist's first minutes in the real window: open, orbit, locate, correct, edit, pause, cancel, undo,
compare, export, save, reopen."""
import pathlib
import time
import unittest

from window import PATIENCE, WindowTest


class Session(WindowTest):
    def test_first_five_minutes(self):
        window = self.open("--validate")
        window.picture("01_start")
        window.click("start.sample")
        window.wait(lambda s: s["splats"] > 0 and not s["busy"], "the sample did not open")
        print("start to first frame:", (self.folder / "first_frame").read_text().strip(), "s")
        window.picture("02_opened")
        self.orbits(window)
        self.locates(window)
        self.corrects(window)
        self.edits(window)
        self.exports(window)
        self.saves_and_reopens(window)

    def orbits(self, window):
        before = window.state()["frames"]
        window.drag("viewport", [(0.5, 0.5), (0.55, 0.5), (0.62, 0.52)])
        self.assertGreater(window.state()["frames"], before + 3)
        window.wait(lambda s: not s["busy"], "the picture did not come to rest", 30)
        window.picture("03_orbited")
        window.click("tool.home")
        time.sleep(1)

    def locates(self, window):
        window.write("prompt.source", "bear")
        window.write("prompt.sentence", "a blue bear on the grass")
        window.picture("04_prompt")
        window.click("prompt.locate")
        window.idle()
        state = window.state()
        self.assertEqual(state["job"]["error"], "")
        self.assertGreater(state["labelled"], 100)
        self.assertEqual(state["views_attended"], 24)
        window.click("tab.Attention")
        window.wait(lambda s: not s["busy"], "the picture did not come to rest", 30)
        window.picture("05_located")
        self.looks_at_evidence(window)

    def looks_at_evidence(self, window):
        found = window.state()["labelled"]
        window.click("attention.view.4")
        window.wait_widget("evidence.votes")
        window.picture("05b_view_with_attention")
        window.press("evidence.votes", lambda s: s["left_out"] == "4", "the view was not left out", 30,
                     pause=5)
        window.idle()
        window.picture("05c_left_out")
        window.key("ctrl+z")
        window.wait(lambda s: s["left_out"] == "" and s["labelled"] == found,
                    "undo did not put the view back", 20)
        window.idle()
        window.key("Escape")
        window.click("tool.home")
        window.wait(lambda s: not s["busy"], "the picture did not come to rest", 30)

    def chooses_and_hides(self, window):
        """On the tab of the labels."""
        before, labelled = window.state()["splats"], window.state()["labelled"]
        window.scroll_to("pick.open", "panel.Labels")
        window.click("pick.open")
        window.scroll_to("pick.side.Above", "panel.Labels")
        window.press("pick.side.Above", lambda s: s["picked"] > 0, "nothing is chosen by opacity", 20,
                     pause=3)
        window.picture("07b_chosen_by_opacity")
        window.scroll_to("pick.open", "panel.Labels")
        window.press("pick.open", lambda s: s["picked"] == 0, "what was chosen is still shown", 20, pause=3)
        window.key("i")
        window.wait(lambda s: s["hidden"] == before - labelled, "the label was not isolated", 10)
        window.picture("07c_isolated")
        window.key("shift+h")
        window.wait(lambda s: s["hidden"] == 0 and s["labelled"] == labelled, "what was hidden is not shown",
                    10)

    def corrects(self, window):
        found = window.state()["labelled"]
        window.click("tool.brush")
        window.drag("viewport", [(0.50, 0.45), (0.52, 0.50), (0.50, 0.55)], keys=["ctrl"])
        window.wait(lambda s: s["labelled"] < found, "the brush took nothing away", 10)
        corrected = window.steady("labelled")   # the stroke's last dabs may still be on their way
        window.picture("06_brushed")
        window.key("ctrl+z")
        window.wait(lambda s: s["labelled"] == found, "undo did not give it back", 10)
        window.key("ctrl+shift+z")
        window.wait(lambda s: s["labelled"] == corrected, "redo did not take it away", 10)
        window.key("ctrl+z")
        window.click("tool.orbit")
        window.click("tab.Labels")
        window.picture("07_labels")
        self.chooses_and_hides(window)
        window.click("tab.Prompt")

    def edits(self, window):
        window.click("tab.Progress")
        # takes long enough to be paused and cancelled
        window.press("prompt.method.sds", lambda s: s["method"] == "sds", "the method was not chosen", 20)
        window.click("prompt.edit")
        window.wait(lambda s: s["snapshots"] >= 2, "no snapshot came")
        window.picture("08_editing")
        window.click("job.pause")
        window.wait(lambda s: s["job"]["paused"], "it did not pause", 10)
        time.sleep(PATIENCE)   # the step it is in is the last
        standing = window.state()["losses"]
        time.sleep(PATIENCE)
        self.assertEqual(window.state()["losses"], standing)
        window.click("job.pause")
        window.wait(lambda s: s["losses"] > standing + 5, "it did not go on")
        window.cancel_job()
        window.idle(60)
        self.assertTrue(window.state()["result_waiting"])
        window.click("result.discard")
        window.wait(lambda s: not s["result_waiting"], "discard did nothing", 10)
        window.press("prompt.method.auto", lambda s: s["method"] == "auto", "the method was not chosen", 20)
        window.click("prompt.edit")
        window.wait(lambda s: s["job"]["running"], "the second edit did not start", 20)
        window.idle(300)
        self.assertEqual(window.state()["job"]["error"], "")
        self.assertTrue(window.state()["result_waiting"])
        window.picture("09_result")
        window.click("result.apply")
        window.wait(lambda s: s["stack"] == 1, "the edit was not applied", 10)
        window.key("v")
        window.wait(lambda s: s["comparison"] == 1 and not s["busy"], "no wipe", 20)
        time.sleep(0.5)
        window.picture("10_wipe")
        window.key("v")
        window.key("ctrl+z")
        window.wait(lambda s: s["stack"] == 0, "undo kept the edit", 10)
        window.key("ctrl+y")
        window.wait(lambda s: s["stack"] == 1, "redo did not bring it back", 10)

    def exports(self, window):
        window.click("tab.Export")
        window.picture("11_export")
        window.key("F12")
        window.wait(lambda s: any("Wrote" in t and ".png" in t for t in s["toasts"]),
                    "no screenshot was written", 60)
        window.key("shift+F12")
        window.wait(lambda s: any("Wrote" in t and "mp4" in t for t in s["toasts"]),
                    "no turntable was written", 240)
        written = sorted(p.name for p in self.folder.iterdir())
        self.assertIn("turntable.mp4", written)
        self.assertTrue(any(name.endswith(".png") for name in written), written)
        self.assertGreater((self.folder / "turntable.mp4").stat().st_size, 10000)

    def saves_and_reopens(self, window):
        window.key("ctrl+s")
        time.sleep(1)
        if "files.confirm" in window.widgets():
            window.click("files.confirm")
        window.wait(lambda s: s["project"] != "" and not s["unsaved"], "it was not saved", 30)
        project = pathlib.Path(window.state()["project"])
        splats, labelled = window.state()["splats"], window.state()["labelled"]
        self.assertEqual(window.state()["validation_messages"], 0)
        window.picture("12_saved")
        self.assertEqual(window.close(), 0)
        again = self.open(project)
        again.wait(lambda s: s["splats"] == splats, "the project did not open", 30)
        self.assertEqual(again.state()["stack"], 1)
        self.assertEqual(again.state()["labelled"], labelled)
        again.wait(lambda s: not s["busy"], "the picture did not come", 30)
        again.picture("13_reopened")
        self.assertEqual(again.close(), 0)


if __name__ == "__main__":
    unittest.main()
