"""locate and edit with the bundled model: the promised files, the promised numbers, the same bytes from the
recipe."""
import json
import os
import pathlib
import shutil
import signal
import subprocess
import time
import unittest

from program import (PROGRAM, SHARED, ProgramTest, can_mount, grid_rows, ply_bytes, run,
                     run_in_namespace)

ASSETS = pathlib.Path(__file__).resolve().parents[2] / "assets"
MODEL = ASSETS / "models/starter"
QUICK = ["--views", 6, "--image-size", 64, "--attention-repeats", 1, "--iterations", 20, "--turntable-frames",
         3,
         "--turntable-size", 64]


def splat_rows(path):
    """(names, rows as bytes) of a binary PLY whose properties are all floats."""
    data = path.read_bytes()
    header, body = data.split(b"end_header\n", 1)
    names = [line.split()[2].decode() for line in header.splitlines() if line.startswith(b"property float ")]
    count = next(int(line.split()[2]) for line in header.splitlines() if line.startswith(b"element vertex "))
    stride = 4 * len(names)
    assert len(body) == count * stride
    return names, [body[i * stride:(i + 1) * stride] for i in range(count)]


@unittest.skipUnless((MODEL / "model_index.json").exists(), "[skip] the starter model is not there")
class Edits(ProgramTest):
    def edit(self, out, *arguments, scene=ASSETS / "scenes/bear/scene.ply", quick=QUICK):
        process = run("-q", "edit", scene, "--source", "bear", "--prompt",
                      "a blue bear on the grass", "--target", "blue", "--front", 0, "--out", out, *quick,
                      *([] if "--gate" in arguments else ["--no-gate"]), *arguments)
        self.assertEqual(process.returncode, 0, process.stderr)
        return process

    def test_the_promised_files(self):
        out = self.folder / "out"
        self.edit(out)
        for name in ["scene.ply", "source.ply", "report.json", "recipe.json", "before_after.mp4",
                     "before_after.png", "edit.gsep",
                     "evidence/index.json", "evidence/view_000_attention.png",
                     "evidence/view_000_points.png"]:
            self.assertTrue((out / name).is_file(), name)
        self.assertEqual([path.name for path in self.folder.iterdir()], ["out"])
        report = json.loads((out / "report.json").read_text())
        for key in ["splats", "labelled", "changed_outside_label", "nonfinite", "psnr_outside_db", "seconds",
                    "peak_rss_mb"]:
            self.assertIn(key, report)
        self.assertEqual(report["changed_outside_label"], 0)
        self.assertEqual(report["nonfinite"], 0)
        self.assertGreater(report["labelled"], 0)
        self.assertIn({"field": "request.views", "value": 6, "source": "user"}, report["settings_from"])
        self.assertNotIn("request.label_threshold", [entry["field"] for entry in report["settings_from"]])
        self.assertEqual(self.info(out / "scene.ply")["splats"], report["splats"])
        self.check_unlabelled_rows(out)

    def test_the_project_shows_the_edited_scene_and_its_label_is_edited_further(self):
        out = self.folder / "out"
        self.edit(out)
        self.assertEqual(run("project", out / "edit.gsep", "--export",
                             self.folder / "exported.ply").returncode, 0)
        self.assertEqual((self.folder / "exported.ply").read_bytes(), (out / "scene.ply").read_bytes())
        summary = json.loads(run("project", out / "edit.gsep", "--json").stdout)
        self.assertEqual([edit["name"] for edit in summary["edits"]], ["a blue bear on the grass"])
        self.assertEqual([label["name"] for label in summary["labels"]], ["bear"])
        again = self.folder / "again"
        # The bear is blue already: an edit that changes nothing counts as failed.
        self.edit(again, "--use-label", "--keep-failed", scene=out / "edit.gsep")
        first, second = (json.loads((folder / "report.json").read_text()) for folder in (out, again))
        self.assertEqual(second["labelled"], first["labelled"] + first["added"] - first["removed"])

    def test_the_name_of_a_label_is_a_word_and_a_project_goes_on_with_its_edits(self):
        """A second scene put into the sample, turned and removed by its name."""
        guest = self.write("gizmo.ply", ply_bytes(grid_rows(8)))
        both, turned, gone = (self.folder / name for name in ["both.ply", "turned", "gone"])
        merged = run("merge", ASSETS / "scenes/bear/scene.ply", guest, "--up-b", "-y", "--out", both)
        self.assertEqual(merged.returncode, 0, merged.stderr)
        plan = run("plan", both, "--source", "gizmo", "--prompt", "rotate the gizmo")
        self.assertNotIn("cannot be done", plan.stdout)
        for scene, prompt, folder in [(both, "rotate the gizmo 90 degrees", turned),
                                      (turned / "edit.gsep", "remove the gizmo", gone)]:
            edit = run("edit", scene, "--source", "gizmo", "--prompt", prompt, "--out", folder,
                       "--views", 8, "--image-size", 64, "--turntable-frames", 0)
            self.assertEqual(edit.returncode, 0, edit.stderr)
            self.assertNotIn("does not know", edit.stderr)
            self.assertFalse((folder / "before_after.mp4").exists())
        fewer = self.info(both)["splats"] - self.info(gone / "scene.ply")["splats"]
        self.assertGreater(fewer, 400)   # of 512: some fill the hole
        project = json.loads(run("project", gone / "edit.gsep", "--json").stdout)
        self.assertEqual(len(project["edits"]), 2)
        self.assertEqual(pathlib.Path(project["scene"]).name, "both.ply")

    def test_bad_values_stay_and_count_nowhere(self):
        scene = SHARED / "data/hostile/bear_bad_values.ply"
        if not scene.exists():
            self.skipTest(f"[skip] {scene} is not there")
        out = self.folder / "out"
        process = run("-q", "edit", scene, "--source", "bear", "--prompt", "a blue bear on the grass",
                      "--target", "blue",
                      "--out", out, *QUICK, "--no-gate", "--least-confidence", 0, "--keep-failed")
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertEqual(len([line for line in process.stderr.splitlines() if "cannot be drawn" in line]), 1,
                         process.stderr)
        report = json.loads((out / "report.json").read_text())
        self.assertGreater(report["nonfinite_before"], 246)
        self.assertEqual(report["nonfinite"], report["nonfinite_before"])
        self.assertEqual(report["nonfinite_labelled"], 0)
        self.assertEqual(report["changed_outside_label"], 0)
        self.assertGreater(report["psnr_outside_db"], 20)
        self.assertTrue(all(0 <= line["preservation"] < 10 for line in report["losses"]))
        self.check_unlabelled_rows(out)

    def check_unlabelled_rows(self, out):
        """Every unlabelled row of the source is in the edited scene, bit for bit and in the same order."""
        names, source = splat_rows(out / "source.ply")
        edited_names, edited = splat_rows(out / "scene.ply")
        self.assertEqual(names[: len(edited_names)], edited_names)
        label = names.index("label")
        width = 4 * len(edited_names)
        one = b"\x00\x00\x80\x3f"
        kept = [row[:width] for row in source if row[4 * label:4 * label + 4] != one]
        remaining = iter(edited)
        self.assertGreater(len(kept), 0)
        self.assertTrue(all(any(row == other for other in remaining) for row in kept))

    @unittest.skipUnless((MODEL / "clip/config.json").exists(),
                         "[skip] the starter model has no image-text encoder")
    def test_the_gate_scores_its_pictures(self):
        out = self.folder / "gated"
        self.edit(out, "--gate", "--method", "sds")
        gate = json.loads((out / "report.json").read_text())["gate"]
        self.assertEqual(len(gate["views"]), 4)
        self.assertTrue(-1 <= gate["score"] <= 1)
        self.assertIn("blue bear" if gate["warns"] else "show the edit", gate["verdict"])
        for i in range(4):
            self.assertTrue((out / f"evidence/gate_{i}.png").is_file())

    @unittest.skipUnless((MODEL / "clip/config.json").exists(),
                         "[skip] the starter model has no image-text encoder")
    def test_redrawn_views_are_judged_as_they_are(self):
        out = self.folder / "judged"
        self.edit(out, "--gate")
        report = json.loads((out / "report.json").read_text())
        self.assertTrue(-1 <= report["gate"]["score"] <= 1)
        self.assertIn("blue bear" if report["gate"]["warns"] else "show the edit", report["gate"]["verdict"])
        self.assertFalse((out / "evidence/gate_0.png").exists())   # no pictures were drawn for it alone
        self.assertTrue((out / "evidence/targets_0.png").is_file())

    def test_redrawn_views_are_part_of_the_evidence(self):
        out = self.folder / "views"
        self.edit(out, "--method", "views", "--edited-views", 3, "--rounds", 2, "--fit-steps", 8,
                  "--view-steps", 2)
        report = json.loads((out / "report.json").read_text())
        self.assertEqual([entry["round"] for entry in report["targets"]], [0, 1])
        for entry in report["targets"]:
            self.assertTrue((out / entry["file"]).read_bytes().startswith(b"\x89PNG"))
            self.assertIn(entry["file"], report["files"])
            self.assertEqual(len(entry["views"]), 3)
            self.assertFalse(any(view["dropped"] or view["redrawn"] for view in entry["views"]))
        networks = report["networks"]["edit"]
        self.assertEqual(networks["decoder"], 2 * 3 * 2)   # rounds, views, before and after
        self.assertGreater(networks["tflop"], 0)
        plain = self.folder / "plain"
        self.edit(plain, "--method", "sds")
        self.assertNotIn("targets", json.loads((plain / "report.json").read_text()))

    def test_the_recipe_gives_the_same_bytes(self):
        # Names that are not UTF-8 have to come back from the recipe, too.
        first, second = self.folder / os.fsdecode(b"first \xff"), self.folder / "second"
        scene = self.folder / os.fsdecode(b"b\xe4r.ply")
        shutil.copy(ASSETS / "scenes/bear/scene.ply", scene)
        self.edit(first, scene=scene)
        self.assertIn("b%E4r.ply",
                      json.loads((first / "recipe.json").read_text(encoding="utf-8"))["job"]["scene"])
        process = run("-q", "edit", "--recipe", first / "recipe.json", "--out", second)
        self.assertEqual(process.returncode, 0, process.stderr)
        for name in ["scene.ply", "source.ply", "recipe.json", "before_after.png",
                     "evidence/view_000_attention.png"]:
            self.assertEqual((first / name).read_bytes(), (second / name).read_bytes(), name)

    def test_variations_are_edits_from_other_seeds_and_one_picture_to_choose_from(self):
        out = self.folder / "out"
        process = self.edit(out, "--seed", 7, "--variations", 2)
        self.assertIn("variations.png", process.stdout)
        self.assertEqual(sorted(path.name for path in out.iterdir()), ["1", "2", "variations.png"])
        recipes = [json.loads((out / name / "recipe.json").read_text()) for name in "12"]
        self.assertEqual([recipe["request"]["seed"] for recipe in recipes], [7, 8])
        self.assertNotEqual((out / "1/scene.ply").read_bytes(), (out / "2/scene.ply").read_bytes())
        alone = self.folder / "alone"
        self.edit(alone, "--seed", 8)
        self.assertEqual((alone / "scene.ply").read_bytes(), (out / "2/scene.ply").read_bytes())
        for name in "12":
            self.check_unlabelled_rows(out / name)
        reports = json.loads(self.edit(self.folder / "again", "--variations", 2, "--json").stdout)
        self.assertEqual([report["changed_outside_label"] for report in reports], [0, 0])
        # None may take the place of its own scene, and then nothing is begun.
        before = (out / "1/scene.ply").read_bytes()
        process = run("-q", "edit", out / "2/scene.ply", "--prompt", "a blue bear", "--source", "bear",
                      "--out", out, "--variations", 2, *QUICK)
        self.assertNotEqual(process.returncode, 0)
        self.assertIn("--out", process.stderr)
        self.assertEqual((out / "1/scene.ply").read_bytes(), before)

    def test_another_sentence_is_not_bound_to_the_target_and_mode_of_the_recipe(self):
        out = self.folder / "golden"
        process = run("-q", "edit", "--demo", "--headless", "--prompt", "a golden bear on the grass", "--out",
                      out,
                      *QUICK)
        self.assertEqual(process.returncode, 0, process.stderr)
        request = json.loads((out / "recipe.json").read_text())["request"]
        self.assertEqual((request["source"], request["target"], request["mode"]), ("bear", "golden", "auto"))
        self.assertEqual(json.loads((out / "report.json").read_text())["mode"], "modify")

    def test_the_report_names_the_files_that_belong_together(self):
        out = self.folder / "out"
        out.mkdir(mode=0o750)
        self.edit(out)
        names = {str(path.relative_to(out)) for path in out.rglob("*") if path.is_file()}
        files = json.loads((out / "report.json").read_text())["files"]
        self.assertEqual(set(files) | {"report.json"}, names)
        self.assertEqual({name: (out / name).stat().st_size for name in files},
                         {name: entry["bytes"] for name, entry in files.items()})
        (out / "notes.txt").write_text("mine")
        self.edit(out, quick=["--views", 5, *QUICK[2:]])
        report = json.loads((out / "report.json").read_text())
        self.assertFalse((out / "evidence/view_005_render.png").exists(), "evidence of the first run")
        self.assertTrue(all((out / name).is_file() for name in report["files"]))
        self.assertEqual((out / "notes.txt").read_text(), "mine")
        self.assertEqual(out.stat().st_mode & 0o777, 0o750)
        self.assertEqual([path.name for path in self.folder.iterdir()], ["out"])
        process = run("locate", ASSETS / "scenes/bear/scene.ply", "--source", "bear", "--prompt",
                      "a red bear", "--out", out)
        self.assert_one_sentence(process, "edited scene")

    def test_the_folder_of_the_scene_itself_is_refused(self):
        scene = self.folder / "scene.ply"
        shutil.copy(ASSETS / "scenes/bear/scene.ply", scene)
        before = scene.read_bytes()
        (self.folder / "link").symlink_to(self.folder)
        for command in ["edit", "locate"]:
            for out in [self.folder, self.folder / "link"]:
                process = run(command, scene, "--source", "bear", "--prompt", "a blue bear", "--target",
                              "blue", "--out", out)
                self.assert_one_sentence(process, "folder of the scene itself")
                self.assertEqual(process.returncode, 2)
        self.assertEqual(scene.read_bytes(), before)
        self.assertEqual(self.folder_listing(), ["link", "scene.ply"])

    def test_places_that_cannot_take_the_results_are_refused_before_the_edit(self):
        if not can_mount():
            self.skipTest("[skip] this user may not mount file systems (unshare --user --mount)")
        (self.folder / "out").mkdir()
        for options, words in [("ro", "Read-only"), ("size=300k", "the results need about")]:
            process = run_in_namespace('mount -t tmpfs -o "$1" none "$2"; shift; shift; "$0" "$@"', options,
                                       self.folder / "out",
                                       "edit", ASSETS / "scenes/bear/scene.ply", "--source", "bear",
                                       "--prompt", "a blue bear",
                                       "--target", "blue", "--out", self.folder / "out", *QUICK)
            self.assert_one_sentence(process, words)
            self.assertNotIn("editing", process.stderr)
            self.assertNotIn("looking", process.stderr)

    def test_a_disk_that_fills_up_keeps_the_edit(self):
        if not can_mount():
            self.skipTest("[skip] this user may not mount file systems (unshare --user --mount)")
        (self.folder / "out").mkdir()
        # More than the estimate before the edit, which cannot know all; less than both scenes and the
        # pictures.
        room = 2 * (ASSETS / "scenes/bear/scene.ply").stat().st_size // 1024 + 90
        process = run_in_namespace('mount -t tmpfs -o "size=$1k" none "$2"; cd "$2"; shift; shift; '
                                   '"$0" "$@" || echo "exit $?"; '
                                   'find . -name "*.ply" | sort; "$0" info */scene.ply', room,
                                   self.folder / "out", "-q", "edit",
                                   ASSETS / "scenes/bear/scene.ply", "--source", "bear", "--prompt",
                                   "a blue bear on the grass",
                                   "--target", "blue", "--front", 0, "--no-gate", "--out",
                                   self.folder / "out", *QUICK)
        self.assertIn("exit 1", process.stdout, process.stderr)
        self.assertIn("./out.kept/scene.ply", process.stdout)
        self.assertIn("is kept in", process.stderr)
        self.assertIn("No space left", process.stderr)
        self.assertIn("splats", process.stdout)

    def test_locate_changes_nothing(self):
        out = self.folder / "found"
        process = run("-q", "locate", ASSETS / "scenes/bear/scene.ply", "--source", "bear", "--prompt",
                      "a red bear on the grass", "--target", "bear", "--out", out, *QUICK[:6])
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertTrue((out / "source.ply").is_file())
        self.assertFalse((out / "scene.ply").exists())

    def test_ctrl_c_keeps_what_was_reached(self):
        out = self.folder / "out"
        arguments = [PROGRAM, "edit", ASSETS / "scenes/bear/scene.ply", "--source", "bear", "--prompt",
                     "a blue bear on the grass", "--target", "blue", "--out", out, *QUICK[:6], *QUICK[8:],
                     "--method", "sds", "--iterations", 100000]
        process = subprocess.Popen([str(argument) for argument in arguments], stderr=subprocess.PIPE,
                                   stdout=subprocess.DEVNULL, text=True)
        for line in process.stderr:
            if line.startswith("editing"):
                break
        time.sleep(3)
        process.send_signal(signal.SIGINT)
        rest = process.stderr.read()
        self.assertEqual(process.wait(timeout=300), 130, rest)
        report = json.loads((out / "report.json").read_text())
        self.assertTrue(report["stopped"])
        self.assertGreater(report["iterations"], 0)
        self.assertEqual(report["changed_outside_label"], 0)
        self.check_unlabelled_rows(out)


if __name__ == "__main__":
    unittest.main()
