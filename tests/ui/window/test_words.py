"""Words in the real window: a clicked target does not outlive its sentence, an unknown thing is labelled by
hand, a search that finds nothing shows its evidence, a thing that was added is not added twice."""
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

    def run_edit(self, window):
        window.wait_widget("prompt.edit", enabled=True)
        window.click("prompt.edit")
        window.wait(lambda s: s["job"]["running"], "the edit did not start", 20)
        self.result(window)

    def result(self, window):
        window.wait(lambda s: s["result_waiting"] and not s["job"]["running"], "no result waits", 300)
        self.assertEqual(window.state()["job"]["error"], "")

    def apply(self, window, stack):
        window.click("result.apply")
        window.wait(lambda s: s["stack"] == stack, f"{stack} edits are not on the stack", 20)

    def test_a_hat_is_added_then_the_bear_and_the_hat_are_edited(self):
        window = self.open()
        window.click("start.sample")
        window.wait(lambda s: s["splats"] > 0 and not s["busy"], "the sample did not open")
        splats = window.state()["splats"]
        window.write("prompt.source", "bear")
        window.write("prompt.sentence", "a bear wearing a blue hat")
        window.scroll_to("prompt.quality.draft", "panel.Prompt")
        window.click("prompt.quality.draft")
        self.run_edit(window)
        for text in window.state()["toasts"]:    # nothing was corrected before the first hat
            self.assertNotIn("by hand", text)
        window.click("result.another")
        window.wait(lambda s: s["job"]["running"], "no other result is made", 20)
        self.result(window)
        self.apply(window, 1)
        state = window.state()
        with_hat = state["splats"]
        self.assertGreater(with_hat, splats)
        self.assertEqual(state["labels"]["active"], "hat")
        # Variations stay, and are exchanged by a click.
        kept = state["labels"]["variations"]
        self.assertEqual([(one["applied"], one["results"]) for one in kept], [(1, 2)])
        window.click("tab.History")
        name = f"history.variation.{kept[0]['edit']}.0"
        window.scroll_to(name, "panel.History")
        window.picture("words_07_variations")
        window.click(name)
        window.wait(lambda s: s["labels"]["variations"][0]["applied"] == 0, "it was not exchanged", 10)
        with_hat = window.state()["splats"]
        few = (with_hat - splats) // 4    # an edit may add some splats, another hat would be as many again
        # The next sentence about the bear is not about the hat, and asks nothing.
        window.click("tab.Prompt")
        window.write("prompt.sentence", "a golden bear")
        window.wait(lambda s: s["labels"]["changes"] == "bear", "the bear's label is not used", 10)
        self.run_edit(window)
        self.assertNotIn("question.0", window.widgets())
        self.assertEqual(window.state()["labels"]["active"], "bear")
        self.apply(window, 2)
        self.assertLess(abs(window.state()["splats"] - with_hat), few)
        # The hat once more: the one that is there can be changed.
        window.click("tab.Prompt")
        window.write("prompt.sentence", "a bear wearing a blue hat")
        window.wait_widget("prompt.edit", enabled=True)
        window.click("prompt.edit")
        window.wait_widget("question.2")
        window.picture("words_08_second_hat")
        window.click("question.0")
        window.wait(lambda s: s["source"] == "hat" and s["job"]["running"], "the hat is not edited", 20)
        self.assertEqual(window.state()["sentence"], "a blue hat")
        self.result(window)
        self.apply(window, 3)
        self.assertLess(abs(window.state()["splats"] - with_hat), few)
        self.assertEqual(window.close(), 0)

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
