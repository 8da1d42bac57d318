"""Sentences with several changes in the real window: the plan is shown, a step is left out, both are applied
together and undone one by one; a sentence with nothing to do, and one in German, are refused in words."""
import unittest

from window import WindowTest


class Steps(WindowTest):
    def run_edit(self, window, applied):
        window.wait_widget("prompt.edit", enabled=True)
        window.click("prompt.edit")
        window.wait(lambda s: s["job"]["running"], "the edit did not start", 20)
        window.wait(lambda s: s["result_waiting"] and not s["job"]["running"], "no result waits", 300)
        window.picture(f"steps_{applied}_result")
        window.click("result.apply")
        window.wait(lambda s: s["stack"] == applied, f"{applied} edits are not on the stack", 20)

    def test_steps_are_left_out_made_together_and_undone_one_by_one(self):
        window = self.open()
        window.click("start.sample")
        window.wait(lambda s: s["splats"] > 0 and not s["busy"], "the sample did not open")
        splats = window.state()["splats"]
        window.write("prompt.source", "bear")
        window.write("prompt.sentence", "a blue bear wearing a red hat")
        window.wait_widget("prompt.step.2")
        window.picture("steps_plan")
        window.scroll_to("prompt.quality.draft", "panel.Prompt")
        window.click("prompt.quality.draft")
        window.scroll_to("prompt.step.2", "panel.Prompt")
        window.click("prompt.step.2")
        self.run_edit(window, 1)
        window.key("ctrl+z")
        window.wait(lambda s: s["stack"] == 0 and s["splats"] == splats, "the colour was not taken back", 10)

        window.click("tab.Prompt")
        window.scroll_to("prompt.step.2", "panel.Prompt")
        window.click("prompt.step.2")
        self.run_edit(window, 2)
        self.assertGreater(window.state()["splats"], splats)
        window.key("ctrl+z")
        window.wait(lambda s: s["stack"] == 1, "the hat was not taken back", 10)
        window.key("ctrl+z")
        window.wait(lambda s: s["stack"] == 0 and s["splats"] == splats, "the colour was not taken back", 10)

        window.click("tab.Prompt")
        window.scroll_to("prompt.sentence", "panel.Prompt")
        for sentence in ("leave the bear as it is", "gib ihm einen roten Hut"):
            window.write("prompt.sentence", sentence)
            window.wait(lambda s: not window.widgets()["prompt.edit"]["enabled"], "Edit is on", 10)
            window.picture("steps_" + sentence.split()[0])
        window.close()


if __name__ == "__main__":
    unittest.main()
