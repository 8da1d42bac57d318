"""info, convert, render, turntable, synth and bench do what their help says."""
import gzip
import json
import os
import re
import struct
import subprocess
import unittest

from program import PROGRAM, SHARED, ProgramTest, grid_rows, ply_bytes, run, run_laboratory

LABORATORY_COMMANDS = ["bench", "eval", "synth", "train-starter"]


class Commands(ProgramTest):
    def test_version_and_help(self):
        self.assertRegex(run("--version").stdout, r"gseditpro \d+\.\d+")
        self.assertRegex(run_laboratory("--version").stdout, r"gseditpro-lab \d+\.\d+")
        artist = ["info", "convert", "adjust", "cameras", "render", "turntable", "locate", "edit", "project",
                  "merge", "transform"]
        for start, command in [(run, name) for name in artist] + [(run_laboratory, name)
                                                                  for name in LABORATORY_COMMANDS]:
            process = start(command, "--help")
            self.assertEqual(process.returncode, 0)
            lines = process.stdout.splitlines()
            for line, following in zip(lines, lines[1:] + [""]):
                if not line.startswith("  --"):
                    continue
                # Every option says what it does, beside a short name or under a long one.
                text = line.split() if len(line.split()) > 2 else following.split()
                self.assertGreater(len(text), 2, f"{command}: {line}")

    def test_the_laboratory_is_another_program(self):
        listed = run("--help").stdout
        for command in LABORATORY_COMMANDS:
            self.assertNotRegex(listed, rf"(?m)^ +{command} ")
            self.assertRegex(run_laboratory("--help").stdout, rf"(?m)^ +{command} ")
            for arguments in [], ["--help"], ["raster", "--seed", "1", "-q"]:
                process = run(command, *arguments)
                self.assert_one_sentence(process, f"gseditpro-lab {command}")
                self.assertEqual((process.returncode, process.stdout), (2, ""))

    def test_options_of_earlier_versions_are_taken_and_hidden(self):
        process = run("edit", "--polish-steps", 20, "--help")
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertNotIn("polish", process.stdout)
        process = run("edit", "missing.ply", "--polish-steps", 20, "--source", "bear", "--prompt",
                      "a red bear")
        self.assertIn("polish_steps", process.stderr)
        self.assertIn("ignored", process.stderr)

    def test_starting_loads_neither_networks_nor_codecs(self):
        linked = subprocess.run([PROGRAM], env={**os.environ, "LD_TRACE_LOADED_OBJECTS": "1"},
                                capture_output=True, text=True).stdout
        self.assertIn("libc.so", linked)
        for library in ["torch", "gomp", "opencv_imgcodecs", "opencv_videoio", "avcodec", "gdal"]:
            self.assertNotIn(f"lib{library}", linked)

    def test_info_counts_and_lints(self):
        rows = grid_rows(4)
        rows[0] = (float("nan"),) + rows[0][1:]
        rows[1] = rows[1][:13] + (0, 0, 0, 0)
        rows[2] = rows[2][:9] + (-20.0,) + rows[2][10:]
        found = self.info(self.write("scene.ply", ply_bytes(rows)))
        self.assertEqual(found["splats"], 64)
        self.assertEqual(found["lint"]["nan"], 1)
        self.assertEqual(found["lint"]["zero_quaternion"], 1)
        self.assertEqual(found["lint"]["invisible"], 1)

    def test_convert_there_and_back(self):
        source = self.write("scene.ply", ply_bytes(grid_rows()))
        for name, *options in [("a.compressed.ply",), ("b.splat",), ("c.spz",), ("d.sog",),
                               ("e.spz", "--spz-version", 4), ("f.spz", "--spz-version", 2)]:
            process = run("convert", source, self.folder / name, *options)
            self.assertEqual(process.returncode, 0, process.stderr)
            self.assertEqual(self.info(self.folder / name)["splats"], 216)
        process = run("convert", source, self.folder / "copy.ply")
        self.assertEqual(process.returncode, 0, process.stderr)
        body = lambda path: path.read_bytes().split(b"end_header\n", 1)[1]
        self.assertEqual(body(self.folder / "copy.ply"), body(source))

    def test_large_coordinates_and_further_columns_stay(self):
        kinds = ["double x", "double y", "double z", "float f_dc_0", "float f_dc_1", "float f_dc_2",
                 "float opacity", "float scale_0", "float scale_1", "float scale_2", "float rot_0",
                 "float rot_1", "float rot_2", "float rot_3", "int object_id"]
        header = "ply\nformat binary_little_endian 1.0\nelement vertex 216\n"
        header += "".join(f"property {kind}\n" for kind in kinds) + "end_header\n"
        rows = [(x + 455123, y + 5410987, z + 321, *rest, 7000000 + number)
                for number, (x, y, z, _, _, _, *rest) in enumerate(grid_rows())]
        body = b"".join(struct.pack("<3d11fi", *row) for row in rows)
        source = self.write("far.ply", header.encode() + body)
        found = self.info(source)
        self.assertEqual(found["columns"], ["object_id"])
        self.assertEqual(found["offset"], [455123, 5410987, 321])
        self.assertAlmostEqual(found["bounds"]["high"][1], 5410987.5, places=6)
        process = run("convert", source, self.folder / "again.ply")
        self.assertEqual(process.returncode, 0, process.stderr)
        text, body = (self.folder / "again.ply").read_bytes().split(b"end_header\n", 1)
        self.assertIn(b"property int object_id", text)
        for row, (x, y, z, *_, number) in zip(rows, struct.iter_unpack("<3d14fi", body)):
            self.assertEqual(number, row[-1])
            for one, other in zip(row[:3], (x, y, z)):
                self.assertAlmostEqual(one, other, places=6)
        process = run("convert", source, self.folder / "again.spz")
        self.assertIn("object_id", process.stderr)
        self.assertIn("less the offset (455123, 5410987, 321)", process.stderr)

    def test_activated_values_are_noticed_and_read_as_such_on_request(self):
        rows = [(*row[:9], 0.95, 0.05, 0.05, 0.05 + number * 1e-4, *row[13:])
                for number, row in enumerate(grid_rows())]
        source = self.write("fog.ply", ply_bytes(rows))
        self.assertTrue(self.info(source)["looks_activated"])
        process = run("info", source, "--activated", "--json")
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertNotIn("looks_activated", json.loads(process.stdout))
        self.assertAlmostEqual(json.loads(process.stdout)["mean_opacity"], 0.95, places=4)
        process = run("convert", source, self.folder / "raw.ply", "--activated")
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertNotIn("looks_activated", self.info(self.folder / "raw.ply"))
        process = run("render", source, self.folder / "a.png", "--activated", "--width", 32, "--height", 32)
        self.assertEqual(process.returncode, 0, process.stderr)
        process = run("convert", self.folder / "raw.ply", self.folder / "b.ply", "--activated")
        self.assert_one_sentence(process, "not activated")

    def test_adjusted_colours_are_of_all_splats_or_of_the_label(self):
        source = self.write("scene.ply", ply_bytes(grid_rows()))
        body = lambda path: path.read_bytes().split(b"end_header\n", 1)[1]
        process = run("adjust", source, self.folder / "grey.ply", "--saturation", 0)
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertEqual(len(body(self.folder / "grey.ply")), len(body(source)))
        self.assertNotEqual(body(self.folder / "grey.ply"), body(source))
        self.assertEqual(run("adjust", source, self.folder / "same.ply").returncode, 0)
        self.assertEqual(body(self.folder / "same.ply"), body(source))
        self.assert_one_sentence(run("adjust", source, self.folder / "new.ply", "--use-label", "--hue", 20),
                                 "no label")
        self.assertIn("--saturation",
                      run("adjust", source, self.folder / "new.ply", "--saturation", 9).stderr)
        self.assert_one_sentence(run("adjust", source, source, "--hue", 20), "input itself")
        self.assertFalse((self.folder / "new.ply").exists())

    def test_spz_versions_are_written_as_asked(self):
        source = self.write("scene.ply", ply_bytes(grid_rows()))
        self.assertEqual(run("convert", source, self.folder / "new.spz", "--spz-version", 4).returncode, 0)
        self.assertEqual((self.folder / "new.spz").read_bytes()[:8], b"NGSP\4\0\0\0")
        for version in [2, 3]:
            self.assertEqual(run("convert", source, self.folder / "old.spz", "--spz-version",
                                 version).returncode, 0)
            raw = gzip.decompress((self.folder / "old.spz").read_bytes())
            self.assertEqual(raw[:8], b"NGSP" + bytes([version, 0, 0, 0]))
        for version in [1, 5, "four"]:
            self.assertNotEqual(run("convert", source, self.folder / "none.spz", "--spz-version",
                                    version).returncode, 0)
        self.assertFalse((self.folder / "none.spz").exists())

    def test_cameras_there_and_back_in_both_forms(self):
        source = self.write("scene.ply", ply_bytes(grid_rows()))
        self.assert_one_sentence(run("cameras", source, self.folder / "cameras.json"), "no cameras")
        process = run("cameras", source, self.folder / "cameras.json", "--orbit", 5)
        self.assertEqual(process.returncode, 0, process.stderr)
        first = json.loads((self.folder / "cameras.json").read_text())
        self.assertEqual(len(first), 5)
        for before, after in [("cameras.json", "transforms.json"), ("transforms.json", "again.cameras.json")]:
            process = run("cameras", self.folder / before, self.folder / after)
            self.assertEqual(process.returncode, 0, process.stderr)
        frames = json.loads((self.folder / "transforms.json").read_text())["frames"]
        self.assertEqual([frame["file_path"] for frame in frames], [camera["img_name"] for camera in first])
        again = json.loads((self.folder / "again.cameras.json").read_text())
        for one, other in zip(first, again):
            for key in ["position", "rotation"]:
                flat = lambda value: sum(value, []) if isinstance(value[0], list) else value
                for a, b in zip(flat(one[key]), flat(other[key])):
                    self.assertAlmostEqual(a, b, places=9)
        self.assert_one_sentence(run("cameras", source, self.folder / "cameras.txt", "--orbit", 5),
                                 "cameras.json")
        self.assertFalse((self.folder / "cameras.txt").exists())

    def test_info_tells_how_a_picture_was_made(self):
        source = self.write("scene.ply", ply_bytes(grid_rows()))
        self.assertEqual(run("render", source, self.folder / "a.png", "--width", 64, "--height",
                             48).returncode, 0)
        process = run("info", self.folder / "a.png")
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertIn("64 x 48", process.stdout)
        self.assertIn("GSEditPro", process.stdout)
        found = json.loads(run("info", self.folder / "a.png", "--json").stdout)
        self.assertEqual(json.loads(found["text"]["Recipe"])["width"], 64)
        self.assert_one_sentence(run("info", self.write("b.png", b"no picture")), "PNG")

    def test_synth_is_reproducible_and_labelled(self):
        for name in ["one.ply", "two.ply"]:
            process = run_laboratory("synth", self.folder / name, "--object", "bear", "--accessory", "hat",
                                     "--seed", 7)
            self.assertEqual(process.returncode, 0, process.stderr)
        self.assertEqual((self.folder / "one.ply").read_bytes(), (self.folder / "two.ply").read_bytes())
        self.assertTrue(self.info(self.folder / "one.ply")["labels"])
        process = run_laboratory("synth", self.folder / "edited.ply", "--object", "bear", "--seed", 7,
                                 "--edit", "a blue bear")
        self.assertIn("blue bear", process.stdout)

    def test_render_and_turntable(self):
        scene = self.write("scene.ply", ply_bytes(grid_rows()))
        process = run("render", scene, self.folder / "picture.png", "--width", 96, "--height", 64)
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertEqual((self.folder / "picture.png").read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
        process = run("turntable", scene, self.folder / "turn.mp4", "--width", 96, "--height", 64, "--frames",
                      6)
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertIn(b"ftyp", (self.folder / "turn.mp4").read_bytes()[:16])
        process = run("turntable", scene, self.folder / "frames", "--width", 96, "--height", 64, "--frames",
                      3)
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertEqual(len(list((self.folder / "frames").glob("*.png"))), 3)

    def test_bench_raster_prints_json(self):
        scene = self.write("scene.ply", ply_bytes(grid_rows()))
        process = run_laboratory("bench", "raster", scene, "--width", 64, "--height", 64, "--repetitions", 2)
        self.assertEqual(process.returncode, 0, process.stderr)
        figures = json.loads(process.stdout)
        for key in ["forward_ms", "backward_ms", "ns_per_pair", "peak_rss_mb"]:
            self.assertGreater(figures[key], 0, key)
        self.assertEqual([share["share"] for share in figures["skips"]["shares"]], [0.01, 0.05, 0.25, 1])
        for share in figures["skips"]["shares"]:
            self.assertGreater(share["ratio"], 0)
            self.assertEqual((share["picture_difference"], share["gradient_difference"]), (0, 0))

    def test_bench_speed_prints_the_readme_table(self):
        process = run_laboratory("bench", "speed", "--splats", 300, 500, "--views", 2, "--repetitions", 1,
                                 "--size", "64x48",
                      "--preview-size", "96x64", "--scenes-out", self.folder / "scenes", "--out",
                                 self.folder / "table.md")
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertEqual((self.folder / "table.md").read_text(), process.stdout)
        rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in process.stdout.splitlines()
                if line.startswith("| ")]
        self.assertEqual(rows[0],
                         ["what", "splats", "picture", "processor time", "error against double precision"])
        for splats in ["300", "500"]:
            for what, size in [("rasterizer, forward", "64 x 48"), ("rasterizer, backward", "64 x 48")]:
                row = next(row for row in rows if row[0] == what and row[1] == splats)
                self.assertEqual(row[2], size)
                self.assertRegex(row[3], r"^\d+ ms$")
            forward, backward = ([float(number) for number in re.findall(r"\d[\d.e+-]*", row[4])]
                                 for row in rows if row[0].startswith("rasterizer") and row[1] == splats)
            self.assertGreater(forward[0], 60)    # dB
            self.assertLess(backward[0], 1e-2)
        self.assertEqual(self.info(self.folder / "scenes/speed_300/scene.ply")["splats"], 300)
        self.assertEqual(len(json.loads((self.folder / "scenes/speed_300/cameras.json").read_text())), 2)

    def test_bench_speed_refuses_a_size_it_does_not_understand(self):
        self.assert_one_sentence(run_laboratory("bench", "speed", "--size", "64"), "size", "1280x720")

    @unittest.skipUnless((SHARED / "data/scenes").is_dir(), "[skip] the shared scenes are not there")
    def test_every_shared_scene_opens(self):
        scenes = [path for path in sorted((SHARED / "data/scenes").iterdir()) if path.is_file()
                  or path.name.endswith("sog")]
        self.assertGreater(len(scenes), 5)
        for path in scenes:
            if path.suffix == ".txt":
                continue
            with self.subTest(path.name):
                self.assertGreater(self.info(path)["splats"], 0)


if __name__ == "__main__":
    unittest.main()
