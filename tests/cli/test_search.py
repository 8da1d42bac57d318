"""Searches with the bundled model: words nobody knows, words the scene does not show, labels made by hand,
sentences too long to be read."""
import json
import pathlib
import struct
import unittest

from program import ProgramTest, run, run_laboratory

ASSETS = pathlib.Path(__file__).resolve().parents[2] / "assets"
MODEL = ASSETS / "models/starter"
BEAR = ASSETS / "scenes/bear/scene.ply"
LOOK = ["--views", 6, "--image-size", 64, "--attention-repeats", 1]
QUICK = [*LOOK, "--iterations", 60, "--turntable-frames", 2, "--turntable-size", 64, "--no-gate"]


def columns(path, *wanted):
    """Values of some columns of a binary PLY whose properties are all floats."""
    header, body = path.read_bytes().split(b"end_header\n", 1)
    names = [line.split()[2].decode() for line in header.splitlines() if line.startswith(b"property float ")]
    stride = 4 * len(names)
    return {name: [struct.unpack_from("<f", body, row * stride + 4 * names.index(name))[0]
                   for row in range(len(body) // stride)] for name in wanted}


@unittest.skipUnless((MODEL / "model_index.json").exists(), "[skip] the starter model is not there")
class Searches(ProgramTest):
    def edit(self, *arguments, scene=BEAR):
        return run("edit", scene, "--out", self.folder / "out", *QUICK, *arguments)

    def test_an_unknown_source_is_refused_before_work(self):
        process = self.edit("--source", "sign", "--prompt", "a golden sign on the grass", "--target",
                            "golden")
        line = self.assert_one_sentence(process, '"sign"', "label it by hand instead", "--at X,Y",
                                        "--cut-out", "--the-thing", "bear", "grass")
        self.assertNotIn('"in"', line)
        self.assertEqual(self.folder_listing(), [])
        # Before the scene is read, where its format keeps no labels that may have the name: what is wrong
        # with it is not even noticed.
        nothing = self.write("empty.splat", b"")
        process = self.edit("--source", "baer", "--prompt", "a golden baer", "--target", "golden",
                            scene=nothing)
        self.assert_one_sentence(process, '"baer"', 'use "bear"')

    def test_an_unknown_target_is_refused_before_work(self):
        process = self.edit("--source", "bear", "--prompt", "a bear wearing a sombrero")
        self.assert_one_sentence(process, '"sombrero"', "cannot make it")

    def test_a_ground_without_a_word_is_told_by_the_shape_of_the_scene(self):
        process = self.edit("--source", "ground", "--prompt", "a bear on the snow")
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertIn("look at the label", process.stderr)
        report = json.loads((self.folder / "out/report.json").read_text())
        self.assertIn("the flat that things stand on", report["label_doubt"])
        self.assertEqual(report["changed_outside_label"], 0)
        # The grass has 1920 of 4914 splats; the lowest of the bear's may lie within two voxels of it.
        self.assertGreater(report["labelled"], 1900)
        self.assertLess(report["labelled"], 1920 + 0.2 * 2994)
        # A part of a ground is no matter of the scene's shape.
        process = self.edit("--source", "road", "--prompt", "a bear on a golden road")
        self.assert_one_sentence(process, '"road"', "label it by hand instead")

    def test_a_ground_that_words_and_shape_tell_alike_is_that_of_the_words(self):
        scene = self.folder / "chair.ply"
        process = run_laboratory("synth", scene, "--object", "chair", "--material", "black", "--accessory",
                                 "crown", "--accessory-colour", "white", "--seed", 8771603698888874792)
        self.assertEqual(process.returncode, 0, process.stderr)
        process = run("edit", scene, "--source", "grass", "--prompt",
                      "a black chair wearing a white crown on the tiles", "--quality", "draft",
                      "--turntable-frames", 0, "--out", self.folder / "out")
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertNotIn("look at the label", process.stderr)
        report = json.loads((self.folder / "out/report.json").read_text())
        self.assertFalse(report.get("label_doubt"))

    def test_a_box_says_what_may_change(self):
        box = ["--cut-out", "0.42,0.35,0.575,0.645,0,15,1"]
        process = self.edit("--source", "thingummy", "--prompt", "a golden thingummy on the grass", *box)
        self.assertEqual(process.returncode, 0, process.stderr)
        report = json.loads((self.folder / "out/report.json").read_text())
        self.assertEqual(report["changed_outside_label"], 0)
        self.assertGreater(report["labelled"], 2500)   # the bear's 2994 of 4914 splats
        self.assertLess(report["labelled"], 3200)
        process = run("edit", "--recipe", self.folder / "out/recipe.json", "--out", self.folder / "again")
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertEqual((self.folder / "again/scene.ply").read_bytes(),
                         (self.folder / "out/scene.ply").read_bytes())
        process = self.edit("--source", "thingummy", "--prompt", "a golden thingummy", "--cut-out",
                            "0.5,0.1,0.4,0.9")
        self.assert_one_sentence(process, "--cut-out", "left before right")
        process = self.edit("--source", "thingummy", "--prompt", "a golden thingummy", *box, "--use-label")
        self.assert_one_sentence(process, "--use-label and --cut-out", "leave one of them out")

    def test_a_click_or_the_largest_thing_says_what_may_change(self):
        words = ["--source", "thingummy", "--prompt", "a golden thingummy on the grass"]
        for pointing, said in ([["--at", "0.5,0.5,0,15"], "what was clicked"],
                               [["--the-thing"], "the largest thing that stands alone"]):
            process = self.edit(*words, *pointing)
            self.assertEqual(process.returncode, 0, process.stderr)
            self.assertIn(f'"thingummy" is {said}', process.stderr)
            self.assertIn("parted from what it stands on", process.stderr)
            report = json.loads((self.folder / "out/report.json").read_text())
            self.assertEqual(report["changed_outside_label"], 0)
            self.assertGreater(report["labelled"], 2500)   # the bear's 2994 of 4914 splats
            self.assertLess(report["labelled"], 3300)
        # The name stays with the label: the project knows the word.
        process = run("edit", self.folder / "out/edit.gsep", "--out", self.folder / "again", *QUICK,
                      "--source", "thingummy", "--prompt", "a blue thingummy on the grass")
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertIn('"thingummy" is a label of the project', process.stderr)
        process = self.edit(*words, "--at", "0.01,0.01")
        self.assert_one_sentence(process, "nothing is seen at", "gseditpro render")
        process = self.edit(*words, "--at", "0.5")
        self.assert_one_sentence(process, '--at "0.5" is no place', "give X,Y")
        process = self.edit(*words, "--at", "0.5,0.5", "--the-thing")
        self.assert_one_sentence(process, "--at and --the-thing", "leave one of them out")

    def test_another_word_for_a_known_one_leads_to_it(self):
        process = self.edit("--source", "bruin", "--prompt", "a golden bruin on the grass")
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertIn('Looks for "bear": "bruin" is another word for it', process.stderr)

    def test_the_pictures_say_which_word_is_new(self):
        scene = self.folder / "hat.ply"
        process = run_laboratory("-q", "synth", scene, "--object", "bear", "--material", "red", "--accessory",
                                 "hat", "--ground", "snow")
        self.assertEqual(process.returncode, 0, process.stderr)
        # By the words alone the hat would be it; the scene shows one.
        process = run("locate", scene, "--out", self.folder / "out", *LOOK, "--source", "bear", "--prompt",
                      "a golden bear wearing a hat on the snow")
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertIn('new in the sentence: "golden"', process.stderr)
        self.assertIn("mode modify", process.stderr)

    def test_another_unknown_word_only_warns(self):
        process = run("locate", BEAR, "--out", self.folder / "out", *LOOK, "--source", "bear", "--prompt",
                      "a blue bear beside a lantern")
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertIn('"lantern"', process.stderr)

    def test_a_label_by_hand_needs_no_known_word(self):
        found = self.folder / "found"
        process = run("-q", "locate", BEAR, "--out", found, *LOOK, "--source", "bear", "--prompt",
                      "a golden bear")
        self.assertEqual(process.returncode, 0, process.stderr)
        process = run("-q", "edit", found / "source.ply", "--use-label", "--out", self.folder / "out", *QUICK,
                      "--source",
                      "thingummy", "--prompt", "a golden thingummy on the grass", "--target", "golden")
        self.assertEqual(process.returncode, 0, process.stderr)
        report = json.loads((self.folder / "out/report.json").read_text())
        before = columns(found / "source.ply", "label", "f_dc_1")
        self.assertEqual(report["labelled"], sum(before["label"]))
        self.assertEqual(report["changed_outside_label"], 0)
        self.assertIsNone(report["confidence"])   # nothing was looked for
        after = columns(self.folder / "out/source.ply", "label")
        self.assertEqual(after["label"], before["label"])
        # What was red turns golden: it is the green that golden has more of.
        edited = columns(self.folder / "out/scene.ply", "f_dc_1")["f_dc_1"]
        rows = [row for row, bit in enumerate(before["label"]) if bit]
        green = [sum(values[row] for row in rows) / len(rows) for values in (before["f_dc_1"], edited)]
        self.assertGreater(green[1], green[0] + 0.3)

    def test_use_label_needs_a_label(self):
        process = self.edit("--use-label", "--source", "sign", "--prompt", "a golden sign", "--target",
                            "golden")
        self.assert_one_sentence(process, "labelled", "label")

    def test_every_search_has_its_confidence(self):
        process = run("locate", BEAR, "--out", self.folder / "out", *LOOK, "--source", "bear", "--prompt",
                      "a golden bear")
        self.assertEqual(process.returncode, 0, process.stderr)
        report = json.loads((self.folder / "out/report.json").read_text())
        recipe = json.loads((self.folder / "out/recipe.json").read_text())
        self.assertGreater(report["confidence"], recipe["request"]["least_confidence"])
        for part in ("agreement", "attention_inside", "labelled_share"):
            self.assertTrue(0 < report["confidence_of"][part] <= 1, part)
        self.assertIn(f"confidence {report['confidence']:.2f}", process.stdout)

    def test_a_word_the_scene_does_not_show_labels_nothing_and_leaves_its_evidence(self):
        process = run("locate", BEAR, "--out", self.folder / "out", *LOOK, "--source", "car", "--prompt",
                      "a golden car",
                      "--least-confidence", 0.99)
        self.assert_one_sentence(process, '"car"', "confidence", "0.99")
        report = json.loads((self.folder / "out/report.json").read_text())
        self.assertEqual(report["labelled"], 0)
        self.assertIn("car", report["problem"])
        self.assertEqual(sum(columns(self.folder / "out/source.ply", "label")["label"]), 0)
        index = json.loads((self.folder / "out/evidence/index.json").read_text())
        self.assertEqual(len(index), 6)
        self.assertTrue(all((self.folder / f"out/evidence/view_{view:03}_attention.png").is_file()
                            for view in range(6)))

    def test_an_edit_that_finds_nothing_keeps_earlier_results_and_shows_what_it_saw(self):
        out = self.folder / "out"
        out.mkdir()
        (out / "notes.txt").write_bytes(b"earlier")
        process = self.edit("--source", "car", "--prompt", "a golden car", "--target", "golden",
                            "--least-confidence", 0.99)
        self.assert_one_sentence(process, '"car"', "out.search")
        self.assertEqual((out / "notes.txt").read_bytes(), b"earlier")
        self.assertEqual([path.name for path in out.iterdir()], ["notes.txt"])
        index = json.loads((self.folder / "out.search/evidence/index.json").read_text())
        self.assertEqual(len(index), 6)

    def test_the_view_says_where_its_search_failed(self):
        process = run("locate", BEAR, "--out", self.folder / "out", *LOOK, "--source", "bear", "--prompt",
                      "a golden bear",
                      "--attention-threshold", 0.999, "--dbscan-min-samples", 100)
        line = self.assert_one_sentence(process, '"bear" was found in only', "lower the attention threshold")
        self.assertNotIn("--", line.split("gseditpro: ")[1])
        index = json.loads((self.folder / "out/evidence/index.json").read_text())
        self.assertTrue(any("threshold" in view.get("step", "") for view in index))

    def test_a_sentence_too_long_is_said_where_it_is_cut(self):
        long = "a bear on the grass " + "with a tree and a house " * 5
        process = run("locate", BEAR, "--out", self.folder / "out", *LOOK, "--source", "bear", "--target",
                      "bear", "--prompt", long)
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertIn("reads 30 words", process.stderr)
        process = self.edit("--source", "bear", "--prompt", long + "wearing a crown", "--target", "crown")
        self.assert_one_sentence(process, "30 words", '"crown"', "shorten the sentence")

    def test_bench_locate_measures_a_point_per_setting(self):
        out = self.folder / "locate"
        process = run_laboratory("-q", "bench", "locate", "--scenes", 1, "--kinds", "recolour", "--views", 6,
                                 "--repeats", "", "--levels", "0.3 0.6",
                      "--img2img", "", "--no-parts", "--out", out)
        self.assertEqual(process.returncode, 0, process.stderr)
        points = {point["name"]: point for point in json.loads((out / "locate.json").read_text())["points"]}
        self.assertEqual(set(points), {"as set", "6", "0.3 0.6"})
        for point in points.values():
            self.assertTrue(0 <= point["iou"] <= 1)
            self.assertGreater(point["processor_seconds"], 0)
        self.assertLess(points["6"]["unet"], points["as set"]["unet"])
        self.assertLess(points["as set"]["unet"], points["0.3 0.6"]["unet"])
        self.assertTrue((out / "locate.png").read_bytes().startswith(b"\x89PNG"))
        self.assert_one_sentence(run_laboratory("-q", "bench", "locate", "--scenes", 1, "--kinds", "add",
                                                "--out", self.folder / "none"), "added")
        self.assert_one_sentence(run_laboratory("-q", "bench", "locate", "--scenes", 1, "--levels", "2",
                                                "--out", self.folder / "none"), "levels")
        self.assertFalse((self.folder / "none").exists())


if __name__ == "__main__":
    unittest.main()
