"""Redrawn views in the real window: the edit waits, one view is dropped and another redrawn by clicks, then
the scene is fitted to the rest."""
import unittest

from window import WindowTest


class Targets(WindowTest):
    def test_one_view_is_dropped_and_another_redrawn(self):
        window = self.open("--sample")
        window.wait(lambda s: s["splats"] > 0 and not s["busy"], "the sample did not open")
        window.write("prompt.source", "bear")
        window.write("prompt.sentence", "a blue bear on the grass")
        window.press("prompt.method.views", lambda s: s["method"] == "views", "the method was not chosen", 20)
        window.click("tab.Targets")
        window.press("targets.review", lambda s: s["targets"]["review"], "the edit will not wait", 20,
                     pause=3)
        window.press("prompt.edit", lambda s: s["job"]["running"], "the edit did not start", 30)
        window.wait(lambda s: s["targets"]["waits"], "the edit does not wait for the artist", 240)
        views = window.state()["targets"]["views"]
        self.assertEqual(len(views), 8)
        window.wait_widget("targets.0.drop")
        window.picture("targets_1_waiting")
        window.press("targets.0.drop", lambda s: s["targets"]["views"][0]["dropped"],
                     "the view was not dropped", 20, pause=3)
        passes = window.state()["cost"]["unet"]
        window.press("targets.1.redo", lambda s: s["targets"]["views"][1]["redrawn"] > 0,
                     "the view was not redrawn", 60, pause=10)
        state = window.state()
        self.assertTrue(state["targets"]["waits"])
        self.assertEqual(state["losses"], 0)   # nothing is fitted yet
        window.picture("targets_2_chosen")
        window.press("targets.fit", lambda s: not s["targets"]["waits"], "the fit did not begin", 20)
        window.wait(lambda s: s["result_waiting"], "the edit did not end", 120)
        state = window.state()
        self.assertEqual(state["job"]["error"], "")
        self.assertEqual(state["losses"], 40)
        self.assertGreater(state["cost"]["unet"], passes)
        self.assertTrue(state["targets"]["views"][0]["dropped"])
        window.wait(lambda s: not s["busy"], "the picture did not come to rest", 30)
        window.picture("targets_3_result")
        window.press("result.apply", lambda s: s["stack"] == 1, "the edit was not applied", 20)
        self.assertEqual(window.close(), 0)


if __name__ == "__main__":
    unittest.main()
