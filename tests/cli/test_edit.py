"""locate and edit with the bundled model: the promised files, the promised numbers, the same bytes from the recipe."""
import json
import pathlib
import signal
import subprocess
import time
import unittest

from program import PROGRAM, ProgramTest, run

ASSETS = pathlib.Path(__file__).resolve().parents[2] / "assets"
MODEL = ASSETS / "models/starter"
QUICK = ["--views", 6, "--image-size", 64, "--attention-repeats", 1, "--iterations", 20, "--turntable-frames", 3,
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
    def edit(self, out, *arguments):
        process = run("-q", "edit", ASSETS / "scenes/bear/scene.ply", "--source", "bear", "--prompt",
                      "a blue bear on the grass", "--target", "blue", "--front", 0, "--out", out, *QUICK,
                      *([] if "--gate" in arguments else ["--no-gate"]), *arguments)
        self.assertEqual(process.returncode, 0, process.stderr)
        return process

    def test_the_promised_files(self):
        out = self.folder / "out"
        self.edit(out)
        for name in ["scene.ply", "source.ply", "report.json", "recipe.json", "before_after.mp4", "before_after.png",
                     "evidence/index.json", "evidence/view_000_attention.png", "evidence/view_000_points.png"]:
            self.assertTrue((out / name).is_file(), name)
        self.assertEqual([path.name for path in self.folder.iterdir()], ["out"])
        report = json.loads((out / "report.json").read_text())
        for key in ["splats", "labelled", "changed_outside_label", "nonfinite", "psnr_outside_db", "seconds", "peak_rss_mb"]:
            self.assertIn(key, report)
        self.assertEqual(report["changed_outside_label"], 0)
        self.assertEqual(report["nonfinite"], 0)
        self.assertGreater(report["labelled"], 0)
        self.assertEqual(self.info(out / "scene.ply")["splats"], report["splats"])
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

    @unittest.skipUnless((MODEL / "clip/config.json").exists(), "[skip] the starter model has no image-text encoder")
    def test_the_gate_scores_its_pictures(self):
        out = self.folder / "gated"
        self.edit(out, "--gate")
        gate = json.loads((out / "report.json").read_text())["gate"]
        self.assertEqual(len(gate["views"]), 4)
        self.assertTrue(-1 <= gate["score"] <= 1)
        self.assertIn("blue bear" if gate["warns"] else "show the edit", gate["verdict"])
        for i in range(4):
            self.assertTrue((out / f"evidence/gate_{i}.png").is_file())

    def test_the_recipe_gives_the_same_bytes(self):
        first, second = self.folder / "first", self.folder / "second"
        self.edit(first)
        process = run("-q", "edit", "--recipe", first / "recipe.json", "--out", second)
        self.assertEqual(process.returncode, 0, process.stderr)
        for name in ["scene.ply", "source.ply", "recipe.json", "before_after.png", "evidence/view_000_attention.png"]:
            self.assertEqual((first / name).read_bytes(), (second / name).read_bytes(), name)

    def test_another_sentence_is_not_bound_to_the_target_and_mode_of_the_recipe(self):
        out = self.folder / "golden"
        process = run("-q", "edit", "--demo", "--headless", "--prompt", "a golden bear on the grass", "--out", out,
                      *QUICK)
        self.assertEqual(process.returncode, 0, process.stderr)
        request = json.loads((out / "recipe.json").read_text())["request"]
        self.assertEqual((request["source"], request["target"], request["mode"]), ("bear", "golden", "auto"))
        self.assertEqual(json.loads((out / "report.json").read_text())["mode"], "modify")

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
                     "--iterations", 100000]
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

    def test_the_starter_reaches_its_figures(self):
        """The project's acceptance figures on held-out scenes, at the size of a quick run."""
        process = run("-q", "bench", "starter", "--scenes", 6, "--recolours", 1, "--additions", 1, "--views", 12,
                      "--image-size", 64, "--iterations", 150, timeout=1500)
        self.assertEqual(process.returncode, 0, process.stderr)
        figures = json.loads(process.stdout)
        self.assertGreaterEqual(figures["localization"]["mean_iou"], 0.7)
        self.assertGreaterEqual(figures["localization"]["mean_weighted_iou"], 0.7)
        self.assertGreaterEqual(figures["recolour"]["mean_colour_error_reduction"], 0.5)
        self.assertGreaterEqual(figures["add"]["mean_recall"], 0.5)
        for case in figures["recolour"]["cases"]:
            self.assertEqual(case["changed_outside_label"], 0)


if __name__ == "__main__":
    unittest.main()
