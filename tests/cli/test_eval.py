"""eval: the promised figures and sheets, the same for the same seed, wrong settings in one sentence."""
import json
import pathlib
import unittest

from program import ProgramTest, run_laboratory

ASSETS = pathlib.Path(__file__).resolve().parents[2] / "assets"
MODEL = ASSETS / "models/starter"
QUICK = ["--views", 6, "--held-out-views", 3, "--attention-repeats", 1, "--iterations", 12]
CHANGE_KEYS = ["iou", "weighted_iou", "mask_iou", "mask_boundary_f", "label_iou", "label_boundary_f"]
ADD_KEYS = ["place_recall", "place_precision", "place_iou", "changed_recall", "changed_precision"]
EDIT_KEYS = ["l1_before", "l1_after", "l1_reduction", "psnr_inside_before_db", "psnr_inside_db",
             "ssim_inside",
             "psnr_outside_db", "ssim_outside", "leak_rate", "own_leak_rate", "drift", "inconsistency",
             "direction"]


def without_measured_cost(value):
    """The report without what depends on the machine's mood: times and memory, and the file whose text holds
    them."""
    if isinstance(value, dict):
        return {key: without_measured_cost(entry) for key, entry in value.items()
                if key not in ("seconds", "edit_seconds", "peak_rss_mb", "eval.txt")}
    if isinstance(value, list):
        return [without_measured_cost(entry) for entry in value]
    return value


