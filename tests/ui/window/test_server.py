"""Image server in the real window: address, test, switch, question, an edit that it draws, and a stop."""
import json
import pathlib
import subprocess
import sys
import unittest
import urllib.request

from window import WindowTest

SUPPORT = pathlib.Path(__file__).resolve().parents[2] / "support"


class StandIn:
    """The stand-in server in a process of its own."""

    def __init__(self, flavour="sdserver"):
        program = [sys.executable, SUPPORT / "stand_in_server.py", "--flavour", flavour]
        self.process = subprocess.Popen(program, stdout=subprocess.PIPE, text=True)
        self.port = int(self.process.stdout.readline().split()[1])

    def ask(self, place):
        with urllib.request.urlopen(f"http://127.0.0.1:{self.port}/gse/{place}", timeout=10) as answer:
            return json.load(answer)

    def drawings(self):
        return [entry for entry in self.ask("log") if entry["path"].endswith("/img_gen")]

    def close(self):
        self.process.kill()
        self.process.wait()
        self.process.stdout.close()


@unittest.skipUnless((SUPPORT / "stand_in_server.py").exists(), "[skip] the stand-in server is not there")
class Server(WindowTest):
    def start(self, flavour="sdserver"):
        server = StandIn(flavour)
        self.addCleanup(server.close)
        window = self.open(height=1400)
        window.click("start.sample")
        window.wait(lambda s: s["splats"] > 0 and not s["busy"], "the sample did not open")
        window.write("prompt.source", "bear")
        window.write("prompt.sentence", "a golden bear")
        return window, server

    def tested(self, flavour="sdserver"):
        """A window whose server was tested."""
        window, server = self.start(flavour)
        window.click("tab.Models")
        window.scroll_to("models.server.url", "panel.Models")
        window.write("models.server.url", f"127.0.0.1:{server.port}")
        window.click("models.server.test")
        window.wait(lambda s: s["server"]["facts"] > 0, "the server was not asked", 30)
        return window, server

    def test_a_server_is_tested_switched_on_agreed_to_and_draws(self):
        window, server = self.tested()
        window.scroll_to("models.server.agreement", "panel.Models")
        window.picture("server_01_facts")
        self.assertFalse(window.state()["server"]["on"])
        self.assertEqual(server.drawings(), [])
        window.scroll_to("models.server.on", "panel.Models")
        window.press("models.server.on", lambda s: s["server"]["on"], "it is not on")
        window.click("tab.Prompt")
        window.press("prompt.edit", lambda s: s["question"], "nobody asks before pictures go")
        window.picture("server_02_question")
        self.assertEqual(server.drawings(), [])
        window.press("question.0", lambda s: s["job"]["running"], "the edit did not start")
        window.wait(lambda s: s["job"]["stage"].startswith("view "), "the views are not counted", 300)
        window.picture("server_03_progress")
        window.idle(400)
        window.wait(lambda s: s["result_waiting"], "there is no result", 20)
        window.picture("server_04_result")
        self.assertGreaterEqual(len(server.drawings()), 8)

    def test_a_lora_of_the_server_is_picked_and_goes_into_the_requests(self):
        window, server = self.tested()
        window.scroll_to("models.server.drawing", "panel.Models")
        window.click("models.server.drawing")
        window.scroll_to("models.server.lora", "panel.Models")
        window.click("models.server.lora")
        window.press("models.server.lora.bronze", lambda s: s["server"]["lora"] == ["bronze:1"],
                     "the LoRA was not picked")
        window.wait(lambda s: s["server"]["facts"] > 0 and not s["server"]["problem"], "it is not taken", 30)
        window.picture("server_05_drawing")
        window.scroll_to("models.server.on", "panel.Models")
        window.press("models.server.on", lambda s: s["server"]["on"], "it is not on")
        window.click("tab.Prompt")
        window.press("prompt.edit", lambda s: s["question"], "nobody asks before pictures go")
        window.press("question.0", lambda s: s["job"]["running"], "the edit did not start")
        window.idle(400)
        self.assertGreaterEqual(len(server.drawings()), 8)
        self.assertTrue(all("bronze" in json.dumps(entry["json"]) for entry in server.drawings()))

    def test_a_lora_is_typed_where_the_server_has_no_list(self):
        window, _ = self.tested("vllm")
        window.scroll_to("models.server.drawing", "panel.Models")
        window.click("models.server.drawing")
        window.scroll_to("models.server.lora.add", "panel.Models")
        window.write("models.server.lora", "/models/brass.safetensors:0.5")
        window.press("models.server.lora.add",
                     lambda s: s["server"]["lora"] == ["/models/brass.safetensors:0.5"],
                     "the LoRA was not taken")
        window.wait(lambda s: s["server"]["facts"] > 0 and not s["server"]["problem"], "it is refused", 30)
        window.picture("server_09_typed_lora")
        self.assertIn("models.server.lora.0.weight", window.widgets())

    def test_a_picture_in_the_making_is_shown_beside_what_was_sent(self):
        window, server = self.tested("forge")
        server.ask("set?draw_s=4&previews=1")
        window.press("models.server.on", lambda s: s["server"]["on"], "it is not on")
        window.click("tab.Prompt")
        window.press("prompt.edit", lambda s: s["question"], "nobody asks before pictures go")
        window.press("question.0", lambda s: s["job"]["running"], "the edit did not start")
        window.click("tab.Progress")
        window.wait(lambda s: s["job"]["stage"].startswith("view 2 "), "no view came", 300)
        window.wait_widget("progress.preview")
        window.picture("server_06_preview")
        shown = window.widgets()
        self.assertLess(shown["progress.sent"]["x"], shown["progress.preview"]["x"])
        window.cancel_job()
        window.idle(20)
        self.assertNotIn("progress.preview", window.widgets())

    def test_a_thing_without_a_word_is_found_by_the_server_after_a_click(self):
        server = StandIn()
        self.addCleanup(server.close)
        server.ask("set?model=flux1-kontext-dev&edits=red")
        config = self.folder / "config"
        config.mkdir()
        settings = {"url": f"http://127.0.0.1:{server.port}", "side": 128}   # which it draws quickly
        (config / "settings.json").write_text(json.dumps({"server": settings}))
        window = self.open(height=1400)
        window.click("start.sample")
        window.wait(lambda s: s["splats"] > 0 and not s["busy"], "the sample did not open")
        window.click("tab.Models")
        window.scroll_to("models.server.on", "panel.Models")
        window.press("models.server.on", lambda s: s["server"]["on"], "it is not on")
        window.click("tab.Prompt")
        window.write("prompt.source", "gizmo")
        window.write("prompt.sentence", "a golden gizmo")
        window.wait_widget("prompt.source.by_server", 20)
        window.picture("server_07_offer")
        self.assertEqual(server.drawings(), [])
        window.press("prompt.source.by_server", lambda s: s["job"]["running"], "the search did not start")
        window.idle(400)
        window.picture("server_08_found")
        self.assertIn(len(server.drawings()), (16, 32))
        self.assertGreater(window.state()["labelled"], 0)
        window.click("tab.Prompt")
        window.wait_widget("prompt.source.by_server", 20)   # what it found may be wrong
        window.picture("server_10_again")

    def test_servers_on_this_machine_are_looked_for_on_a_click(self):
        window, _ = self.start()
        window.click("tab.Models")
        window.scroll_to("models.server.find", "panel.Models")
        self.assertFalse(window.state()["server"]["looked"])
        window.press("models.server.find", lambda s: s["server"]["looked"], "nobody looked")
        window.picture("server_11_here")
        usable = [one["url"] for one in window.state()["server"]["here"] if one["usable"]]
        self.assertEqual(window.state()["server"]["url"], "")
        if usable:   # of somebody else on this machine
            index = [one["usable"] for one in window.state()["server"]["here"]].index(True)
            window.press(f"models.server.here.{index}", lambda s: s["server"]["url"] == usable[0],
                         "its address was not taken")

    def test_an_edit_at_the_server_is_stopped(self):
        window, server = self.start()
        server.ask("set?draw_s=30")
        window.click("tab.Models")
        window.scroll_to("models.server.url", "panel.Models")
        window.write("models.server.url", f"127.0.0.1:{server.port}")
        window.press("models.server.on", lambda s: s["server"]["on"], "it is not on")
        window.click("tab.Prompt")
        window.press("prompt.edit", lambda s: s["question"], "nobody asks before pictures go")
        window.press("question.0", lambda s: s["job"]["running"], "the edit did not start")
        window.wait(lambda s: s["job"]["stage"].startswith("view 1 "), "nothing is drawn", 300)
        window.cancel_job()
        window.idle(20)
        self.assertFalse(window.state()["result_waiting"])
        self.assertEqual(window.state()["job"]["outcome"], "stopped")


if __name__ == "__main__":
    unittest.main()
