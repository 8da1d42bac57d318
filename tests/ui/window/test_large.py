"""Three million splats of SH degree 3 in the window: open, orbit, locate, 20 steps of an edit, save, in less
than 8 GB. Prints what each took."""
import os
import pathlib
import random
import re
import struct
import subprocess
import time
import unittest

from window import PROGRAM, WindowTest

SPLATS, THING = 3_000_000, 300_000
MOST_BYTES = 8e9
STEPS = 20
PROPERTIES = (["x", "y", "z", "nx", "ny", "nz"] + [f"f_dc_{i}" for i in range(3)]
              + [f"f_rest_{i}" for i in range(45)] +
              ["opacity"] + [f"scale_{i}" for i in range(3)] + [f"rot_{i}" for i in range(4)])


def write_large(path):
    """The bear of the synthetic world: a tenth of the splats are the thing, those of the ground come several
    times; 708 MB."""
    small = path.with_name("small.ply")
    subprocess.run([os.environ["GSE_LABORATORY"], "-q", "synth", str(small), "--splats", "5000000", "--seed",
                    "5"], check=True, stdout=subprocess.DEVNULL)
    data = small.read_bytes()
    begin = data.index(b"end_header\n") + len(b"end_header\n")
    names = re.findall(r"property float (\w+)", data[:begin].decode())
    size = 4 * len(names)
    split, label = 4 * names.index("opacity"), 4 * names.index("label")
    rows = [data[i:i + size] for i in range(begin, len(data), size)]
    # the label that the file has
    ground = [row for row in rows if struct.unpack_from("<f", row, label)[0] != 0]
    thing = [row for row in rows if struct.unpack_from("<f", row, label)[0] == 0]
    chance = random.Random(1)
    chosen = chance.sample(thing, min(THING, len(thing)))
    while len(chosen) < SPLATS:
        chosen += ground[:SPLATS - len(chosen)]
    rest = [struct.pack("<45f", *(chance.gauss(0, 0.01) for _ in range(45))) for _ in range(997)]
    with open(path, "wb") as file:
        header = "".join(f"property float {name}\n" for name in PROPERTIES)
        file.write("ply\nformat binary_little_endian 1.0\ncomment Vertical axis: 0 -1 0\n"
                   f"element vertex {SPLATS}\n{header}"
                   "end_header\n".encode())
        for i, row in enumerate(chosen):
            file.write(row[:split] + rest[i % 997] + row[split:label])
    small.unlink()


class Large(WindowTest):
    def test_three_million_splats(self):
        scene = pathlib.Path(self.folder) / "large.ply"
        write_large(scene)
        self.begin = time.monotonic()
        window = self.open(scene)
        window.wait(lambda s: s["splats"] == SPLATS and not s["busy"], "the scene did not open")
        self.lap(window, "open")
        frames = window.state()["frames"]
        window.drag("viewport", [(0.5, 0.5), (0.55, 0.5), (0.62, 0.52), (0.4, 0.5), (0.3, 0.5), (0.5, 0.5)])
        self.lap(window, "orbit")
        self.assertGreater(window.state()["frames"], frames + 5)
        window.write("prompt.source", "bear")
        window.write("prompt.sentence", "a golden bear on the grass")
        self.begin = time.monotonic()
        window.click("prompt.locate")
        time.sleep(1)
        window.idle(1800)
        self.lap(window, "locate")
        self.assertGreater(window.state()["labelled"], THING / 2)
        self.assertLess(window.state()["labelled"], SPLATS / 2)
        window.click("prompt.edit")
        window.wait(lambda s: s["job"]["stage"] == "editing" and s["job"]["step"] >= STEPS,
                    "the edit did not come so far", 1800)
        self.lap(window, f"{STEPS} steps")
        window.cancel_job()
        window.idle(600)
        self.assertTrue(window.state()["result_waiting"])
        self.lap(window, "stop")
        window.click("result.apply")
        window.wait(lambda s: not s["result_waiting"] and not s["busy"], "it was not applied")
        self.lap(window, "apply")
        window.key("ctrl+s")
        time.sleep(1)
        if "files.confirm" in window.widgets():
            window.click("files.confirm")
        window.wait(lambda s: s["project"] != "" and not s["unsaved"], "it was not saved", 600)
        self.lap(window, "save")
        peak = int(re.search(r"VmHWM:\s+(\d+)",
                             pathlib.Path(f"/proc/{window.process.pid}/status").read_text())[1]) * 1024
        print(f"at most {peak / 1e9:.2f} GB")
        self.assertLess(peak, MOST_BYTES)
        self.assertEqual(window.close(), 0)

    def lap(self, window, what):
        now = time.monotonic()
        print(f"{what}: {now - self.begin:.1f} s", flush=True)
        self.begin = now


if __name__ == "__main__":
    unittest.main()
