"""Words in the real window: a clicked target does not outlive its sentence, an unknown thing is labelled by
hand, a search that finds nothing shows its evidence."""
import time
import unittest

from window import WindowTest


class Words(WindowTest):
    def start(self):
        window = self.open()
        window.click("start.sample")
        window.wait(lambda s: s["splats"] > 0 and not s["busy"], "the sample did not open")
        window.type_number("prompt.iterations", "20")
        return window

    def chip(self, window, name):
        """Clicks a word of the sentence by its place in it."""
        window.wait_widget(name)
        window.click(name)

    def test_a_target_goes_with_its_sentence(self):
        window = self.start()
        window.write("prompt.source", "bear")
        window.write("prompt.sentence", "a blue bear on the grass")
        self.chip(window, "prompt.chip.1")
        window.wait(lambda s: s["target"] == "blue", "the click did not make it the target", 10)
        window.click("prompt.edit")
        window.wait(lambda s: s["job"]["running"], "the edit did not start", 20)
        window.idle(300)
        window.click("result.apply")
        window.wait(lambda s: s["stack"] == 1, "the edit was not applied", 10)
        window.click("tab.Prompt")
        window.write("prompt.sentence", "a blue bear wearing a hat")
        window.wait(lambda s: s["target"] == "hat", "it is still about the old word", 10)
        window.write("prompt.sentence", "a blue golden bear")
        window.wait(lambda s: s["target"] == "golden", "what is blue already is no news", 10)
        window.picture("words_01_news")
        # A click counts for this sentence, and a project opens without it when it says nothing any more.
        self.chip(window, "prompt.chip.1")
        window.wait(lambda s: s["target"] == "blue", "the click did not count", 10)
        window.key("ctrl+s")
        time.sleep(1)
        if "files.confirm" in window.widgets():
            window.click("files.confirm")
        window.wait(lambda s: s["project"] != "" and not s["unsaved"], "it was not saved", 30)
        project = window.state()["project"]
        self.assertEqual(window.close(), 0)
        again = self.open(project)
        again.wait(lambda s: s["stack"] == 1, "the project did not open", 30)
        again.wait(lambda s: s["target"] == "golden", "the old word is still the target", 10)
        again.wait_widget("prompt.edit", enabled=True)
        again.close()

    def test_an_unknown_thing_is_clicked(self):
        window = self.start()
        window.write("prompt.source", "skull")
        window.write("prompt.sentence", "a golden skull on the grass")
        time.sleep(0.5)
        window.key("shift+Return")          # the edit asks for the thing first
        window.wait_widget("prompt.chip.1")     # the sentence stays in sight
        self.assertFalse(window.state()["job"]["running"])
        window.picture("words_05_click")
        window.click("viewport", 0.5, 0.55)     # on the bear
        window.wait(lambda s: s["labelled"] > 100 and not s["job"]["running"], "nothing was labelled", 60)
        state = window.state()
        self.assertLess(state["labelled"], state["splats"] * 0.7)    # without the grass
        window.picture("words_06_clicked")
        window.key("Escape")
        window.wait_widget("prompt.edit", enabled=True)
        window.click("prompt.edit")
        window.wait(lambda s: s["job"]["running"], "the edit did not start", 20)
        window.idle(300)
        self.assertEqual(window.state()["job"]["error"], "")
        self.assertTrue(window.state()["result_waiting"])
        window.close()

    def test_an_unknown_thing_is_labelled_by_hand_and_edited(self):
        window = self.start()
        window.write("prompt.source", "sign")
        window.write("prompt.sentence", "a golden sign on the grass")
        time.sleep(0.5)
        widgets = window.widgets()
        self.assertFalse(widgets["prompt.locate"]["enabled"])
        self.assertFalse(widgets["prompt.edit"]["enabled"])
        window.picture("words_02_unknown")
        window.click("prompt.source.by_hand")
        window.drag("viewport", [(0.4, 0.3), (0.5, 0.5), (0.6, 0.75)])   # a box around the bear
        window.wait(lambda s: s["labelled"] > 20 and not s["job"]["running"], "nothing was cut out", 30)
        window.key("b")
        window.drag("viewport", [(0.45, 0.45), (0.5, 0.5), (0.55, 0.5)])
        labelled = window.steady("labelled")
        window.click("tab.Prompt")
        window.wait_widget("prompt.edit", enabled=True)
        window.click("prompt.edit")
        window.wait(lambda s: s["job"]["running"], "the edit did not start", 20)
        window.idle(300)
        state = window.state()
        self.assertEqual(state["job"]["error"], "")
        self.assertTrue(state["result_waiting"])
        self.assertEqual(state["labelled"], labelled)
        window.picture("words_03_by_hand")
        window.close()

    def test_a_search_that_finds_nothing_shows_its_evidence(self):
        window = self.start()
        window.write("prompt.source", "bear")
        window.write("prompt.sentence", "a golden bear")
        window.scroll_to("prompt.advanced", "panel.Prompt")
        window.click("prompt.advanced")
        window.scroll_to("prompt.group.Localization", "panel.Prompt")
        window.click("prompt.group.Localization")
        window.scroll_to("request.least_confidence", "panel.Prompt")
        window.type_number("request.least_confidence", "0.999")
        window.click("prompt.locate")
        window.wait(lambda s: s["job"]["running"], "the search did not start", 20)
        window.idle(300)
        state = window.state()
        self.assertEqual(state["labelled"], 0)
        self.assertEqual(state["views_attended"], 24)
        self.assertIn("bear", state["search"]["message"])
        self.assertTrue(0 < state["search"]["confidence"] < 1)
        for text in [*state["toasts"], state["search"]["remedy"], state["job"]["error"]]:
            self.assertNotIn("--", text)
        window.wait_widget("attention.view.0")
        window.picture("words_04_evidence")
        window.click("attention.anyway")
        window.wait(lambda s: s["labelled"] > 100, "it was not labelled", 60)
        window.picture("words_05_anyway")
        window.close()


if __name__ == "__main__":
    unittest.main()
