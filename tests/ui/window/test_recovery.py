"""kill -9 at ten random moments of an editing session: every time the work of the last seconds before comes
back."""
import random
import time
import unittest

from window import WindowTest

SEED = 20261121
KILLS = 10
LOST_SECONDS = 6   # autosave comes every 3 seconds; a loaded machine may need as long again to write


class Recovery(WindowTest):
    def test_killed_at_random_moments(self):
        generator = random.Random(SEED)
        window = self.open("--sample")
        window.wait(lambda s: s["splats"] > 0, "the sample did not open", 60)
        original = window.state()["splats"]
        known = 0    # steps of the label that must have survived
        for kill in range(KILLS):
            self.work(window, generator, kill)
            window.kill()
            window = self.open()
            window.wait(lambda s: s["recoverable"] >= 1, f"nothing to recover after kill {kill}", 30)
            if kill == 0:
                window.picture("14_recovery")
            window.click("start.recover.0")
            window.wait(lambda s: s["splats"] > 0, f"kill {kill}: the project did not open", 60)
            if window.state()["result_waiting"]:   # the edit that ran when it was killed
                window.click("result.apply")
                window.wait(lambda s: s["stack"] >= 1, f"kill {kill}: the edit could not be applied", 20)
            state = window.state()
            self.assertGreaterEqual(state["splats"], original * 0.9)
            self.assertEqual(state["file_job"]["error"], "")
            if self.expects_label:
                self.assertGreater(state["labelled"], 0, f"kill {kill}: the label is lost")
        self.assertEqual(window.close(), 0)

    expects_label = False

    def work(self, window, generator, kill):
        """Brush strokes, sometimes an edit, then a moment of any length up to the kill."""
        window.click("tool.brush")
        x = generator.uniform(0.4, 0.6)
        for _ in range(4):   # until a stroke has arrived
            window.drag("viewport", [(x, 0.5), (x + 0.03, 0.55), (x, 0.6)])
            if window.steady("labelled") > 0:
                break
        if kill % 3 == 1:
            window.click("tool.orbit")
            window.write("prompt.source", "bear")
            window.write("prompt.sentence", "a blue bear")
            # takes long enough
            window.press("prompt.method.sds", lambda s: s["method"] == "sds", "the method was not chosen", 20)
            window.click("prompt.edit")
            window.wait(lambda s: s["snapshots"] >= 1 or not s["job"]["running"], "no snapshot came")
        # later ones have the first's to fall back on
        pause = generator.uniform(0, 2 * LOST_SECONDS) + (LOST_SECONDS if kill == 0 else 0)
        time.sleep(pause)
        if pause > LOST_SECONDS:
            self.expects_label = True


if __name__ == "__main__":
    unittest.main()
