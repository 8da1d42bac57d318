"""transform moves, turns, resizes and copies the labelled thing; the rest keeps its bytes."""
import struct
import unittest

from program import ProgramTest, ply_bytes, run

NAMES = ["x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1",
         "scale_2", "rot_0", "rot_1", "rot_2", "rot_3", "label"]


def row(x, y, z, label):
    return (x, y, z, 0, 0, 0, 0.5, -0.2, 0.1, 3.0, -3.0, -3.0, -3.0, 1, 0, 0, 0, label)


def scene_rows():
    """A labelled box of 0.9 x 1.8 x 0.9 on a floor; -y up, the front looks along -z."""
    thing = [row(x * 0.1, -y * 0.2, z * 0.1, 1) for x in range(10) for y in range(10) for z in range(10)]
    return thing + [row(x * 0.1 - 4, 0.01, z * 0.1 - 4, 0) for x in range(80) for z in range(80)]


class Transform(ProgramTest):
    def setUp(self):
        super().setUp()
        self.scene = self.write("scene.ply", ply_bytes(scene_rows(), NAMES))

    def transform(self, *arguments):
        return run("transform", self.scene, self.folder / "out.ply", "--use-label", "--up", "-y", *arguments)

    def rows(self):
        data = (self.folder / "out.ply").read_bytes()
        head, body = data.split(b"end_header\n", 1)
        columns = [line.split()[1:] for line in head.decode().splitlines() if line.startswith("property")]
        shape = "<" + "".join({"float": "f", "double": "d", "uchar": "B"}[kind] for kind, _ in columns)
        names = [name for _, name in columns]
        return [dict(zip(names, values)) for values in struct.iter_unpack(shape, body)]

    def bounds_after(self, *arguments, count=1000):
        """Bounds of the labelled rows as (low, high) per axis; others must be where they were."""
        process = self.transform(*arguments)
        self.assertEqual(process.returncode, 0, process.stderr)
        rows = self.rows()
        floor = [(each["x"], each["y"], each["z"]) for each in rows if each["label"] == 0]
        self.assertEqual(floor, [struct.unpack("3f", struct.pack("3f", *each[:3]))
                                 for each in scene_rows()[1000:]])
        labelled = [each for each in rows if each["label"] > 0]
        self.assertEqual(len(labelled), count)
        return [(min(each[axis] for each in labelled), max(each[axis] for each in labelled))
                for axis in "xyz"]

    def test_sizes_change_about_the_foot(self):
        x, y, z = self.bounds_after("--change", "bigger")
        self.assertAlmostEqual(y[1], 0, places=1)
        self.assertAlmostEqual(y[1] - y[0], 1.3 * 1.8, places=3)
        self.assertAlmostEqual(x[1] - x[0], 1.3 * 0.9, places=3)
        self.assertAlmostEqual(sum(x) / 2, 0.45, places=1)
        x, y, z = self.bounds_after("--resize", 0.5)
        self.assertAlmostEqual(y[1] - y[0], 0.9, places=3)

    def test_the_artists_left_is_that_of_a_picture_from_the_front(self):
        """With -y up, who looks from -z sees x grow to the right."""
        x, y, z = self.bounds_after("--change", "move left 1 m")
        self.assertAlmostEqual(sum(x) / 2, 0.45 - 1, places=3)
        x, y, z = self.bounds_after("--move-right", 1)
        self.assertAlmostEqual(sum(x) / 2, 0.45 + 1, places=3)
        x, y, z = self.bounds_after("--change", "move forward 1 m")
        self.assertAlmostEqual(sum(z) / 2, 0.45 - 1, places=3)
        x, y, z = self.bounds_after("--change", "move forward 1 m", "--front", 180)
        self.assertAlmostEqual(sum(z) / 2, 0.45 + 1, places=3)

    def test_copies_carry_the_label(self):
        x, y, z = self.bounds_after("--copies", 3, count=3000)
        self.assertGreater(x[1] - x[0], 3 * 0.9)

    def test_projects_and_scenes_without_labels(self):
        plain = self.write("plain.ply", ply_bytes([each[:17] for each in scene_rows()], NAMES[:17]))
        process = run("transform", plain, self.folder / "a.ply", "--use-label", "--change", "bigger")
        self.assert_one_sentence(process, "no label")
        process = run("transform", plain, self.folder / "a.ply", "--turn", 30)
        self.assertEqual(process.returncode, 0, process.stderr)

    def test_what_cannot_be_done_is_said_in_a_sentence(self):
        self.assert_one_sentence(self.transform("--change", "blue"), "no change of place")
        self.assert_one_sentence(self.transform("--change", "swap with"), "other thing")
        self.assert_one_sentence(self.transform("--change", "bigger", "--other", "hat"), "no label")
        self.assert_one_sentence(run("transform", self.scene, self.scene, "--turn", 3), "input itself")
        self.assertEqual(self.transform("--resize", 0).returncode, 2)
        self.assertEqual(self.folder_listing(), ["scene.ply"])


if __name__ == "__main__":
    unittest.main()
