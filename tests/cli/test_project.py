"""project prints what a project holds and writes its edited scene."""
import json
import pathlib
import unittest

from program import ProgramTest, run

CORPUS = pathlib.Path(__file__).resolve().parent.parent / "fuzz" / "corpus" / "project"
WHOLE = CORPUS / "whole.gsep"          # holds its scene
REFERENCE = CORPUS / "reference.gsep"  # its scene is nowhere


class Project(ProgramTest):
    def test_summary(self):
        process = run("project", WHOLE, "--json")
        self.assertEqual(process.returncode, 0, process.stderr)
        found = json.loads(process.stdout)
        self.assertTrue(found["scene_found"])
        self.assertEqual([edit["enabled"] for edit in found["edits"]], [True, False, True])
        self.assertEqual(len(found["labels"]), 1)
        self.assertIn("edit 2 ", run("project", WHOLE).stdout)
        self.assertIn("(off)", run("project", WHOLE).stdout)

    def test_export(self):
        splats = json.loads(run("project", WHOLE, "--json").stdout)["splats"]
        output = self.folder / "out.ply"
        process = run("project", WHOLE, "--export", output, "--label", "label 1")
        self.assertEqual(process.returncode, 0, process.stderr)
        written = self.info(output)
        self.assertEqual(written["splats"], splats)
        self.assertEqual(written["labels"], ["label 1"])

    def test_errors_are_one_sentence(self):
        self.assert_one_sentence(run("project", WHOLE, "--export", self.folder / "a.ply", "--label", "nope"),
                                 "label 1")
        self.assert_one_sentence(run("project", REFERENCE, "--export", self.folder / "b.ply"),
                                 "not there any more")
        self.assertFalse(json.loads(run("project", REFERENCE, "--json").stdout)["scene_found"])
        self.assert_one_sentence(run("project", self.write("c.gsep", WHOLE.read_bytes()[:4000])), "zip")
        self.assert_one_sentence(run("project", self.folder / "none.gsep"), "does not exist")
        self.assertEqual(self.folder_listing(), ["c.gsep"])


if __name__ == "__main__":
    unittest.main()
