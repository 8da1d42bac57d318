"""Scenes and cameras of data/scenes and data/odd are read as they were: counts, bounds, and sums of what
convert writes against scene_sums.json. Sentences are not compared. After a change that is wanted, look at the
lines of `record_scenes.py --compare`, and write the file anew:
record_scenes.py PROGRAM --out tests/cli/scene_sums.json."""
import json
import os
import pathlib
import unittest

import record_scenes
from program import PROGRAM

SUMS = pathlib.Path(__file__).resolve().parent / "scene_sums.json"


@unittest.skipUnless((record_scenes.DATA / "scenes").exists(), f"[skip] {record_scenes.DATA} is not there")
class SceneSums(unittest.TestCase):
    def test_nothing_is_read_otherwise(self):
        before = json.loads(SUMS.read_text())
        self.assertGreater(len(before), 40)
        lines = record_scenes.differences(before, record_scenes.record_all(os.path.abspath(PROGRAM)))
        self.assertEqual([line for line in lines if ".said" not in line and ".warnings" not in line], [])

    def test_a_difference_is_seen(self):
        before = {"a": {"info": {"exit": 0, "facts": {"splats": 8, "bounds": [0.5]}}}}
        self.assertEqual(record_scenes.differences(before, json.loads(json.dumps(before))), [])
        after = {"a": {"info": {"exit": 0, "facts": {"splats": 9, "bounds": [0.5 + 1e-9]}}}, "b": {"exit": 1}}
        self.assertEqual(record_scenes.differences(before, after),
                         ["a: info.facts.splats: 8 -> 9", "b: exit: not there -> 1"])


if __name__ == "__main__":
    unittest.main()
