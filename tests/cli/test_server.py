"""edit --server and server: views drawn by a stand-in image server on this machine."""
import json
import math
import os
import pathlib
import subprocess
import sys
import unittest
import urllib.parse
import urllib.request

from program import ProgramTest, run

ROOT = pathlib.Path(__file__).resolve().parents[2]
SUPPORT = ROOT / "tests/support"
SCENE = ROOT / "assets/scenes/bear/scene.ply"
MODEL = ROOT / "assets/models/starter"
sys.path.insert(0, str(SUPPORT))
import stand_in_pictures as pictures   # noqa: E402

QUICK = ["--quality", "draft", "--turntable-frames", 0, "--server-side", 128, "--front", 0,
         "--views", 12]


class Server:
    """The stand-in in a process of its own."""

    def __init__(self, flavour):
        program = [sys.executable, SUPPORT / "stand_in_server.py", "--flavour", flavour]
        self.process = subprocess.Popen(program, stdout=subprocess.PIPE, text=True)
        self.port = int("".join(letter for letter in self.process.stdout.readline() if letter.isdigit()))
        self.url = f"http://127.0.0.1:{self.port}"

    def ask(self, place, **values):
        query = "?" + urllib.parse.urlencode(values) if values else ""
        with urllib.request.urlopen(f"{self.url}/gse/{place}{query}", timeout=10) as answer:
            return json.load(answer)

    def drawings(self):
        places = ("/img_gen", "/img2img", "/edits", "/prompt")
        return [entry for entry in self.ask("log")
                if entry["method"] == "POST" and entry["path"].endswith(places)]

    def close(self):
        self.process.kill()
        self.process.wait()
        self.process.stdout.close()


