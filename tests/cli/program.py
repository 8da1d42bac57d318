"""Runs gseditpro and gseditpro-lab for the tests and makes the small files they feed it."""
import json
import os
import pathlib
import shutil
import struct
import subprocess
import tempfile
import unittest

PROGRAM = os.environ["GSE_PROGRAM"]
LABORATORY = os.environ["GSE_LABORATORY"]
os.environ["GSE_CACHE_DIR"] = os.devnull   # what is tested is computed; a test of the cache names a folder
SHARED = pathlib.Path(os.environ.get("GSE_SHARED") or os.environ.get("GSE_SHARED_DEFAULT", "../shared"))


def run(*arguments, timeout=600):
    """Runs the program; returns the finished process with text output."""
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True,
                          errors="surrogateescape",
                          timeout=timeout)


def run_laboratory(*arguments, timeout=600):
    """Runs gseditpro-lab; returns the finished process with text output."""
    return subprocess.run([LABORATORY, *map(str, arguments)], capture_output=True, text=True,
                          errors="surrogateescape",
                          timeout=timeout)


def ply_bytes(rows, names=None, count=None, header_extra=""):
    """A binary 3DGS PLY of SH degree 0 with these float rows."""
    names = names or ["x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0",
                      "scale_1",
                      "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"]
    header = "ply\nformat binary_little_endian 1.0\n" + header_extra
    header += f"element vertex {len(rows) if count is None else count}\n"
    header += "".join(f"property float {name}\n" for name in names) + "end_header\n"
    return header.encode() + b"".join(struct.pack(f"<{len(names)}f", *row) for row in rows)


def grid_rows(side=6):
    """A small cube of visible splats."""
    return [(x * 0.1, y * 0.1, z * 0.1, 0, 0, 0, 0.5, -0.2, 0.1, 3.0, -3.0, -3.0, -3.0, 1, 0, 0, 0)
            for x in range(side) for y in range(side) for z in range(side)]


def can_mount():
    """Whether this user may have file systems of his own."""
    try:
        return subprocess.run(["unshare", "--user", "--map-root-user", "--mount", "sh", "-c",
                               "mount -t tmpfs none /mnt"],
                              capture_output=True).returncode == 0
    except FileNotFoundError:
        return False


def run_in_namespace(script, *arguments):
    """Runs a shell script that may mount; $0 is the program, $1... the arguments."""
    return subprocess.run(["unshare", "--user", "--map-root-user", "--mount", "sh", "-ec", script, PROGRAM,
                           *map(str, arguments)], capture_output=True, text=True, timeout=600)


class ProgramTest(unittest.TestCase):
    """Gives each test a folder of its own."""

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="gse-cli-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def write(self, name, data):
        path = self.folder / name
        path.write_bytes(data)
        return path

    def info(self, path):
        process = run("info", path, "--json")
        self.assertEqual(process.returncode, 0, process.stderr)
        return json.loads(process.stdout)

    def assert_one_sentence(self, process, *words):
        """Exit code not 0, one line on stderr that begins with the program's name, and the given words in
        it."""
        self.assertNotEqual(process.returncode, 0, process.stdout)
        self.assertGreater(process.returncode, 0, "ended by a signal")
        lines = [line for line in process.stderr.splitlines()
                 if line.startswith(("gseditpro: ", "gseditpro-lab: "))]
        self.assertEqual(len(lines), 1, process.stderr)
        for word in words:
            self.assertIn(word.lower(), lines[0].lower())
        return lines[0]

    def folder_listing(self):
        return sorted(str(path.relative_to(self.folder)) for path in self.folder.rglob("*"))