@unittest.skipUnless((MODEL / "model_index.json").exists(), "[skip] the starter model is not there")
class Evaluations(ProgramTest):
    def evaluate(self, out, *arguments):
        kinds = [] if "--kinds" in arguments else ["--kinds", "recolour add"]
        process = run_laboratory("-q", "eval", "--out", out, "--edits", 2, *kinds, *QUICK, *arguments)
        self.assertEqual(process.returncode, 0, process.stderr)
        return process, json.loads((out / "eval.json").read_text())

    def test_the_promised_figures(self):
        out = self.folder / "out"
        process, report = self.evaluate(out, "--seed", 5, "--ablations", "--ablation-edits", 1)
        self.assertIn("existing_weighted_iou", process.stdout)
        self.assertEqual(len(report["edits"]), 2)
        self.assertEqual([edit["kind"] for edit in report["edits"]], ["recolour", "add"])
        for edit, keys in zip(report["edits"], [CHANGE_KEYS, ADD_KEYS]):
            self.assertTrue(edit["to"]["held_out"])
            if "error" in edit:
                continue
            for key in keys + EDIT_KEYS:
                self.assertIn(key, edit)
            self.assertEqual(edit["drift"], 0)
            for stage in ("locate", "edit", "compare"):
                self.assertGreater(edit["seconds"][stage], 0)
            if not report["text_image_score"]:
                self.assertIsNone(edit["direction"])
        for name in ("existing_weighted_iou", "change_l1_reduction", "added_place_recall", "psnr_outside_db",
                     "leak_rate",
                     "drift", "change_success", "added_visible", "no_localization_worse",
                     "no_pseudo_gt_worse"):
            self.assertIn("goal", report["summary"][name])
        self.assertEqual([entry["name"] for entry in report["summary"]["ablation_means"]],
                         ["full", "no_localization", "no_pseudo_gt", "no_gate", "static_mask", "no_anchor"])
        self.assertGreater(report["peak_rss_mb"], 0)
        self.assertTrue((out / report["sheets"][0]).read_bytes().startswith(b"\x89PNG"))

    def test_what_is_removed_and_copied_is_held_against_the_truth(self):
        kinds = ["--kinds", "remove duplicate", "--seed", 5]
        process, report = self.evaluate(self.folder / "out", *kinds)
        removed, copied = report["edits"]
        for edit in (removed, copied):
            self.assertNotIn("error", edit)
            self.assertEqual(edit["rearranged"]["rows_changed_outside"], 0)
            self.assertIn("passed", edit["judgement"])
        for key in ("psnr_hole_db", "psnr_hole_deleted_db", "psnr_hole_mean_db", "ssim_hole", "thing_left"):
            self.assertIn(key, removed["rearranged"])
        for key in ("position_error", "covariance_error", "colour_error"):
            self.assertLess(copied["rearranged"][key], 1e-5)  # some steps of float
        self.assertEqual(report["summary"]["remove_rows_changed_outside"]["met"], True)
        self.assertIn("judgement", process.stdout)
        _, again = self.evaluate(self.folder / "again", *kinds)
        self.assertEqual(without_measured_cost(report), without_measured_cost(again))

    def test_the_same_seed_gives_the_same_figures(self):
        _, first = self.evaluate(self.folder / "first", "--seed", 9)
        _, second = self.evaluate(self.folder / "second", "--seed", 9)
        self.assertEqual(without_measured_cost(first), without_measured_cost(second))
        _, other = self.evaluate(self.folder / "other", "--seed", 10)
        self.assertNotEqual([edit["prompt"] for edit in first["edits"]],
                            [edit["prompt"] for edit in other["edits"]])

    def test_a_real_scene_without_truth(self):
        process = run_laboratory("-q", "eval", "--out", self.folder / "out", "--edits", 0, *QUICK, "--json",
                                 "--scenes",
                      f"{ASSETS / 'scenes/bear/scene.ply'}:bear:a blue bear on the grass:blue")
        self.assertEqual(process.returncode, 0, process.stderr)
        report = json.loads(process.stdout)
        scene = report["scenes"][0]
        self.assertNotIn("error", scene)
        for key in ("psnr_outside_db", "ssim_outside", "leak_rate", "inconsistency", "labelled"):
            self.assertIn(key, scene)
        self.assertEqual(scene["drift"], 0)
        self.assertEqual(scene["nonfinite"], 0)
        self.assertIsNone(report["summary"]["existing_weighted_iou"]["value"])

    def test_bench_edit_draws_a_curve_per_method(self):
        out = self.folder / "bench"
        process = run_laboratory("-q", "bench", "edit", "--out", out, "--edits", 2, "--kinds",
                                 "recolour material", "--seed", 55, *QUICK,
                      "--edited-views", 2, "--view-steps", 2, "--fit-steps", 10, "--sds", "6 12 rest",
                                 "--restyle-steps", 2, "--redraws", "2x2x1 3x1x2 draft")
        self.assertEqual(process.returncode, 0, process.stderr)
        report = json.loads((out / "edit.json").read_text())
        curves = {curve["method"]: {point["name"]: point for point in curve["points"]}
                  for curve in report["curves"]}
        self.assertEqual(set(curves["sds"]), {"6", "12", "until at rest"})
        self.assertEqual(set(curves["views"]), {"normal", "2x2x1", "3x1x2", "draft"})
        self.assertEqual([name for points in curves.values() for name in points if points[name]["default"]],
                         ["12", "normal"])
        self.assertIn("2x2x1", process.stdout)
        ran = [point for points in curves.values() for point in points.values() if point["ran"] > 0]
        for point in ran:
            self.assertEqual(point["edits"], 2)
            self.assertGreater(point["tflop"], 0)
            self.assertGreater(point["seconds"], 0)
            self.assertTrue(-1 <= point["error_removed"] <= 1)
        if ran:
            self.assertLess(curves["sds"]["6"]["tflop"], curves["sds"]["12"]["tflop"])
            # 4 and 6 denoising steps
            self.assertLess(curves["views"]["2x2x1"]["unet"], curves["views"]["3x1x2"]["unet"])
            self.assertEqual(curves["views"]["normal"]["unet"], curves["views"]["2x2x1"]["unet"])
            # one view instead of two
            self.assertLess(curves["views"]["draft"]["unet"], curves["views"]["2x2x1"]["unet"])
            self.assertLessEqual(curves["sds"]["until at rest"]["unet"], curves["sds"]["12"]["unet"])
        self.assertTrue((out / "pareto.png").read_bytes().startswith(b"\x89PNG"))
        self.assertIn("pareto.png", report["files"])
        for points in ["8x6", "8x6x1x", "eight"]:
            self.assert_one_sentence(run_laboratory("-q", "bench", "edit", "--out", self.folder / "none",
                                                    "--redraws", points), "8x4x1")
        self.assert_one_sentence(run_laboratory("-q", "bench", "edit", "--out", self.folder / "none",
                                                "--redraws", "8000x6x1"), "edited_views")
        self.assertFalse((self.folder / "none").exists())

    def test_wrong_settings_leave_nothing(self):
        out = self.folder / "out"
        self.assert_one_sentence(run_laboratory("-q", "eval", "--out", out, "--kinds", "melt"), "melt")
        self.assert_one_sentence(run_laboratory("-q", "eval", "--out", out, "--mode", "sometimes"),
                                 "sometimes")
        self.assert_one_sentence(run_laboratory("-q", "eval", "--out", out, "--edits", 0, "--scenes",
                                                "/no/scene.ply"), "no such scene")
        self.assertEqual(self.folder_listing(), [])


if __name__ == "__main__":
    unittest.main()
