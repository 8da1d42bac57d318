"""eval --real: the figures of real_suite.py on the same edits, sheets, and wrong suites in one sentence."""
import importlib.util
import json
import os
import pathlib
import signal
import subprocess
import sys
import unittest
from unittest import mock

from program import LABORATORY, PROGRAM, SHARED, ProgramTest, run_laboratory

ASSETS = pathlib.Path(__file__).resolve().parents[2] / "assets"
MODEL = ASSETS / "models/starter"
SCRIPT = SHARED / "data/real/real_suite.py"
QUICK = ["--views", "6", "--attention-repeats", "1", "--quality", "draft"]
SEEN = 0.01   # pixels on the border of a threshold, where cameras differ in the last digit
EXACT = 1e-6  # sums of doubles in another order
UPPER = {"halfspace": {"normal": [0, 1, 0], "offset": 0}}
ALL = {"box": {"centre": [0, 0, 0], "half": [100, 100, 100]}}
# Half of a ball that the label has or has not, which counts neither way.
FOOT = {"ellipsoid": {"centre": [0, 0.4, 0], "radii": [0.3, 0.3, 0.3]}}


def tiny_suite():
    """A suite about the bundled scene: what it asks for is found, refused, added, and changes a half."""
    task = {"scene": "bear", "source": "bear", "about": "bear", "place": None, "known_word": True,
            "cut_out": "0.2,0.1,0.8,0.9,0,15,1", "accept": ""}
    return {"name": "tiny", "about": "", "roots": {"assets": "nowhere"},
            "scenes": [{"name": "bear", "root": "assets", "file": "bear/scene.ply", "up": "-y", "front": 0,
                        "auto_up_right": True, "splats": 0, "note": "",
                        "things": {"bear": {"union": [{"all": [UPPER, ALL]}], "either": [FOOT]}}}],
            "tasks": [{**task, "name": "bear.blue", "prompt": "a blue bear", "kind": "recolour"},
                      {**task, "name": "bear.hat", "prompt": "a bear wearing a red hat", "kind": "add",
                       "place": {"union": [{"box": {"centre": [0, -0.5, 0], "half": [0.4, 0.4, 0.4]}}]}},
                      {**task, "name": "bear.skull", "source": "skull", "prompt": "a blue skull",
                       "kind": "recolour", "known_word": False, "cut_out": None}]}


