"""SAM's weights on the command line: named in report and recipe, and bad ones end the command with a
sentence."""
import json
import pathlib
import unittest

from program import SHARED, ProgramTest, run

ASSETS = pathlib.Path(__file__).resolve().parents[2] / "assets"
SCENE = ASSETS / "scenes/bear/scene.ply"
WEIGHTS = SHARED / "goldens/sam/sam_original.pth"
QUICK = ["--views", 4, "--image-size", 64, "--attention-repeats", 1, "--no-focus"]


@unittest.skipUnless((ASSETS / "models/starter/model_index.json").exists(),
                     "[skip] the starter model is not there")
class Segmenter(ProgramTest):
    def locate(self, *arguments):
        return run("-q", "locate", SCENE, "--source", "bear", "--prompt", "a blue bear on the grass",
                   "--front", 0, *QUICK, *arguments)

    @unittest.skipUnless(WEIGHTS.exists(), "[skip] the reference's weights are not there")
    def test_report_and_recipe_name_it(self):
        plain, cut = self.folder / "plain", self.folder / "cut"
        for out, arguments in ((plain, []), (cut, ["--segmenter", WEIGHTS])):
            process = self.locate("--out", out, *arguments)
            self.assertEqual(process.returncode, 0, process.stderr)
        self.assertEqual(json.loads((plain / "report.json").read_text())["segmenter"], "grabcut")
        self.assertEqual(json.loads((cut / "report.json").read_text())["segmenter"], "SAM")
        recipe = json.loads((cut / "recipe.json").read_text())
        self.assertEqual(pathlib.Path(recipe["job"]["segmenter"]).resolve(), WEIGHTS.resolve())

    def test_bad_weights_are_refused_and_nothing_is_written(self):
        cases = (("gone.pth", None, "does not exist"),
                 ("bad.safetensors", b"no weights", "segmenter cannot be used"),
                 ("evil.pkl", b"\x80\x02cposix\nsystem\n.", "format before PyTorch 1.6"))
        for name, content, expected in cases:
            with self.subTest(name):
                weights = self.folder / name
                if content is not None:
                    weights.write_bytes(content)
                process = self.locate("--segmenter", weights, "--out", self.folder / "out")
                self.assertEqual(process.returncode, 1)
                self.assertIn(expected, process.stderr)
                self.assertIn(name, process.stderr)
                self.assertEqual(len(process.stderr.strip().splitlines()), 1, process.stderr)
                self.assertFalse((self.folder / "out").exists())

    def test_a_folder_that_is_no_clipseg_is_refused(self):
        process = self.locate("--text-segmenter", self.folder, "--out", self.folder / "out")
        self.assertEqual(process.returncode, 1)
        self.assertIn("config.json", process.stderr)
        self.assertFalse((self.folder / "out").exists())


if __name__ == "__main__":
    unittest.main()
