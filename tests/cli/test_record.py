"""record_edits.py: a comparison sees every difference that counts, and no other."""
import copy
import json
import pathlib
import tempfile
import unittest

import record_edits

REPORT = {"mode": "modify", "labelled": 2994, "psnr_outside_db": 70.9, "seconds": {"total": 4.1},
          "peak_rss_mb": 312.5,
          "losses": [{"iteration": 0, "anchor": 0.0}, {"iteration": 1, "anchor": 0.5}],
          "settings_from": [{"field": "request.tau", "value": 0.5, "source": "user"}],
          "files": {"scene.ply": {"bytes": 9, "fnv1a": "17"},
                    "evidence/index.json": {"bytes": 3, "fnv1a": "4"}}}


class Records(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="gse-record-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def record(self, name, report=None, scene=b"rows", code=0):
        """A made-up record with one recipe, of results that stand in a folder."""
        results = self.folder / name
        (results / "evidence").mkdir(parents=True)
        (results / "scene.ply").write_bytes(scene)
        (results / "report.json").write_text(json.dumps(REPORT if report is None else report))
        path = self.folder / f"{name}.json"
        path.write_text(json.dumps({"recolour": {"exit_code": code,
                                                 "results": record_edits.record_folder(results)}}))
        return path

    def differences(self, before, after):
        return record_edits.differences(*(json.loads(path.read_text()) for path in (before, after)))

    def test_times_memory_and_fingerprints_are_no_difference(self):
        report = copy.deepcopy(REPORT)
        report.update(seconds={"total": 99.0}, peak_rss_mb=1.0)
        report["files"]["scene.ply"] = {"bytes": 9, "xxh3": "18"}
        before, after = self.record("before"), self.record("after", report)
        self.assertEqual(self.differences(before, after), [])
        self.assertEqual(record_edits.compare(before, after), 0)

    def test_every_other_difference_has_a_line(self):
        report = copy.deepcopy(REPORT)
        report["labelled"] = 2995
        report["losses"][0]["anchor"] = 0.25
        report["losses"][1]["anchor"] = 0.75
        report["settings_from"][0]["value"] = 0.4
        report["files"]["lora.safetensors"] = {"bytes": 1}
        before, after = self.record("before"), self.record("after", report, scene=b"other rows", code=3)
        lines = self.differences(before, after)
        self.assertTrue(all(line.startswith("recolour: ") for line in lines), lines)
        fields = [line.split(": ")[1] for line in lines]
        self.assertEqual(sorted(fields),
                         ["exit_code", "results.report.files", "results.report.labelled",
                          "results.report.losses.anchor",
                                          "results.report.settings_from.label_threshold",
                          "results.scene.ply"])
        self.assertIn("0.0 -> 0.25 (and 1 more)", lines[fields.index("results.report.losses.anchor")])
        self.assertEqual(record_edits.compare(before, after), 1)

    def test_a_field_or_recipe_that_is_gone_is_a_difference(self):
        report = {key: value for key, value in REPORT.items() if key != "mode"}
        lines = self.differences(self.record("before"), self.record("after", report))
        self.assertEqual(lines, ["recolour: results.report.mode: modify -> not there"])
        self.assertEqual(len(record_edits.differences({"recolour": {}}, {"dyed": {}})), 2)

    def test_old_names_are_compared_under_their_new_ones(self):
        report = copy.deepcopy(REPORT)
        report["settings_from"][0]["field"] = "request.label_threshold"
        self.assertEqual(self.differences(self.record("before"), self.record("after", report)), [])
        report["label_count"] = report.pop("labelled")
        self.assertEqual(len(self.differences(self.record("first"), self.record("second", report))), 2)

    def test_recipes_stand_behind_those_that_they_need(self):
        names = list(record_edits.RECIPES)
        self.assertGreaterEqual(len(names), 18)
        for name in names:
            for other in record_edits.needed(name):
                self.assertLess(names.index(other), names.index(name))


if __name__ == "__main__":
    unittest.main()
