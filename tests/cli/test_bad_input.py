"""Bad input gets one clear sentence, an exit code that is not 0, and leaves nothing behind."""
import json
import os
import pathlib
import re
import resource
import subprocess
import unittest

from program import PROGRAM, SHARED, ProgramTest, grid_rows, ply_bytes, run, run_laboratory

ASSETS = pathlib.Path(__file__).resolve().parents[2] / "assets"


class BadScenes(ProgramTest):
    def refuse(self, path, *words):
        """Neither info nor convert accept the file, and convert writes nothing."""
        self.assert_one_sentence(run("info", path), *words)
        before = self.folder_listing()
        self.assert_one_sentence(run("convert", path, self.folder / "out/new.ply"))
        self.assertEqual(self.folder_listing(), before)

    def test_missing_file(self):
        self.refuse(self.folder / "none.ply", "none.ply")

    def test_empty_file(self):
        for name in ["a.ply", "a.splat", "a.spz", "a.sog"]:
            self.refuse(self.write(name, b""), name)

    def test_truncated(self):
        whole = ply_bytes(grid_rows())
        self.refuse(self.write("cut.ply", whole[: len(whole) // 2]), "cut.ply")
        self.refuse(self.write("cut_header.ply", whole[:60]), "cut_header.ply")
        self.refuse(self.write("cut.splat", b"\0" * 33), "cut.splat")

    def test_wrong_magic(self):
        self.refuse(self.write("text.ply", b"this is not a scene\n" * 10), "text.ply")
        self.refuse(self.write("noise.spz", bytes(range(256)) * 4), "noise.spz")
        self.refuse(self.write("noise.sog", bytes(range(256)) * 4), "noise.sog")

    def test_wrong_and_huge_counts(self):
        self.refuse(self.write("more.ply", ply_bytes(grid_rows(), count=100000)), "more.ply")
        self.refuse(self.write("huge.ply", ply_bytes(grid_rows(), count=10**18)), "huge.ply")
        self.refuse(self.write("negative.ply", ply_bytes(grid_rows(), count=-5)), "negative.ply")

    def test_no_gaussians(self):
        self.refuse(self.write("points.ply", ply_bytes([(0, 0, 0)], names=["x", "y", "z"])), "points.ply")

    def test_nan_filled_opens_and_is_counted(self):
        nan = float("nan")
        path = self.write("nan.ply", ply_bytes([(nan,) * 17] * 50))
        self.assertEqual(self.info(path)["lint"]["nan"], 50)
        process = run("edit", path, "--prompt", "a red bear", "--source", "bear", "--target", "red", "--out",
                      self.folder / "out")
        self.assert_one_sentence(process)
        self.assertFalse((self.folder / "out").exists())


class BadCameras(ProgramTest):
    def test_cameras_beside_a_scene_do_not_hide_it(self):
        path = self.write("scene.ply", ply_bytes(grid_rows()))
        plain = run("info", path)
        for text in ["[", "[1]", '[{"img_name": 3, "width": "wide"}]']:
            self.write("cameras.json", text.encode())
            process = run("info", path)
            self.assertEqual(process.returncode, 0, process.stderr)
            *facts, warning = process.stdout.splitlines()
            self.assertEqual(facts, plain.stdout.splitlines())
            for word in ["cameras beside the scene", "cannot be used", "cameras.json"]:
                self.assertIn(word, warning)
            self.assertNotIn("json.exception", warning)
            self.assert_one_sentence(run("cameras", path, self.folder / "transforms.json"), "cameras.json")
            self.assertFalse((self.folder / "transforms.json").exists())


HOSTILE = SHARED / "data/hostile"


@unittest.skipUnless(HOSTILE.exists(), f"[skip] {HOSTILE} is not there")
class HostileFiles(ProgramTest):
    def test_bombs_and_deep_trees(self):
        self.assert_one_sentence(run("info", HOSTILE / "sog_bomb268M.sog"), "268402689 splats",
                                 "cannot hold so much")
        self.assert_one_sentence(run("info", HOSTILE / "spz4_bomb400M.spz"), "400000000 splats",
                                 "cannot hold so much")
        self.assert_one_sentence(run("info", HOSTILE / "lod_deep"), "levels deep", "lod_deep")

    def test_control_characters_are_escaped(self):
        process = run("project", HOSTILE / "p_nul.gsep")
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertIn(r"a\x00b\x1b[31mRED", process.stdout)
        self.assertNotIn("\x1b", process.stdout)

    def test_names_longer_than_the_system_takes(self):
        long_name = "A" * 5000 + ".ply"
        scene = ASSETS / "scenes/bear/scene.ply"
        for arguments in ([long_name], [scene, "--cameras", long_name], [scene, "--model", long_name],
                          [scene, "--taesd", long_name]):
            process = run("edit", *arguments, "--source", "bear", "--prompt", "a blue bear", "--out",
                          self.folder / "out")
            self.assertIn(process.returncode, (1, 2), process.stderr[:300])
            self.assertNotIn("please report", process.stderr)
            self.assertIn("AAAA", process.stderr)   # which one

    def test_recipes_of_the_wrong_type(self):
        for name in ["recipe_ver_null.json", "recipe_ver_str.json"]:
            self.assert_one_sentence(run("edit", "--recipe", HOSTILE / name, "--out", self.folder / "out"),
                                     name, "recipe", "version", "null" if "null" in name else "number")
        self.assertEqual(self.folder_listing(), [])


class ManyScenes(ProgramTest):
    def test_one_broken_scene_does_not_hide_the_others(self):
        good = self.write("good.ply", ply_bytes(grid_rows()))
        bad = self.write("bad.ply", b"not a scene")
        process = run("info", good, bad, good)
        self.assert_one_sentence(process, "1 of 3 scenes")
        self.assertIn("bad.ply", process.stderr)
        self.assertEqual(process.stdout.count("good.ply"), 2)
        self.assertEqual(len(json.loads(run("info", good, good, "--json").stdout)), 2)

    def test_a_scene_larger_than_the_memory(self):
        """The sentence says what is needed and what is free."""
        if os.environ.get("GSE_SANITIZED") == "1":
            self.skipTest("[skip] shadow memory does not fit any limit")
        path = self.folder / "large.splat"
        with open(path, "wb") as file:
            file.truncate(32 * 100_000_000)   # takes no room on the disk
        limit = 3 << 30
        process = subprocess.run([PROGRAM, "info", str(path)], capture_output=True, text=True, timeout=600,
                                 preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)))
        self.assertRegex(self.assert_one_sentence(process, "are free"),
                         r"needs \d+(\.\d+)? GB of memory, and \d+(\.\d+)? [MG]B")


class BadOptions(ProgramTest):
    def setUp(self):
        super().setUp()
        self.scene = self.write("scene.ply", ply_bytes(grid_rows()))

    def edit(self, *arguments):
        return run("edit", self.scene, "--out", self.folder / "out", *arguments)

    def refuse_edit(self, arguments, *words):
        self.assert_one_sentence(self.edit(*arguments), *words)
        self.assertFalse((self.folder / "out").exists())

    def test_prompt_without_target_word(self):
        self.refuse_edit(["--source", "bear", "--prompt", "a red bear", "--target", "golden"], "golden")

    def test_missing_model(self):
        self.refuse_edit(["--source", "bear", "--prompt", "a red bear", "--target", "red", "--model",
                          self.folder / "no_model"], "no_model")

    def test_a_view_to_be_left_out_that_is_not_there_is_told_before_any_work(self):
        self.refuse_edit(["--source", "bear", "--prompt", "a red bear", "--target", "red", "--excluded-views",
                          "3, 99"], "view 99", "excluded_views")

    def test_options_of_before_are_read_and_not_shown(self):
        text = run("edit", "--help").stdout
        for before, now, value in (("--tau", "--label-threshold", "2"),
                                   ("--keep-mass", "--min-cluster-mass", "2"),
                                   ("--fallback-mass", "--min-segment-attention", "2"),
                                   ("--second-look", "--retry-passes", "-1"),
                                   ("--evidence-px", "--coverage-px", "-1")):
            self.assertNotIn(before + " ", text)
            self.assertIn(now + " ", text)
            for option in (before, now):
                process = self.edit("--source", "bear", "--prompt", "a red bear", option, value)
                self.assertEqual(process.returncode, 2)
                self.assertIn(f"{option}: Value {value} not in range", process.stderr)
                self.assertFalse((self.folder / "out").exists())
        self.refuse_edit(["--source", "bear", "--prompt", "a red bear", "--target", "red", "--left-out",
                          "3, 99"], "view 99", "excluded_views")
        for before in ("--focus", "--rivals", "--left-out", "--look-again"):
            self.assertNotIn(before, text)

    def test_unwritable_output(self):
        blocker = self.write("file", b"x")
        process = run("convert", self.scene, blocker / "new.ply")
        self.assert_one_sentence(process, "file")
        process = run("edit", self.scene, "--source", "bear", "--prompt", "a red bear", "--target", "red",
                      "--out",
                      blocker / "out")
        self.assert_one_sentence(process, "file")

    def test_unknown_option_values(self):
        for arguments in [["render", self.scene, self.folder / "p.png", "--background", "pinkish"],
                          ["render", self.scene, self.folder / "p.png", "--up", "w"],
                          ["render", self.scene, self.folder / "p.png", "--view", 5],
                          ["convert", self.scene, self.folder / "p.xyz"]]:
            self.assert_one_sentence(run(*arguments))
        self.assert_one_sentence(run_laboratory("synth", self.folder / "p.ply", "--object", "dragonfly"))
        self.assertEqual(self.folder_listing(), ["scene.ply"])

    def test_every_number_is_finite_and_in_its_range(self):
        """NaN lies in no range, whichever option it is given to."""
        for start, command, first in [(run, "edit", [self.scene]), (run, "locate", [self.scene]),
                                      (run, "render", [self.scene, "p.png"]),
                                      (run, "turntable", [self.scene, "p.mp4"]), (run_laboratory, "eval", []),
                                      (run_laboratory, "train-starter", [])]:
            text = start(command, "--help").stdout
            names = re.findall(r"^ +(--[a-z0-9-]+) FLOAT", text, re.MULTILINE)
            if command in ("edit", "render", "turntable"):
                self.assertTrue(names, command)
            for name in names[::5]:   # the check is the same for all
                for value in ["nan", "inf", "-inf", "1e999"] if name == names[0] else ["nan"]:
                    process = start(command, *first, f"{name}={value}")
                    self.assertEqual(process.returncode, 2, f"{command} {name}={value}: {process.stderr}")
                    self.assertIn(name, process.stderr)
                if command != "edit":
                    break
        self.assertEqual(self.folder_listing(), ["scene.ply"])

    def test_recipe_fields_are_named(self):
        seed = {"version": 1, "request": {"prompt": "a red bear", "source": "bear", "target": "red"}}
        for part, name, value, word in [("request", "rate_sh", None, "null"),
                                        ("request", "rate_colour", 1e300, "0 to 10"),
                                        ("request", "iterations", 2.5, "2.5"),
                                        ("request", "iterations", "many", "many"),
                                        ("request", "seed", -1, "-1"), ("request", "prompt", 5, "text"),
                                        ("request", "reframe_views", 1, "true or false"),
                                        ("job", "threads", 4294967297, "threads"),
                                        ("guidance", "weight", True, "true"),
                                        ("dreambooth", "steps", [], "list")]:
            recipe = json.loads(json.dumps(seed))
            recipe.setdefault(part, {})[name] = value
            path = self.write("recipe.json", json.dumps(recipe).encode())
            self.refuse_edit(["--recipe", path], name, word, "recipe.json")
        for recipe in [{**seed, "request": []}, {**seed, "job": None}, {**seed, "guidance": "x"},
                       {**seed, "version": [1]},
                       {**seed, "version": "1"}, {**seed, "request": {"no_such": 1}}, []]:
            path = self.write("recipe.json", json.dumps(recipe).encode())
            self.refuse_edit(["--recipe", path], "recipe")
        path = self.write("recipe.json", b'{"version": 1, "request": {"rate_colour": NaN}}')
        self.refuse_edit(["--recipe", path], "recipe")

    def test_usage_errors_exit_2(self):
        for arguments in [["frobnicate"], ["render"], ["render", self.scene, "p.png", "--width", "-4"]]:
            self.assertEqual(run(*arguments).returncode, 2)


@unittest.skipUnless((ASSETS / "models/starter/model_index.json").exists(),
                     "[skip] the starter model is not there")
class BadModels(ProgramTest):
    def copy_model(self):
        target = self.folder / "model"
        source = ASSETS / "models/starter"
        for path in source.rglob("*"):
            if path.is_file():
                copy = target / path.relative_to(source)
                copy.parent.mkdir(parents=True, exist_ok=True)
                os.symlink(path, copy)
        return target

    def refuse_model(self, model, *words):
        scene = self.write("scene.ply", ply_bytes(grid_rows()))
        process = run("edit", scene, "--source", "bear", "--prompt", "a red bear", "--target", "red",
                      "--model", model,
                      "--out", self.folder / "out")
        self.assert_one_sentence(process, *words)
        self.assertFalse((self.folder / "out").exists())

    def change_header(self, model, change):
        import json
        import struct
        path = model / "text_encoder/model.safetensors"
        data = path.read_bytes()
        path.unlink()
        length = struct.unpack("<Q", data[:8])[0]
        header = json.loads(data[8:8 + length])
        body = change(header, data[8 + length:])
        text = json.dumps(header).encode()
        path.write_bytes(struct.pack("<Q", len(text)) + text + body)

    def test_missing_tensor(self):
        model = self.copy_model()

        def drop_last(header, body):
            name = max((key for key in header if key != "__metadata__"),
                       key=lambda key: header[key]["data_offsets"][1])
            begin = header.pop(name)["data_offsets"][0]
            self.dropped = name
            return body[:begin]

        self.change_header(model, drop_last)
        self.refuse_model(model, self.dropped)

    def test_misshaped_tensor(self):
        model = self.copy_model()

        def reshape(header, body):
            name = next(key for key in header if key != "__metadata__" and len(header[key]["shape"]) == 2)
            header[name]["shape"] = header[name]["shape"][::-1]
            if header[name]["shape"][0] == header[name]["shape"][1]:
                header[name]["shape"] = [1, header[name]["shape"][0] * header[name]["shape"][1]]
            self.reshaped = name
            return body

        self.change_header(model, reshape)
        self.refuse_model(model, self.reshaped)

    def test_missing_folder_and_pickle(self):
        model = self.copy_model()
        (model / "unet/diffusion_pytorch_model.safetensors").unlink()
        self.refuse_model(model, "unet")
        self.refuse_model(self.write("model.ckpt", b"\x80\x02}q\x00."), "safetensors")


if __name__ == "__main__":
    unittest.main()