@unittest.skipUnless((MODEL / "model_index.json").exists(), "[skip] the starter model is not there")
class RealSuites(ProgramTest):
    def setUp(self):
        super().setUp()
        self.suite = self.folder / "suite.json"
        self.suite.write_text(json.dumps(tiny_suite()))
        self.root = f"assets={ASSETS / 'scenes'}"

    def evaluate(self, *arguments):
        process = run_laboratory("-q", "eval", "--real", self.suite, "--real-root", self.root, "--out",
                                 self.folder / "out", *QUICK, *arguments)
        self.assertEqual(process.returncode, 0, process.stderr)
        return process, json.loads((self.folder / "out/eval.json").read_text())

    def script_results(self):
        """Results of the script for the same suite and settings."""
        if not SCRIPT.exists():
            self.skipTest(f"[skip] {SCRIPT} is not there")
        spec = importlib.util.spec_from_file_location("real_suite", SCRIPT)
        script = importlib.util.module_from_spec(spec)
        try:
            spec.loader.exec_module(script)
        except ImportError:
            self.skipTest("[skip] numpy is not installed")
        script.EDIT_ARGS = [*script.EDIT_ARGS, *QUICK]
        out = self.folder / "script"
        arguments = ["real_suite.py", PROGRAM, str(self.suite), str(out), "--root", self.root]
        with mock.patch.object(sys, "argv", arguments), mock.patch("builtins.print"):
            script.main()
        return {task["task"]: task["runs"] for task in json.loads((out / "results.json").read_text())}

    def compare(self, run, theirs, name):
        for group, within in (("opacity", EXACT), ("plain", EXACT), ("seen", SEEN)):
            self.assertEqual(group in run, group in theirs, f"{name} {group}")
            for key, value in theirs.get(group, {}).items():
                self.assertAlmostEqual(run[group][key], value, delta=within, msg=f"{name} {group} {key}")
        for key, within in (("place_share", EXACT), ("place_share_plain", EXACT), ("new_rows", 0),
                            ("seen_change_in_truth", SEEN), ("seen_spill", SEEN), ("labelled", 0)):
            self.assertEqual(key in run, key in theirs, f"{name} {key}")
            if key in theirs:
                self.assertAlmostEqual(run[key], theirs[key], delta=within, msg=f"{name} {key}")
        self.assertEqual(run["edit_mode"], theirs["edit_mode"])

    def test_the_figures_are_those_of_the_script(self):
        scripts = self.script_results()
        _, report = self.evaluate("--real-modes", "word box")
        measured = 0
        for task in report["tasks"]:
            self.assertEqual(set(task["runs"]), set(scripts[task["task"]]))
            for mode, run in task["runs"].items():
                theirs = scripts[task["task"]][mode]
                # The script takes what is kept out for refused, and measures nothing.
                self.assertEqual(run["ending"] != "done", theirs["refused"])
                if run["ending"] == "done":
                    measured += 1
                    self.compare(run, theirs, f"{task['task']} {mode}")
                if theirs["confidence"] is not None:
                    self.assertAlmostEqual(run["confidence"], theirs["confidence"], delta=0.005)
        self.assertGreater(measured, 1)

    def test_every_run_has_an_ending_and_every_task_a_row(self):
        process, report = self.evaluate("--real-modes", "word", "--real-rows", 2)
        runs = {task["task"]: task["runs"]["word"] for task in report["tasks"]}
        self.assertEqual(list(runs), ["bear.blue", "bear.hat", "bear.skull"])
        self.assertEqual((runs["bear.skull"]["ending"], runs["bear.skull"]["cause"]),
                         ("refused", "word not known"))
        self.assertIn("skull", runs["bear.skull"]["message"])
        self.assertIn("confidence", runs["bear.blue"])
        self.assertEqual(runs["bear.blue"]["level"], "green")
        self.assertEqual([(task["sheet"], task["row"]) for task in report["tasks"]],
                         [("real_000.png", 1), ("real_000.png", 2), ("real_001.png", 1)])
        for sheet in report["sheets"]:
            self.assertTrue((self.folder / "out" / sheet).read_bytes().startswith(b"\x89PNG"))
        self.assertEqual(sum(report["summary"]["up"].values()), 1)
        self.assertIn("by word, unknown nouns: 1 runs, 0 done, 0 kept out, 1 refused (1 word not known)",
                      process.stdout)
        self.assertEqual((self.folder / "out/eval.txt").read_text(), process.stdout.split("\nfigures")[0])

    def test_steps_follow_each_other_and_nothing_to_change_is_a_refusal(self):
        suite = tiny_suite()
        task = suite["tasks"][0]
        suite["tasks"] = [{**task, "name": "two", "prompt": "a blue bear wearing a yellow hat"},
                          {**task, "name": "same", "prompt": "a bear"}]
        self.suite.write_text(json.dumps(suite))
        _, report = self.evaluate("--real-modes", "word")
        two, same = [task["runs"]["word"] for task in report["tasks"]]
        self.assertEqual((two["ending"], two["steps"]), ("done", 2))
        self.assertGreater(two["new_rows"], 0)
        self.assertGreater(two["labelled"], 0)
        self.assertEqual((same["ending"], same["cause"]), ("refused", "other"))
        self.assertIn("there already", same["message"])

    def test_a_click_on_the_thing_labels_what_the_model_has_no_word_for(self):
        suite = tiny_suite()
        above = {"box": {"centre": [0, -0.45, 0], "half": [0.3, 0.25, 0.3]}}  # the ground lies below
        suite["scenes"][0]["things"]["bear"] = {"union": [above]}
        self.suite.write_text(json.dumps(suite))
        process, report = self.evaluate("--real-modes", "click", "--real-only", "skull")
        run, = [task["runs"]["click"] for task in report["tasks"]]
        self.assertNotEqual(run["ending"], "refused", run)
        self.assertGreater(run["opacity"]["recall"], 0.9)
        self.assertIn("by click, unknown nouns: 1 runs", process.stdout)

    def found_by_word(self, task):
        """The run of a task of the suite of scans."""
        suite = SHARED / "data/real/suite.json"
        if not suite.exists():
            self.skipTest(f"[skip] {suite} is not there")
        process = run_laboratory("-q", "eval", "--real", suite, "--real-modes", "word", "--real-only", task,
                                 "--quality", "draft", "--out", self.folder / "out")
        self.assertEqual(process.returncode, 0, process.stderr)
        task, = json.loads((self.folder / "out/eval.json").read_text())["tasks"]
        return task["runs"]["word"]

    def test_a_word_finds_all_of_a_scan_where_it_finds_most(self):
        found = self.found_by_word("horse_statue.white")["opacity"]
        self.assertGreater(found["recall"], 0.97)
        self.assertGreater(found["precision"], 0.97)

    def test_what_is_worn_is_found_whole_and_asks_for_a_look(self):
        run = self.found_by_word("luigi.red_hat")
        self.assertGreater(run["opacity"]["iou"], 0.7)
        self.assertEqual(run["level"], "amber")

    def test_ctrl_c_keeps_the_tasks_that_are_done(self):
        arguments = [LABORATORY, "eval", "--real", self.suite, "--real-root", self.root, "--out",
                     self.folder / "out", *QUICK, "--real-modes", "word"]
        process = subprocess.Popen([str(argument) for argument in arguments], stderr=subprocess.PIPE,
                                   stdout=subprocess.DEVNULL, text=True)
        for line in process.stderr:
            if line.startswith("bear.hat"):
                break
        process.send_signal(signal.SIGINT)
        rest = process.stderr.read()
        self.assertEqual(process.wait(timeout=300), 130, rest)
        report = json.loads((self.folder / "out/eval.json").read_text())
        self.assertTrue(report["stopped"])
        self.assertEqual([task["task"] for task in report["tasks"]], ["bear.blue"])
        self.assertTrue((self.folder / "out" / report["tasks"][0]["sheet"]).is_file())

    def test_wrong_suites_leave_nothing(self):
        before = self.folder_listing()
        command = ["-q", "eval", "--out", self.folder / "out", "--real"]
        self.assert_one_sentence(run_laboratory(*command, self.folder / "none.json"), "none.json")
        self.assert_one_sentence(run_laboratory(*command, self.suite), "--real-root", "scene.ply")
        self.assert_one_sentence(run_laboratory(*command, self.suite, "--real-root", self.root,
                                                "--real-only", "cat"), "cat")
        self.assert_one_sentence(run_laboratory(*command, self.suite, "--real-modes", "sideways"), "sideways")
        broken = self.write("broken.json", b'{"name": "x"')
        self.assert_one_sentence(run_laboratory(*command, broken), "not valid json")
        os.remove(broken)
        self.assertEqual(self.folder_listing(), before)


if __name__ == "__main__":
    unittest.main()
