"""merge puts one scene into another: rows, label, place, and one sentence where that cannot be done."""
import struct
import unittest

from program import SHARED, ProgramTest, grid_rows, ply_bytes, run


def moved(rows, x, y, z):
    return [(row[0] + x, row[1] + y, row[2] + z) + row[3:] for row in rows]


def ground_rows(side=40):
    """A floor of 4 by 4 units, -y up."""
    return [(x * 0.1 - 2, 0, z * 0.1 - 2, 0, 0, 0, 0.5, -0.2, 0.1, 3.0, -3.0, -3.0, -3.0, 1, 0, 0, 0)
            for x in range(side) for z in range(side)]


class Merge(ProgramTest):
    def setUp(self):
        super().setUp()
        self.host = self.write("host.ply", ply_bytes(ground_rows()))
        self.guest = self.write("cube.part.ply", ply_bytes(moved(grid_rows(10), 7, 3, 5)))
        self.up = ["--up", "-y", "--up-b", "-y"]

    def merge(self, *arguments, out="both.ply"):
        return run("merge", self.host, self.guest, "--out", self.folder / out, *arguments)

    def rows(self, name="both.ply"):
        """Name of every column, and the rows."""
        data = (self.folder / name).read_bytes()
        head, body = data.split(b"end_header\n", 1)
        columns = [line.split()[1:] for line in head.decode().splitlines() if line.startswith("property")]
        kinds = {"float": "f", "double": "d", "uchar": "B"}
        shape = "<" + "".join(kinds[kind] for kind, _ in columns)
        names = [name for _, name in columns]
        return [dict(zip(names, row)) for row in struct.iter_unpack(shape, body)]

    def guest_bounds(self):
        """Lowest and highest x, y and z of the rows that the label marks."""
        labelled = [row for row in self.rows() if row["label"] > 0]
        self.assertEqual(len(labelled), 1000)
        return [(min(row[axis] for row in labelled), max(row[axis] for row in labelled)) for axis in "xyz"]

    def test_it_stands_on_the_ground_labelled_by_its_name(self):
        process = self.merge(*self.up)
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertIn("2600 splats", process.stdout)
        self.assertIn("cube: it stands on the ground", process.stderr)
        self.assertIn("cube", str(self.info(self.folder / "both.ply")))
        x, y, z = self.guest_bounds()
        self.assertLess(abs(y[1]), 0.02)                          # the foot, -y up
        self.assertAlmostEqual(y[1] - y[0], 0.9, places=3)        # its own size suits
        self.assertTrue(all(-2 < value < 2 for value in [*x, *z]))
        unlabelled = [(row["x"], row["y"], row["z"]) for row in self.rows() if row["label"] == 0]
        self.assertEqual(len(unlabelled), 1600)
        self.assertEqual(unlabelled, [struct.unpack("3f", struct.pack("3f", *row[:3]))
                                      for row in ground_rows()])

    def test_place_turn_and_size_are_as_given(self):
        process = self.merge(*self.up, "--at=-1,0.5,1.25", "--turn", 90, "--scale", 0.5, "--name", "box")
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertNotIn("stands", process.stderr)
        x, y, z = self.guest_bounds()
        for (low, high), middle in [(x, -1), (z, 1.25)]:
            self.assertAlmostEqual((low + high) / 2, middle, places=3)
            self.assertAlmostEqual(high - low, 0.45, places=3)
        self.assertAlmostEqual(y[1], 0.5, places=3)
        self.assertEqual(self.merge(*self.up, "--at", "-1,0.5,1.25", "--scale", 0.5).returncode, 0)

    def test_a_size_that_does_not_suit_is_told(self):
        large = [tuple(value * 1000 for value in row[:3]) + row[3:] for row in grid_rows(10)]
        self.guest.write_bytes(ply_bytes(large))
        process = self.merge(*self.up)
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertIn("a third as large", process.stderr)
        _, y, _ = self.guest_bounds()
        self.assertAlmostEqual(y[1] - y[0], 4 / 3, delta=0.1)

    def test_another_up_stands_upright(self):
        lying = [(row[0], -row[2], row[1] * 3) + row[3:] for row in grid_rows(10)]   # z is up, 1.35 high
        self.guest.write_bytes(ply_bytes(lying))
        process = self.merge("--up", "-y", "--up-b", "z")
        self.assertEqual(process.returncode, 0, process.stderr)
        _, y, _ = self.guest_bounds()
        self.assertAlmostEqual(y[1] - y[0], 3 * 0.9, places=3)

    def test_a_name_of_a_file_answers_to_its_thing(self):
        """A sentence says "guitar" where the label is named "object_guitar"."""
        guest = self.write("object_guitar.ply", self.guest.read_bytes())
        process = run("merge", self.host, guest, "--out", self.folder / "both.ply", *self.up)
        self.assertEqual(process.returncode, 0, process.stderr)
        process = run("edit", self.folder / "both.ply", "--source", "guitar", "--prompt",
                      "make the guitar smaller", "--out", self.folder / "small", "--turntable-frames", 0)
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertIn("1000 labelled", process.stderr + process.stdout)

    def test_formats_without_labels_and_with_view_dependent_colour(self):
        process = self.merge(*self.up, out="both.splat")
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertEqual(self.info(self.folder / "both.splat")["splats"], 2600)

    def test_world_coordinates_stay(self):
        """The scene's file lies far from the origin; places are given in its coordinates."""
        names = ["x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0",
                 "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"]
        far = moved(ground_rows(), 455000, 0, 5410000)
        head = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(far)}\n"
        head += "".join(f"property {'double' if name in 'xyz' else 'float'} {name}\n" for name in names)
        body = b"".join(struct.pack("<3d14f", *row) for row in far)
        self.host.write_bytes(head.encode() + b"end_header\n" + body)
        process = self.merge(*self.up, "--at", "455001,0,5410001")
        self.assertEqual(process.returncode, 0, process.stderr)
        x, y, z = self.guest_bounds()
        self.assertAlmostEqual(sum(x) / 2, 455001, delta=0.01)
        self.assertAlmostEqual(y[1], 0, delta=0.01)
        self.assertAlmostEqual(sum(z) / 2, 5410001, delta=0.01)

    def test_what_cannot_be_merged_is_said_in_a_sentence(self):
        self.assert_one_sentence(run("merge", self.host, self.folder / "none.ply", "--out",
                                     self.folder / "a.ply"), "none.ply")
        self.assert_one_sentence(run("merge", self.host, self.guest, "--out", self.host), "input itself")
        self.assert_one_sentence(run("merge", self.host, self.guest, "--out", self.guest), "input itself")
        faint = [row[:9] + (-20.0,) + row[10:] for row in grid_rows(3)]
        hidden = self.write("hidden.ply", ply_bytes(faint))
        self.assert_one_sentence(run("merge", self.host, hidden, "--out", self.folder / "a.ply"),
                                 "second scene can be seen")
        for wrong in ["--at=1,2", "--at=1,2,nan", "--at=1,2,x", "--scale=0", "--scale=-1", "--up-b=w",
                      "--turn=inf"]:
            process = run("merge", self.host, self.guest, "--out", self.folder / "a.ply", wrong)
            self.assertEqual(process.returncode, 2, wrong)
        self.assertEqual(self.folder_listing(), ["cube.part.ply", "hidden.ply", "host.ply"])

    def test_real_scenes(self):
        kitchen = SHARED / "data/scenes/room_kitchen.v2.spz"
        guitar = SHARED / "data/scenes/object_guitar.compressed.ply"
        if not kitchen.exists() or not guitar.exists():
            self.skipTest(f"[skip] {kitchen} is not there")
        process = run("merge", kitchen, guitar, "--out", self.folder / "both.ply")
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertIn("it stands on the ground near the middle", process.stderr)
        both = self.info(self.folder / "both.ply")["splats"]
        self.assertEqual(both, self.info(kitchen)["splats"] + self.info(guitar)["splats"])


if __name__ == "__main__":
    unittest.main()
