"""edit --server and server: views drawn by a stand-in image server on this machine."""
import json
import math
import os
import pathlib
import re
import struct
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
WHITE = .5 / .28209479177387814   # coefficient of degree 0


class Server:
    """The stand-in in a process of its own."""

    def __init__(self, flavour, port=0):
        program = [sys.executable, SUPPORT / "stand_in_server.py", "--flavour", flavour, "--port", str(port)]
        self.process = subprocess.Popen(program, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        line = self.process.stdout.readline()
        if not line.startswith("port "):   # somebody else has the port
            self.close()
            raise OSError(f"port {port} is taken")
        self.port = int(line.split()[1])
        self.url = f"http://127.0.0.1:{self.port}"

    def ask(self, place, **values):
        query = "?" + urllib.parse.urlencode(values) if values else ""
        with urllib.request.urlopen(f"{self.url}/gse/{place}{query}", timeout=10) as answer:
            return json.load(answer)

    def drawings(self):
        places = ("/img_gen", "/img2img", "/edits", "/prompt")
        return [entry for entry in self.ask("log")
                if entry["method"] == "POST" and entry["path"].endswith(places)]

    @classmethod
    def at_usual_port(cls, flavour):
        """On the first usual port of image servers that is free; None where none is."""
        for port in (7860, 8188, 1234, 5001, 8000):
            try:
                return cls(flavour, port)
            except OSError:
                pass
        return None

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
        process = run("render", scene, path, "--width", 256, "--height", 256)
        self.assertEqual(process.returncode, 0, process.stderr)
        return pictures.decode_png(path.read_bytes()).colour()

    def covered(self, out):
        """Indices of the pixels that labelled splats cover wholly: they alone are drawn white."""
        data = (out / "source.ply").read_bytes()
        head, _, body = data.partition(b"end_header\n")
        lines = head.decode().splitlines()
        names = [line.split()[-1] for line in lines if line.startswith("property")]
        count = next(int(line.split()[-1]) for line in lines if line.startswith("element vertex"))
        self.assertEqual(len(body), 4 * len(names) * count)
        rows = [list(row) for row in struct.iter_unpack(f"<{len(names)}f", body)]
        for row in rows:
            white = 1 if row[names.index("label")] > .5 else -1
            for name in ("f_dc_0", "f_dc_1", "f_dc_2"):
                row[names.index(name)] = white * WHITE
        path = self.write("covered.ply", head + b"end_header\n" + b"".join(
            struct.pack(f"<{len(names)}f", *row) for row in rows))
        picture = self.rendered(path, "covered.png")
        return [i for i in range(0, len(picture.data), 3) if picture.data[i] >= .95 * 255]

    def psnr_inside(self, out):
        """dB of the edited scene to what the stand-in's rule makes of the scene, inside the label."""
        before, after = (self.rendered(path, name) for path, name in
                         ((SCENE, "before.png"), (out / "scene.ply", "after.png")))
        inside = self.covered(out)
        self.assertGreater(len(inside), 300)
        squares = 0
        for i in inside:
            truth = [max(before.data[i:i + 3]) * c / 255 for c in pictures.COLOURS["golden"]]
            squares += sum((a - b) ** 2 for a, b in zip(after.data[i:i + 3], truth))
        return 10 * math.log10(255 ** 2 * 3 * len(inside) / squares)

    def test_the_scene_becomes_what_the_server_draws_over_every_protocol(self):
        for kind, flavour, family, knobs in (("sdcpp", "sdserver", "sd15", {"model": "sd-v1-5"}),
                                             ("webui", "a1111", "sd15", {}),
                                             ("openai", "vllm", "editor", {"edits": "red"}),
                                             ("comfy", "comfy", "sd15", {})):
            with self.subTest(kind):
                server = self.server(flavour, **knobs)
                out = self.folder / kind
                process = self.edit(out, "--server", server.url, "--server-kind", kind)
                self.assertEqual(process.returncode, 0, process.stderr)
                report = json.loads((out / "report.json").read_text())
                self.assertEqual(report["changed_outside_label"], 0)
                self.assertEqual(report["server"]["kind"], kind)
                self.assertEqual(report["server"]["requests"], len(server.drawings()))
                self.assertEqual(report["server"]["family"], family)
                psnr = self.psnr_inside(out)
                print(f"{kind}: PSNR {psnr:.1f} dB inside the label")
                self.assertGreaterEqual(psnr, 25)

    def test_views_are_spread_over_several_servers(self):
        servers = [self.server(), self.server()]
        out = self.folder / "out"
        hidden = f"http://artist:geheim@127.0.0.1:{servers[1].port}"
        process = self.edit(out, "--server", servers[0].url, "--server-also", hidden,
                            "--server-agreement", "none")
        self.assertEqual(process.returncode, 0, process.stderr)
        report = json.loads((out / "report.json").read_text())
        self.assertEqual(report["changed_outside_label"], 0)
        drawn = [len(server.drawings()) for server in servers]
        self.assertGreater(min(drawn), 0)
        self.assertEqual(report["server"]["requests_by_server"], drawn)
        self.assertEqual(report["server"]["requests"], sum(drawn))
        recipe = (out / "recipe.json").read_text()
        self.assertNotIn("geheim", recipe + process.stdout + process.stderr)
        self.assertEqual(json.loads(recipe)["server"]["also"], [servers[1].url])
        alone = self.folder / "alone"
        process = run("-q", "edit", "--recipe", out / "recipe.json", "--out", alone,
                      "--server", servers[0].url)
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertIn("--server-also", process.stderr)
        self.assertEqual(len(servers[1].drawings()), drawn[1])
        self.assertEqual((alone / "scene.ply").read_bytes(), (out / "scene.ply").read_bytes())

    def test_further_servers_that_do_not_fit_are_refused_or_left_out(self):
        first = self.server(model="sd-v1-5")
        for further, words in ((self.server(model="flux-2-klein-4b"), "another model"),
                               (self.server("comfy"), "another kind"), (first, "named twice")):
            refused = self.edit(self.folder / "no", "--server", first.url, "--server-also", further.url)
            self.assertNotEqual(refused.returncode, 0)
            self.assert_one_sentence(refused, words, f"127.0.0.1:{further.port}")
            asked = run("server", first.url, "--server-also", further.url)
            self.assert_one_sentence(asked, words)
        self.assertEqual(first.drawings(), [])
        self.assert_one_sentence(self.edit(self.folder / "no", "--server-also", first.url), "name a server")
        broken = self.server(model="sd-v1-5", fault="failed", at="poll")
        out = self.folder / "out"
        process = self.edit(out, "--server", first.url, "--server-also", broken.url,
                            "--server-agreement", "none")
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertEqual(process.stderr.count("is left out"), 1, process.stderr)
        self.assertIn(f"127.0.0.1:{broken.port}", process.stderr)
        shares = json.loads((out / "report.json").read_text())["server"]["requests_by_server"]
        self.assertEqual(shares, [len(first.drawings()), 0])

    def test_options_and_loras_go_to_the_server_and_into_recipe_and_report(self):
        server = self.server("forge")
        out = self.folder / "out"
        process = self.edit(out, "--server", server.url, "--server-option", "scheduler=karras",
                            "--server-option", "eta=0.5", "--lora", "bronze:0.8")
        self.assertEqual(process.returncode, 0, process.stderr)
        for entry in server.drawings():
            self.assertEqual(entry["json"]["scheduler"], "karras")
            self.assertEqual(entry["json"]["eta"], .5)
            self.assertIn("<lora:bronze:0.8>", entry["json"]["prompt"])
        recipe = json.loads((out / "recipe.json").read_text())
        self.assertEqual(recipe["server"]["option"], ["scheduler=karras", "eta=0.5"])
        self.assertEqual(recipe["server"]["lora"], ["bronze:0.8"])
        self.assertEqual(recipe["job"]["lora"], [])
        report = json.loads((out / "report.json").read_text())
        self.assertEqual(report["server"]["options"], ["scheduler=karras", "eta=0.5"])
        self.assertEqual(report["server"]["lora"], ["bronze:0.8"])
        asked = len(server.drawings())
        for arguments, words in ((("--server-option", "width=8"), "set by the program"),
                                 (("--server-option", "shceduler=karras"), "it takes sampler_name"),
                                 (("--server-option", "token=abc"), "GSEDITPRO_SERVER_TOKEN"),
                                 (("--lora", "brass"), "it has: bronze")):
            refused = self.edit(self.folder / "no", "--server", server.url, *arguments)
            self.assertEqual(refused.returncode, 2)
            self.assert_one_sentence(refused, words)
        self.assertEqual(len(server.drawings()), asked)

    def test_a_model_that_follows_instructions_edits_in_comfyui(self):
        server = self.server("comfy")
        for name, more in (("found", []), ("named", ["--server-workflow", "edit"])):
            out = self.folder / name
            process = self.edit(out, "--server", server.url, "--server-model", "flux-2-klein-4b.safetensors",
                                *more)
            self.assertEqual(process.returncode, 0, process.stderr)
            report = json.loads((out / "report.json").read_text())
            self.assertEqual(report["server"]["family"], "flux2-klein")
            self.assertEqual(report["changed_outside_label"], 0)
        graph = server.drawings()[-1]["json"]["prompt"]
        self.assertIn("ReferenceLatent", [node["class_type"] for node in graph.values()])
        recipe = json.loads((self.folder / "named/recipe.json").read_text())
        self.assertEqual(recipe["server"]["workflow"], "edit")

    def test_a_server_with_little_memory_draws_smaller_pictures_and_it_is_told(self):
        server = self.server(model="sd-v1-5", most_side=64)
        out = self.folder / "out"
        process = self.edit(out, "--server", server.url)
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertIn("ran out of memory: pictures are asked for at 64 x 64 pixels", process.stderr)
        self.assertEqual(json.loads((out / "report.json").read_text())["server"]["smaller_side"], 64)
        self.assertEqual(sum(entry["json"]["width"] == 128 for entry in server.drawings()), 1)

    def share_outside(self, said, view):
        """Percentage of an own picture's change that the command says is left out; 0 = it says nothing."""
        found = re.search(rf"(\d+) % of what your picture of {view} changes lies outside", said)
        return int(found.group(1)) if found else 0

    def test_a_view_becomes_the_artists_own_picture_and_the_others_follow_it(self):
        server = self.server(model="sd-v1-5-inpainting")
        listed = self.folder / "listed"
        process = self.edit(listed, "--server", server.url, "--views-only")
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertEqual(server.drawings(), [])
        views = json.loads((listed / "views.json").read_text())["views"]
        self.assertGreater(len(views), 2)
        self.assertFalse((listed / "scene.ply").exists())
        for view in views:
            picture = pictures.decode_png((listed / view["file"]).read_bytes())
            self.assertEqual((picture.width, picture.height), (128, 128))
            self.assertIn(view["view"], process.stdout)
        most = max(views, key=lambda view: view["share"])
        seen = pictures.decode_png((listed / most["file"]).read_bytes()).colour()
        painted = bytes(value for i in range(0, len(seen.data), 3)
                        for value in (seen.data[i + 2], 0, max(seen.data[i:i + 3])))
        own = self.write("own.png", pictures.encode_png(pictures.Picture(128, 128, 3, painted)))
        out = self.folder / "out"
        process = self.edit(out, "--server", server.url, "--target-picture", f"{most['view']}={own}")
        self.assertEqual(process.returncode, 0, process.stderr)
        report = json.loads((out / "report.json").read_text())
        self.assertEqual(report["server"]["target_pictures"], [most["view"]])
        self.assertEqual(report["server"]["agreement"], "warp")
        self.assertEqual(report["changed_outside_label"], 0)
        told = self.share_outside(process.stderr, most["view"])
        self.assertGreater(told, 20)
        mask = pictures.decode_png((listed / most["mask"]).read_bytes()).luma()
        kept = bytes(painted[i] if mask[i // 3] > 127 else seen.data[i] for i in range(len(painted)))
        inside = self.write("inside.png", pictures.encode_png(pictures.Picture(128, 128, 3, kept)))
        process = self.edit(out, "--server", server.url, "--target-picture", f"{most['view']}={inside}")
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertEqual(self.share_outside(process.stderr, most["view"]), 0)
        process = self.edit(out, "--server", server.url, "--target-picture", f"{most['view']}={own}",
                            "--dilate-px", 120)
        self.assertLess(self.share_outside(process.stderr, most["view"]), told)
        small = self.write("small.png", pictures.encode_png(pictures.Picture(32, 32, 3, bytes(32 * 32 * 3))))
        wide = self.write("wide.png", pictures.encode_png(pictures.Picture(128, 64, 3, bytes(128 * 64 * 3))))
        for picture, words in ((f"nowhere={own}", "none of the views that are drawn"),
                               (f"{most['view']}={wide}", "128 x 64 pixels"),
                               (f"{most['view']}={small}", "32 x 32 pixels"),
                               (f"{most['view']}={self.folder / 'missing.png'}", "missing.png"),
                               ("nothing", "VIEW=FILE")):
            refused = self.edit(self.folder / "no", "--server", server.url, "--target-picture", picture)
            self.assertNotEqual(refused.returncode, 0, refused.stderr)
            self.assertIn(words, refused.stderr)
        for option in (["--target-picture", f"{most['view']}={own}"], ["--key-view", most["view"]],
                       ["--server-option", "scheduler=karras"], ["--server-lora", "bronze"]):
            self.assert_one_sentence(self.edit(self.folder / "no", *option), "image server")

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

    def test_each_change_of_a_sentence_finds_what_the_model_lacks_a_word_for(self):
        server = self.server(model="flux1-kontext-dev", edits="red")
        out = self.folder / "out"
        process = run("-q", "edit", SCENE, "--source", "gizmo", "--prompt",
                      "paint the gizmo golden and make it twice as large", "--out", out, *QUICK,
                      "--server", server.url)
        self.assertEqual(process.returncode, 0, process.stderr)
        steps = json.loads((out / "report.json").read_text())["steps"]
        self.assertEqual([step["done"] for step in steps], [True, True], steps)
        searched = [entry for entry in server.drawings() if "mask_image" not in entry["json"]]
        self.assertIn(len(searched), (16, 32))   # the second change knows what the first has found

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

    def test_a_scene_is_fitted_to_the_views_that_came_before_a_server_failed_where_that_is_wanted(self):
        server = self.server(fault="html_500", at="draw", after=5)
        self.set("GSE_CACHE_DIR", self.folder / "cache")
        views = ("--edited-views", 16)   # half of them in draft quality
        out = self.folder / "out"
        first = self.edit(out, "--server", server.url, *views)
        self.assertNotEqual(first.returncode, 0)
        self.assert_one_sentence(first, "5 of 8 views are drawn", "--server-fit-partial")
        self.assertFalse((out / "scene.ply").exists())
        second = self.edit(out, "--server", server.url, *views, "--server-fit-partial")
        self.assertEqual(second.returncode, 0, second.stderr)
        self.assertIn("5 of 8 views are drawn; missing: ", second.stderr)
        report = json.loads((out / "report.json").read_text())
        self.assertEqual(len(report["missing_views"]), 3)
        rows = report["targets"][0]["views"]
        self.assertEqual([row["view"] for row in rows if row.get("missing")], report["missing_views"])
        self.assertEqual(sum(row["dropped"] for row in rows), 3)
        self.assertEqual(report["changed_outside_label"], 0)
        self.assertEqual(report["server"]["cached_requests"], 5)
        self.assertTrue(json.loads((out / "recipe.json").read_text())["server"]["fit_partial"])
        server.ask("set", fault="none")
        whole = self.edit(self.folder / "whole", "--server", server.url, *views)
        self.assertEqual(whole.returncode, 0, whole.stderr)
        report = json.loads((self.folder / "whole/report.json").read_text())
        self.assertNotIn("missing_views", report)
        self.assertEqual(report["server"]["requests"], 3)

    def test_too_few_views_are_fitted_to_by_nobody(self):
        server = self.server(fault="html_500", at="draw", after=4)
        process = self.edit(self.folder / "out", "--server", server.url, "--edited-views", 16,
                            "--server-fit-partial")
        self.assertNotEqual(process.returncode, 0)
        self.assertNotIn("views are drawn", process.stderr)

    def test_servers_on_this_machine_are_found_by_looking_alone(self):
        server = Server.at_usual_port("comfy")
        if server is None:
            self.skipTest("no usual port of image servers is free")
        self.addCleanup(server.close)
        self.set("GSEDITPRO_SERVER_TOKEN", "geheim")
        found = run("-q", "server", "--find", "--json")
        self.assertEqual(found.returncode, 0, found.stderr)
        ours = [one for one in json.loads(found.stdout) if one["url"] == server.url]
        self.assertEqual(len(ours), 1, found.stdout)
        self.assertEqual(ours[0]["product"], "ComfyUI")
        self.assertEqual(ours[0]["problem"], "")
        for entry in server.ask("log"):
            self.assertEqual(entry["method"], "GET")
            self.assertEqual(entry["secret"], "")
        said = run("-q", "server", "--find")
        self.assertIn(f"{server.url}  ComfyUI", said.stdout)
        server.ask("reset", password="basic mira:geheim")
        locked = json.loads(run("-q", "server", "--find", "--json").stdout)
        self.assertIn("password", next(one["problem"] for one in locked if one["url"] == server.url))
        self.assert_one_sentence(run("server", "--find", server.url), "takes no address")
        self.assert_one_sentence(run("server"), "no server is named", "--find")

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
        self.assertEqual(facts["loras"], ["bronze"])
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