@unittest.skipUnless((MODEL / "model_index.json").exists(), "[skip] the starter model is not there")
@unittest.skipUnless((SUPPORT / "stand_in_server.py").exists(), "[skip] the stand-in server is not there")
class Servers(ProgramTest):
    def setUp(self):
        super().setUp()
        self.set("XDG_CONFIG_HOME", self.folder / "config")

    def set(self, name, value):
        """An environment variable for the time of the test."""
        before = os.environ.get(name)
        self.addCleanup(lambda: os.environ.pop(name) if before is None else os.environ.update({name: before}))
        os.environ[name] = str(value)

    def server(self, flavour="sdserver", **knobs):
        server = Server(flavour)
        self.addCleanup(server.close)
        if knobs:
            server.ask("set", **knobs)
        return server

    def edit(self, out, *arguments, prompt="a golden bear", target="golden"):
        return run("-q", "edit", SCENE, "--source", "bear", "--prompt", prompt, "--target", target,
                   "--out", out, *QUICK, *arguments)

    def rendered(self, scene, name):
        path = self.folder / name
        process = run("render", scene, path, "--width", 128, "--height", 128)
        self.assertEqual(process.returncode, 0, process.stderr)
        return pictures.decode_png(path.read_bytes()).colour()

    def test_the_scene_becomes_what_the_server_draws(self):
        server = self.server(model="sd-v1-5")
        out = self.folder / "out"
        process = self.edit(out, "--server", server.url)
        self.assertEqual(process.returncode, 0, process.stderr)
        report = json.loads((out / "report.json").read_text())
        self.assertEqual(report["changed_outside_label"], 0)
        self.assertEqual(report["server"]["requests"], len(server.drawings()))
        self.assertEqual(report["server"]["family"], "sd15")
        before, after = (self.rendered(path, name) for path, name in
                         ((SCENE, "before.png"), (out / "scene.ply", "after.png")))
        squares = count = 0
        for i in range(0, len(before.data), 3):
            old, new = before.data[i:i + 3], after.data[i:i + 3]
            if max(abs(a - b) for a, b in zip(old, new)) < 8:
                continue
            truth = [max(old) * c / 255 for c in pictures.COLOURS["golden"]]
            squares += sum((a - b) ** 2 for a, b in zip(new, truth))
            count += 3
        self.assertGreater(count, 300)
        print(f"{count // 3} pixels, PSNR {10 * math.log10(255 ** 2 * count / squares):.1f} dB")
        # 23 dB: pixels that the label covers in part are among them.
        self.assertLess(squares / count, 255 ** 2 / 10 ** 2.3)

    def test_nothing_that_is_written_names_address_or_password(self):
        server = self.server()
        out = self.folder / "out"
        url = f"http://artist:geheim@127.0.0.1:{server.port}"
        process = self.edit(out, "--server", url)
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertNotIn("geheim", process.stdout + process.stderr)
        for path in out.rglob("*"):
            if path.is_file():
                self.assertNotIn(b"geheim", path.read_bytes(), path)
        self.assertNotIn("127.0.0.1", (out / "report.json").read_text())
        self.assertEqual(json.loads((out / "recipe.json").read_text())["server"]["url"],
                         f"http://127.0.0.1:{server.port}")

    def test_a_recipe_from_elsewhere_asks_no_server(self):
        server = self.server()
        recipe = {"version": 1, "job": {"scene": str(SCENE), "front": "0"},
                  "request": {"source": "bear", "prompt": "a golden bear", "target": "golden",
                              "quality": "draft"},
                  "server": {"url": server.url, "side": 128}}
        path = self.write("recipe.json", json.dumps(recipe).encode())
        refused = run("edit", "--recipe", path, "--out", self.folder / "refused")
        self.assertEqual(refused.returncode, 2)
        self.assertIn(server.url, refused.stderr)
        self.assertIn("--server", refused.stderr)
        self.assertEqual(server.ask("log"), [])
        taken = run("-q", "edit", "--recipe", path, "--out", self.folder / "taken", "--server", server.url,
                    "--turntable-frames", 0)
        self.assertEqual(taken.returncode, 0, taken.stderr)
        self.assertGreater(len(server.drawings()), 0)

    def test_a_word_that_the_model_lacks_is_found_by_what_the_server_changes(self):
        server = self.server(model="flux1-kontext-dev", edits="red", noise=6)
        words = ["--source", "gizmo", "--prompt", "a golden gizmo", "--target", "golden"]
        out = self.folder / "out"
        process = run("-q", "edit", SCENE, *words, "--out", out, *QUICK, "--server", server.url)
        self.assertEqual(process.returncode, 0, process.stderr)
        report = json.loads((out / "report.json").read_text())
        self.assertIn("differences", report["found_by"])
        self.assertEqual(report["changed_outside_label"], 0)
        bear = self.edit(self.folder / "bear", "--server", server.url)
        self.assertEqual(bear.returncode, 0, bear.stderr)
        truth = json.loads((self.folder / "bear/report.json").read_text())
        self.assertNotIn("found_by", truth)
        self.assertLess(abs(report["labelled"] / truth["labelled"] - 1), 0.1)
        asked = len(server.drawings())
        refused = run("edit", SCENE, *words, "--out", self.folder / "no", "--server", server.url,
                      "--server-search", "none")
        self.assertEqual(refused.returncode, 2)
        self.assert_one_sentence(refused, "gizmo", "cannot find it")
        added = run("edit", SCENE, "--source", "gizmo", "--prompt", "a gizmo with a hat", "--target", "hat",
                    "--out", self.folder / "no", "--server", server.url)
        self.assert_one_sentence(added, "gizmo", "cannot find it")
        self.assertEqual(len(server.drawings()), asked)

    def test_an_edit_that_was_refused_goes_on_where_it_ended(self):
        server = self.server(fault="failed", at="poll", after=6)
        self.set("GSE_CACHE_DIR", self.folder / "cache")
        first = self.edit(self.folder / "first", "--server", server.url)
        self.assertNotEqual(first.returncode, 0)
        done = len(server.drawings())
        self.assertGreater(done, 1)
        server.ask("set", fault="none")
        second = self.edit(self.folder / "second", "--server", server.url)
        self.assertEqual(second.returncode, 0, second.stderr)
        report = json.loads((self.folder / "second/report.json").read_text())
        self.assertGreater(report["server"]["cached_requests"], 0)

    def test_a_server_that_draws_something_else_is_found_out(self):
        server = self.server("a1111", fault="unrelated")
        process = self.edit(self.folder / "other", "--server", server.url)
        self.assertNotEqual(process.returncode, 0)
        self.assertIn("has not looked at our picture", process.stderr)

    def test_server_tells_what_it_is(self):
        server = self.server(model="flux-2-klein-4b")
        drawn = self.folder / "ball.png"
        process = run("-q", "server", server.url, "--json", "--draw", drawn, "--server-side", 128)
        self.assertEqual(process.returncode, 0, process.stderr)
        facts = json.loads(process.stdout)
        self.assertEqual(facts["kind"], "sdcpp")
        self.assertEqual(facts["family"], "flux2-klein")
        self.assertTrue(facts["takes_mask"])
        self.assertEqual(facts["drawn"], "the picture is as asked")
        self.assertEqual(pictures.decode_png(drawn.read_bytes()).width, 128)
        nobody = run("-q", "server", "http://127.0.0.1:9")
        self.assertNotEqual(nobody.returncode, 0)
        self.assertIn("127.0.0.1", nobody.stderr)

    def test_a_word_that_the_bundled_model_lacks_can_be_drawn(self):
        server = self.server(model="flux1-kontext-dev")
        out = self.folder / "out"
        process = self.edit(out, "--server", server.url, prompt="a golden iridescent bear",
                            target="iridescent")
        self.assertEqual(process.returncode, 0, process.stderr)
        prompts = [entry["json"]["prompt"] for entry in server.drawings()]
        self.assertTrue(all("iridescent" in prompt for prompt in prompts), prompts)


if __name__ == "__main__":
    unittest.main()
