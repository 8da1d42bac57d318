"""Scenes of any size: the same picture, the same search, the same edit."""
import json
import math
import pathlib
import struct
import unittest
import zlib

from program import ProgramTest, grid_rows, ply_bytes, run

ASSETS = pathlib.Path(__file__).resolve().parents[2] / "assets"
MODEL = ASSETS / "models/starter"
SCALES = [1e-3, 1e-2, 1e3, 1e4]


def scaled_scene(path, factor):
    """The bytes of a binary PLY of floats, that many times as large."""
    header, body = path.read_bytes().split(b"end_header\n", 1)
    names = [line.split()[2].decode() for line in header.splitlines() if line.startswith(b"property float ")]
    stride = 4 * len(names)
    rows = []
    for begin in range(0, len(body), stride):
        row = list(struct.unpack(f"<{len(names)}f", body[begin:begin + stride]))
        for at, name in enumerate(names):
            if name in ("x", "y", "z"):
                row[at] *= factor
            elif name.startswith("scale_"):
                row[at] += math.log(factor)
        rows.append(struct.pack(f"<{len(names)}f", *row))
    return header + b"end_header\n" + b"".join(rows)


def png_pixels(path):
    """Bytes of an 8-bit RGB or RGBA picture without interlacing, filters undone, and the channels."""
    data, at, packed = path.read_bytes(), 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        chunk = data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            width, height, depth, colour = struct.unpack(">IIBB", chunk[:10])
            assert depth == 8 and colour in (2, 6)
        if kind == b"IDAT":
            packed += chunk
        at += length + 12
    channels = 3 if colour == 2 else 4
    raw, stride = zlib.decompress(packed), width * channels
    above, pixels = bytearray(stride), bytearray()
    for y in range(height):
        filter_type, line = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for x in range(stride):
            left = line[x - channels] if x >= channels else 0
            corner = above[x - channels] if x >= channels else 0
            if filter_type == 4:
                guess = left + above[x] - corner
                line[x] = (line[x] + min((left, above[x], corner), key=lambda v: abs(guess - v))) & 255
            else:
                line[x] = (line[x] + (0, left, above[x], (left + above[x]) // 2)[filter_type]) & 255
        pixels += line
        above = line
    return pixels


class Scale(ProgramTest):
    def rendered(self, scene):
        process = run("render", scene, self.folder / "picture.png", "--width", 160, "--height", 120)
        self.assertEqual(process.returncode, 0, process.stderr)
        return png_pixels(self.folder / "picture.png")

    def bear(self, factor):
        return self.write(f"bear_{factor}.ply", scaled_scene(ASSETS / "scenes/bear/scene.ply", factor))

    def test_the_same_picture(self):
        truth = self.rendered(self.bear(1))
        self.assertGreater(sum(truth) / len(truth), 10)
        for factor in SCALES:
            picture = self.rendered(self.bear(factor))
            difference = sum(abs(a - b) for a, b in zip(truth, picture)) / len(truth)
            self.assertLess(difference, 0.5, f"scaled by {factor}")   # of 255

    def test_one_splat_and_all_in_one_place(self):
        row = list(grid_rows(1)[0])
        for size in (1e-4, 1, 1e3):
            row[10] = row[11] = row[12] = math.log(size)
            for count in (1, 300):
                pixels = self.rendered(self.write("one.ply", ply_bytes([row] * count)))
                middle = (60 * 160 + 80) * 3
                self.assertGreater(max(pixels[middle:middle + 3]), 100, f"{count} splats of {size}")

    @unittest.skipUnless((MODEL / "model_index.json").exists(), "[skip] the starter model is not there")
    def test_the_same_search_and_edit(self):
        reports = []
        for factor in (1, 1e-2, 1e4):
            out = self.folder / f"out_{factor}"
            process = run("-q", "edit", self.bear(factor), "--source", "bear", "--prompt",
                          "a blue bear on the grass", "--target",
                          "blue", "--out", out, "--views", 6, "--image-size", 64, "--attention-repeats", 1,
                          "--iterations", 20,
                          "--turntable-frames", 3, "--turntable-size", 64, "--no-gate")
            self.assertEqual(process.returncode, 0, process.stderr)
            report = json.loads((out / "report.json").read_text())
            self.assertEqual(report["changed_outside_label"], 0)
            reports.append((report, png_pixels(out / "before_after.png")))
        first, picture = reports[0]
        self.assertGreater(first["labelled"], 300)
        for report, other in reports[1:]:
            self.assertAlmostEqual(report["labelled"] / first["labelled"], 1, delta=0.03)
            self.assertLess(sum(abs(a - b) for a, b in zip(picture, other)) / len(picture), 3)


if __name__ == "__main__":
    unittest.main()
