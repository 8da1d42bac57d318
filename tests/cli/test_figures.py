"""What the bundled model reaches on held-out scenes; run before a release (preset full)."""
import json
import pathlib
import unittest

from program import ProgramTest, run_laboratory

MODEL = pathlib.Path(__file__).resolve().parents[2] / "assets/models/starter"


@unittest.skipUnless((MODEL / "model_index.json").exists(), "[skip] the starter model is not there")
class Figures(ProgramTest):
    def figures(self, *arguments):
        out = self.folder / "out"
        process = run_laboratory("-q", "eval", "--out", out, *arguments, timeout=3600)
        self.assertEqual(process.returncode, 0, process.stderr)
        report = json.loads((out / "eval.json").read_text())
        summary = report["summary"]
        return report["edits"], {name: summary[name]["value"] for name in summary
                                 if isinstance(summary[name], dict)}

    def test_with_cameras_that_know_where_the_thing_is(self):
        """At the size of a quick run."""
        _, figures = self.figures("--oracle-views", "--seed", 5, "--edits", 4, "--kinds", "recolour add",
                                  "--views", 12,
                                  "--image-size", 64, "--iterations", 150)
        self.assertEqual(figures["failed"], 0)
        self.assertGreaterEqual(figures["existing_weighted_iou"], 0.7)
        self.assertGreaterEqual(figures["change_colour_error_reduction"], 0.5)
        self.assertGreaterEqual(figures["added_place_recall"], 0.5)
        self.assertEqual(figures["drift"], 0)

    def test_as_a_user_begins(self):
        """Scene, source and sentence, all else as it is set: the new word is found, and the thing it
        changes."""
        edits, figures = self.figures("--seed", 6, "--edits", 8, "--kinds", "recolour ground")
        self.assertLessEqual(figures["failed"], 1)
        self.assertGreaterEqual(sum(edit.get("guessed", {}).get("right", False) for edit in edits), 7)
        self.assertGreaterEqual(figures["existing_weighted_iou"], 0.7)
        self.assertGreaterEqual(figures["change_success"], 0.7)
        self.assertEqual(figures["drift"], 0)


if __name__ == "__main__":
    unittest.main()
