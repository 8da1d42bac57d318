"""Sentences with several changes, with none, and with some that no edit makes."""
import json
import pathlib
import unittest

from program import SHARED, ProgramTest, run

ASSETS = pathlib.Path(__file__).resolve().parents[2] / "assets"
QUICK = ["--turntable-frames", 3, "--turntable-size", 64]


@unittest.skipUnless((ASSETS / "models/starter/model_index.json").exists(), "[skip] the starter is not there")
class Steps(ProgramTest):
    def edit(self, prompt, *arguments):
        self.out = self.folder / "out"
        return run("-q", "edit", ASSETS / "scenes/bear/scene.ply", "--source", "bear", "--prompt", prompt,
                   "--out", self.out, *QUICK, *arguments)

    def report(self):
        return json.loads((self.out / "report.json").read_text())

    def test_two_changes_are_two_edits_of_one_project(self):
        process = self.edit("a blue bear wearing a yellow hat on the grass")
        self.assertEqual(process.returncode, 0, process.stderr)
        report = self.report()
        self.assertEqual(report["done"], 2)
        self.assertEqual(report["plan"], "recolour(bear, blue) ; add(hat{yellow}, worn by, bear)")
        for step in report["steps"]:
            self.assertTrue(step["done"])
            self.assertEqual(step["report"]["changed_outside_label"], 0)
            self.assertTrue(step["report"]["judgement"]["passed"], step["report"]["judgement"])
        self.assertGreater(report["steps"][1]["report"]["added"], 0)
        listing = run("project", self.out / "edit.gsep", "--json")
        self.assertEqual(listing.returncode, 0, listing.stderr)
        self.assertEqual([edit["name"] for edit in json.loads(listing.stdout)["edits"]],
                         ["a blue bear on the grass", "a blue bear wearing a yellow hat on the grass"])
        exported = self.folder / "exported.ply"
        self.assertEqual(run("project", self.out / "edit.gsep", "--export", exported).returncode, 0)
        self.assertEqual(self.info(exported)["splats"], self.info(self.out / "scene.ply")["splats"])
        self.assertEqual(self.info(self.out / "scene.ply")["splats"], report["steps"][1]["report"]["splats"])

    def test_a_step_that_cannot_be_done_stops_all_of_them(self):
        process = self.edit("make the bear golden and make it smile")
        self.assertEqual(process.returncode, 2)
        self.assertIn("step 2 of 2", process.stderr)
        self.assertIn("--partly", process.stderr)
        self.assertFalse(self.out.exists())

    def test_a_part_is_done_where_that_is_asked_for(self):
        process = self.edit("make the bear golden and make it smile", "--partly")
        self.assertEqual(process.returncode, 3, process.stderr)
        report = self.report()
        self.assertEqual([step["done"] for step in report["steps"]], [True, False])
        self.assertIn("poses", report["steps"][1]["reason"])

    def test_a_word_that_the_model_does_not_know_stops_before_the_first_step(self):
        sentence = "make the bear blue and put a unicorn beside it"
        process = self.edit(sentence)
        self.assertEqual(process.returncode, 2)
        self.assertIn("step 2 of 2", process.stderr)
        self.assertIn("unicorn", process.stderr)
        self.assertFalse(self.out.exists())
        plan = run("plan", "--source", "bear", "--words", "red bear; grass", "--prompt", sentence)
        self.assertEqual(plan.returncode, 0, plan.stderr)
        self.assertIn("1 colour: bear, blue\n2 add: unicorn", plan.stdout)
        self.assertIn("cannot be done: the model does not know the word \"unicorn\"", plan.stdout)
        plan = run("plan", "--source", "bear", "--prompt", sentence, "--json")
        first, second = json.loads(plan.stdout)["steps"]
        self.assertEqual(first["prompt"], "a blue bear")
        self.assertIn("unicorn", second["reason"])

    def test_an_order_or_a_telegram_is_told_as_a_caption(self):
        for prompt in ["blue bear", "not red but blue"]:
            process = self.edit(prompt, "--quality", "draft")
            self.assertEqual(process.returncode, 0, process.stderr)
            recipe = json.loads((self.out / "recipe.json").read_text())
            self.assertEqual(recipe["request"]["prompt"], "a blue bear", prompt)

    # Edits that change next to nothing: so few optimisation steps move no colour far.
    FAILING = ["--fit-steps", 1, "--rounds", 1]

    def test_a_change_that_failed_is_written_and_said(self):
        process = self.edit("a blue bear on the grass", *self.FAILING)
        self.assertEqual(process.returncode, 3, process.stderr)
        self.assertIn("of the bear changed visibly", process.stderr)
        judgement = self.report()["judgement"]
        self.assertFalse(judgement["passed"])
        self.assertIn(judgement["reason"], process.stderr)
        self.assertIn(judgement["remedy"], process.stderr)
        self.assertTrue((self.out / "scene.ply").exists())
        process = self.edit("a blue bear on the grass", *self.FAILING, "--keep-failed")
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertFalse(self.report()["judgement"]["passed"])

    def test_one_more_of_the_same_leaves_a_project(self):
        process = self.edit("another bear, a green one, next to it", "--quality", "draft")
        self.assertIn(process.returncode, [0, 3], process.stderr)   # drawn well or not
        self.assertNotIn("leaves it out", process.stderr)   # "beside" is read from the sentence
        listing = run("project", self.out / "edit.gsep", "--json")
        self.assertEqual(listing.returncode, 0, listing.stderr)
        self.assertEqual(len(json.loads(listing.stdout)["edits"]), 1)

    def test_a_step_that_failed_is_kept_out_and_the_next_goes_on_without_it(self):
        process = self.edit("a blue bear wearing a yellow hat on the grass", *self.FAILING)
        self.assertEqual(process.returncode, 3, process.stderr)
        report = self.report()
        self.assertEqual([step["done"] for step in report["steps"]], [False, True])
        self.assertEqual(report["steps"][0]["reason"], report["steps"][0]["report"]["judgement"]["reason"])
        self.assertTrue(report["steps"][1]["report"]["judgement"]["passed"])
        self.assertNotIn("blue", report["steps"][1]["prompt"])   # the bear is as red as it was
        self.assertTrue((self.out / "1/scene.ply").exists())
        listing = json.loads(run("project", self.out / "edit.gsep", "--json").stdout)
        self.assertEqual(len(listing["edits"]), 1)
        self.assertIn("hat", listing["edits"][0]["name"])
        process = self.edit("a blue bear wearing a yellow hat on the grass", *self.FAILING, "--keep-failed")
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertEqual([step["done"] for step in self.report()["steps"]], [True, True])

    def test_nothing_to_change_changes_nothing(self):
        for prompt in ["a red bear on the grass", "a bear without a hat", "leave the bear as it is"]:
            process = self.edit(prompt, "--words", "red bear; grass")
            self.assertEqual(process.returncode, 0, process.stderr)
            self.assertIn("Nothing to change", process.stdout)
            self.assertFalse(self.out.exists())

    def test_a_part_that_the_shape_tells_changes_and_another_is_refused(self):
        process = self.edit("paint the bear's head blue")
        self.assertEqual(process.returncode, 0, process.stderr)
        report = self.report()
        self.assertEqual(report["changed_outside_label"], 0)
        self.assertGreater(report["labelled"], 0)
        self.assertLess(report["labelled"], report["splats"] / 3)
        process = self.edit("paint the bear's ears blue")
        self.assertEqual(process.returncode, 2)
        self.assertIn("no word for the part \"ears\"", process.stderr)

    @unittest.skipUnless((SHARED / "goldens/unet_sd1").is_dir(), "[skip] the small networks are not there")
    def test_a_whole_scene_is_changed_by_a_model_of_an_open_vocabulary_alone(self):
        process = self.edit("turn the scene into a watercolor")
        self.assertEqual(process.returncode, 2)
        self.assertIn("Stable Diffusion", process.stderr)
        goldens, model = SHARED.resolve() / "goldens", self.folder / "model"
        model.mkdir()
        for name, case in [("unet", "unet_sd1"), ("vae", "vae"), ("text_encoder", "clip_text_sd1"),
                           ("tokenizer", "pipeline_sd1/tokenizer"), ("scheduler", "pipeline_sd1/scheduler")]:
            (model / name).symlink_to(goldens / case)
        (model / "model_index.json").write_text("{}")
        process = self.edit("turn the scene into a watercolor", "--model", model, "--method", "views",
                            "--image-size", 64, "--views", 4, "--edited-views", 4, "--fit-steps", 10,
                            "--rounds", 1)
        self.assertEqual(process.returncode, 0, process.stderr)
        report = self.report()
        self.assertEqual(report["labelled"], report["splats_before"])
        recipe = json.loads((self.out / "recipe.json").read_text())
        self.assertTrue(recipe["request"]["whole_scene"])

    def test_what_is_removed_is_gone_and_its_place_is_healed(self):
        process = self.edit("remove the bear")
        self.assertEqual(process.returncode, 0, process.stderr)
        report = self.report()
        self.assertEqual(report["mode"], "remove")
        self.assertGreaterEqual(report["removed"], report["labelled"])
        self.assertEqual(report["changed_outside_label"], 0)
        self.assertEqual(self.info(self.out / "scene.ply")["splats"], report["splats"])
        plain = run("-q", "edit", "--recipe", self.out / "recipe.json", "--no-heal",
                    "--out", self.folder / "plain")
        self.assertEqual(plain.returncode, 0, plain.stderr)
        deleted = json.loads((self.folder / "plain/report.json").read_text())
        self.assertEqual((deleted["added"], deleted["removed"]), (0, deleted["labelled"]))

    def test_what_is_moved_keeps_its_splats(self):
        process = self.edit("make the bear blue and twice as big", "--quality", "draft")
        self.assertEqual(process.returncode, 0, process.stderr)
        bigger = self.report()["steps"][1]["report"]
        self.assertEqual(bigger["mode"], "transform")
        self.assertGreaterEqual(bigger["splats"], bigger["labelled"])
        self.assertEqual(bigger["changed_outside_label"], 0)
        process = self.edit("two bears")
        self.assertEqual(process.returncode, 0, process.stderr)
        report = self.report()
        self.assertGreaterEqual(report["added"], report["labelled"])

    def test_a_change_of_place_needs_to_be_said(self):
        scene = ASSETS / "scenes/bear/scene.ply"
        for arguments, word in [((), "nothing says how"), (("--change", "sideways"), "no change of place"),
                                (("--change", "swap with"), "another thing"),
                                (("--change", "bigger", "--anchor", "statue"), "no other thing")]:
            process = run("-q", "edit", scene, "--source", "bear", "--mode", "transform", *arguments,
                          "--out", self.folder / "none")
            self.assertEqual(process.returncode, 2, arguments)
            self.assertIn(word, process.stderr)
            self.assertEqual(len(process.stderr.strip().splitlines()), 1, process.stderr)

    def test_what_is_no_edit_is_refused_in_one_sentence(self):
        for prompt, word in [("make the bear smile", "poses"), ("ein blauer Bär auf dem Gras", "English"),
                             ("undo", "no change")]:
            process = self.edit(prompt)
            self.assertEqual(process.returncode, 2, prompt)
            self.assertIn(word, process.stderr)
            self.assertEqual(len(process.stderr.strip().splitlines()), 1, process.stderr)
            self.assertFalse(self.out.exists())


if __name__ == "__main__":
    unittest.main()
