"""bench: every setting of a subject measured over generated scenes, as figures, a picture and a page."""
import json
import re
import unittest

from program import ProgramTest, run_laboratory


class Benches(ProgramTest):
    def subject(self, name, *arguments):
        out = self.folder / name
        process = run_laboratory("-q", "bench", name, "--out", out, *arguments)
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertTrue((out / f"{name}.png").read_bytes().startswith(b"\x89PNG"))
        report = json.loads((out / f"{name}.json").read_text())
        self.assertEqual(set(report["files"]), {f"{name}.png"})
        return process, report

    def test_raster_measures_every_kernel(self):
        process, report = self.subject("raster", "--splats", 300, "--width", 48, "--height", 48, "--views", 1,
                                       "--repetitions", 1)
        self.assertIn("default", process.stdout)
        self.assertEqual(sum(point["default"] for point in report["points"]), 1)
        self.assertIn("scalar", {point["curve"] for point in report["points"]})
        for front in report["fronts"]:
            self.assertTrue(front["front"])

    def test_stability_counts_every_picture(self):
        process, report = self.subject("stability", "--scenes", 1, "--causes", "needles, few pixels")
        self.assertEqual([cause["cause"] for cause in report["causes"]], ["needles", "few pixels"])
        self.assertIn("0 with a value that is not finite; 0 in which", process.stdout)
        out = self.folder / "none"
        self.assert_one_sentence(run_laboratory("-q", "bench", "stability", "--causes", "weather", "--out",
                                                out), "weather")
        self.assertFalse(out.exists())

    def test_preview_measures_qualities(self):
        _, report = self.subject("preview", "--backend", "native", "--splats", 300, "--size", "64x48",
                                 "--frames", 2,
                                 "--sh-degrees", "0", "--scales", "0.5")
        errors = {point["name"]: point["rms_error"] for point in report["points"]}
        self.assertEqual(set(errors), {"full", "SH 0", "antialiased", "size 0.5", "SH 0, size 0.5"})
        for name in ("full", "antialiased"):
            self.assertLess(errors[name], 1e-3, name)
        for name in ("SH 0", "size 0.5", "SH 0, size 0.5"):
            self.assertGreater(errors[name], 10 * errors["full"], name)

    def test_scale_stops_at_its_limits(self):
        process, report = self.subject("scale", "--no-search", "--splats", "1000 20000000", "--sizes",
                                       "16 32", "--views", "3 6",
                                       "--shares", "1", "--usual-splats", 200, "--usual-size", 32,
                                       "--repetitions", 1,
                                       "--limit-seconds", 0.5)   # 20,000 times the first point
        series = {entry["of"]: entry for entry in report["series"]}
        self.assertEqual(series["splats"]["left_out"], [20000000])
        self.assertIn("20,000,000", process.stdout)
        self.assertEqual([size for size, _ in series["side"]["costs"][0]["points"]], [16, 32])

    def test_eval_measures_ways_to_use_a_server_as_bench_server_does(self):
        quick = ["--side", 64, "--seeds", 1]
        tables = []
        for name, command in (("bench", ["bench", "server"]), ("eval", ["eval", "--server"])):
            out = self.folder / f"{name}.json"
            process = run_laboratory("-q", *command, *quick, "--out", out)
            self.assertEqual(process.returncode, 0, process.stderr)
            rows = json.loads(out.read_text())
            for row in rows:
                self.assertIn(row["agreement"], process.stdout)
                self.assertGreater(row.pop("seconds"), 0)
            tables.append(rows)
        self.assertEqual(tables[0], tables[1])
        self.assertGreater(len(tables[0]), 3)
        refused = run_laboratory("-q", "eval", "--server", "--edits", 2)
        self.assert_one_sentence(refused, "--edits", "--server")
        refused = run_laboratory("-q", "eval", "--hue", 20)
        self.assert_one_sentence(refused, "--hue", "--server")

    def test_locate_keeps_the_error_of_every_scene(self):
        _, report = self.subject("locate", "--scenes", 2, "--views", "6", "--repeats", "", "--levels", "",
                                 "--img2img", "", "--no-parts")
        self.assertEqual([point["name"] for point in report["points"]], ["as set", "6"])
        for point in report["points"]:
            errors = point["per_case"]["error"]
            self.assertEqual(len(errors), 2)
            self.assertAlmostEqual(sum(errors) / 2, point["error"])

    def test_all_leaves_a_page_that_needs_nothing_else(self):
        out = self.folder / "all"
        process = run_laboratory("-q", "bench", "all", "--subjects", "raster", "--raster-splats", 300,
                                 "--out", out)
        self.assertEqual(process.returncode, 0, process.stderr)
        page = (out / "index.html").read_text()
        self.assertEqual(len(re.findall(r'<img [^>]*src="data:image/png;base64,[A-Za-z0-9+/]+=*">', page)), 1)
        self.assertNotRegex(page, r"https?:|href|url\(|<script|<link")
        self.assertIn("splats 300 instead of", page)
        machine = json.loads((out / "all.json").read_text())["machine"]
        self.assertGreater(machine["cores"], 0)
        self.assertIn(machine["processor"], page)

    def test_wrong_settings_leave_nothing(self):
        out = self.folder / "none"
        self.assert_one_sentence(run_laboratory("-q", "bench", "raster", "--kernels", "sse", "--splats", 10,
                                                "--out", out), "sse")
        self.assert_one_sentence(run_laboratory("-q", "bench", "scale", "--sizes", "big", "--out", out),
                                 "sizes", "big")
        self.assert_one_sentence(run_laboratory("-q", "bench", "all", "--subjects", "weather", "--out", out),
                                 "weather")
        self.assertFalse(out.exists())


if __name__ == "__main__":
    unittest.main()
