"""Whatever happens to a write (full disk, other disk, read-only place, kill), nothing that was there is lost,
nothing half-done is seen, and the program says one sentence with an exit code."""
import json
import math
import os
import pathlib
import resource
import shutil
import signal
import subprocess
import unittest

from program import PROGRAM, ProgramTest, can_mount, grid_rows, ply_bytes, run, run_in_namespace

FAILING_FILES = os.environ.get("GSE_FAILING_FILES", "")
CORPUS = pathlib.Path(__file__).resolve().parent.parent / "fuzz" / "corpus" / "project"
ENOSPC, EIO = 28, 5
MOST_CALLS = 60


def run_with(arguments, **options):
    """Like run(), with further options of subprocess."""
    options.setdefault("stdout", subprocess.PIPE)
    options.setdefault("stderr", subprocess.PIPE)
    return subprocess.run([PROGRAM, *map(str, arguments)], text=True, timeout=600, **options)


def run_with_fault(fault, *arguments):
    return run_with(arguments, env={**os.environ, "LD_PRELOAD": FAILING_FILES, "GSE_FAULT": fault})


class FilesTest(ProgramTest):
    def setUp(self):
        super().setUp()
        self.scene = self.write("scene.ply", ply_bytes(grid_rows()))
        (self.folder / "out").mkdir()

    def exporters(self):
        """Name of the output and the command that writes it."""
        small = ["--width", 32, "--height", 32]
        for name in ["new.ply", "new.compressed.ply", "new.splat", "new.spz"]:
            yield name, ["convert", self.scene, self.folder / "out" / name]
        yield "new.png", ["render", self.scene, self.folder / "out/new.png", *small]
        for name in ["new.mp4", "new.webm"]:
            yield name, ["turntable", self.scene, self.folder / "out" / name, *small, "--frames", 3]
        yield "project.ply", ["project", CORPUS / "whole.gsep", "--export", self.folder / "out/project.ply"]

    def frames(self, count, *more):
        return ["-q", "turntable", self.scene, self.folder / "out/frames", "--width", 32, "--height", 32,
                "--frames", count, *more]

    def out_listing(self):
        return sorted(path.name for path in (self.folder / "out").iterdir())


@unittest.skipUnless(FAILING_FILES, "[skip] built with a sanitizer, which must be loaded first itself")
class Faults(FilesTest):
    def check_failures(self, call, code):
        """Fails from every n-th call on until none is left; the old file stays and nothing is beside it."""
        for name, command in self.exporters():
            place = self.folder / "out" / name
            failures = 0
            for number in range(1, MOST_CALLS):
                place.write_bytes(b"old " * 10)
                process = run_with_fault(f"{call}:{number}:{code}", *command)
                if process.returncode == 0:
                    break
                failures += 1
                with self.subTest(name=name, number=number):
                    self.assert_one_sentence(process, name)
                    self.assertEqual(process.returncode, 1)
                    self.assertEqual(place.read_bytes(), b"old " * 10)
                    self.assertEqual(self.out_listing(), [name])
            self.assertGreater(failures, 0, name)
            self.assertNotEqual(place.read_bytes(), b"old " * 10)
            place.unlink()

    def test_a_disk_that_is_full_at_every_write_of_every_exporter(self):
        self.check_failures("write", ENOSPC)

    def test_a_disk_that_does_not_take_what_was_written(self):
        self.check_failures("fsync", EIO)

    def test_a_rename_that_fails(self):
        self.check_failures("rename", EIO)

    def test_killed_at_every_rename_of_a_file(self):
        for name, command in list(self.exporters())[:1] + list(self.exporters())[5:6]:
            place = self.folder / "out" / name
            place.write_bytes(b"old")
            process = run_with_fault("rename:1:kill", *command)
            self.assertEqual(process.returncode, -signal.SIGKILL)
            self.assertEqual(place.read_bytes(), b"old")
            self.assertEqual(len(self.out_listing()), 2, "the remains of the killed run")
            self.assertEqual(run(*command).returncode, 0)
            self.assertEqual(self.out_listing(), [name], "the next run removes them")
            place.unlink()

    def check_frames(self):
        """Name of the run whose frames are there: by their number and their size in the report."""
        report = json.loads((self.folder / "out/frames/frames.json").read_text())
        self.assertNotIn("unfinished", report)
        found = {path.name: path.stat().st_size for path in (self.folder / "out/frames").glob("*.png")}
        self.assertEqual(found, {name: entry["bytes"] for name, entry in report["files"].items()})
        return len(found)

    def test_killed_at_every_rename_of_a_folder(self):
        killed = 0
        for number in range(1, MOST_CALLS):
            shutil.rmtree(self.folder / "out/frames", ignore_errors=True)
            self.assertEqual(run(*self.frames(4)).returncode, 0)
            process = run_with_fault(f"rename:{number}:kill", *self.frames(2, "--azimuth", 90))
            self.assertIn(self.check_frames(), [2, 4])
            self.assertEqual(run(*self.frames(3)).returncode, 0)
            self.assertEqual(self.check_frames(), 3)
            self.assertEqual(self.out_listing(), ["frames"])
            self.assertEqual([path.name for path in (self.folder / "out/frames").iterdir()
                              if path.name[0] == "."], [])
            if process.returncode == 0:
                break
            self.assertEqual(process.returncode, -signal.SIGKILL)
            killed += 1
        self.assertGreater(killed, 3)


class Places(FilesTest):
    """Results at mount points, on other disks and in read-only parents; real file systems in a namespace of
    our own."""

    def setUp(self):
        super().setUp()
        if not can_mount():
            self.skipTest("[skip] this user may not mount file systems (unshare --user --mount)")

    def test_a_mount_point_as_output(self):
        (self.folder / "out/frames").mkdir()
        process = run_in_namespace('mount -t tmpfs -o size=20m none "$5"; "$0" "$@"; "$0" "$@"; '
                                   'ls -A "$5"; ls -A "$5/.."',
                                    "-q", "turntable", self.scene, "--frames=2", self.folder / "out/frames",
                                   "--width=32",
                                    "--height=32")
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertEqual(process.stdout.splitlines()[-4:],
                         ["frame_0000.png", "frame_0001.png", "frames.json", "frames"])

    def test_a_link_to_another_disk_as_output(self):
        (self.folder / "disk").mkdir()
        (self.folder / "out/frames").symlink_to(self.folder / "disk/there")
        (self.folder / "out/film.mp4").symlink_to(self.folder / "disk/film.mp4")
        script = ('mount -t tmpfs -o size=20m none "$1"; shift; mkdir there; for i in 1 2; do '
                  '"$0" -q turntable "$1" out/frames --frames 2 --width 32 --height 32; '
                  '"$0" -q turntable "$1" out/film.mp4 --frames 2 --width 32 --height 32; done; '
                  'ls -A disk disk/there')
        script = f'cd "{self.folder}"; ' + script.replace("mkdir there", "mkdir disk/there")
        process = run_in_namespace(script, self.folder / "disk", self.scene)
        self.assertEqual(process.returncode, 0, process.stderr)
        for name in ["film.mp4", "there", "frame_0001.png", "frames.json"]:
            self.assertIn(name, process.stdout.split())
        self.assertNotIn(".partial", process.stdout)
        self.assertTrue((self.folder / "out/frames").is_symlink())
        self.assertTrue((self.folder / "out/film.mp4").is_symlink())

    def test_a_full_disk_leaves_the_old_film_and_folder(self):
        script = ('cd "$2"; mount -t tmpfs -o size=400k none out; '
                  '"$0" -q turntable "$1" out/a.mp4 --frames 3 --width 32 --height 32; '
                  '"$0" -q turntable "$1" out/frames --frames 3 --width 32 --height 32; '
                  'cp -r out before; cat /dev/urandom > out/fill 2>/dev/null || true; set +e; '
                  '"$0" -q turntable "$1" out/a.mp4 --frames 60 --width 320 --height 320; echo "exit $?"; '
                  '"$0" -q turntable "$1" out/frames --frames 60 --width 320 --height 320; echo "exit $?"; '
                  'rm out/fill; diff -r before out && echo same')
        process = run_in_namespace(script, self.scene, self.folder)
        self.assertEqual(process.stdout.splitlines()[-3:], ["exit 1", "exit 1", "same"], process.stderr)
        sentences = [line for line in process.stderr.splitlines() if line.startswith("gseditpro: ")]
        self.assertEqual(len(sentences), 2, process.stderr)
        for sentence in sentences:
            self.assertIn("No space left", sentence)

    def test_a_writable_folder_in_a_read_only_parent(self):
        script = ('cd "$2"; mkdir -p parent/frames; mount -t tmpfs none parent; mkdir parent/frames; '
                  'mount -t tmpfs none parent/frames; mount -o remount,ro none parent; '
                  'for i in 1 2; do "$0" -q turntable "$1" parent/frames --frames 2 --width 32 --height 32; '
                  'done; ls -A parent/frames; set +e; '
                  '"$0" -q turntable "$1" parent/other --frames 2 --width 32 --height 32; echo "exit $?"')
        process = run_in_namespace(script, self.scene, self.folder)
        lines = process.stdout.splitlines()
        self.assertEqual(lines[-4:], ["frame_0000.png", "frame_0001.png", "frames.json", "exit 1"],
                         process.stderr)
        self.assertIn("Read-only file system", process.stderr)


class Outputs(FilesTest):
    def test_a_full_or_closed_stdout_is_said(self):
        for command in [["info", self.scene], ["info", self.scene, "--json"], ["--help"],
                        ["convert", self.scene, self.folder / "a.spz"]]:
            with open("/dev/full", "w") as full:
                process = run_with(command, stdout=full)
            self.assert_one_sentence(process, "No space left")
            self.assertEqual(process.returncode, 1)
            read_end, write_end = os.pipe()
            os.close(read_end)
            with os.fdopen(write_end, "w") as closed:
                process = run_with(command, stdout=closed)
            self.assert_one_sentence(process, "Broken pipe")
            process = run_with(command, preexec_fn=lambda: os.close(1), stdout=None)
            self.assert_one_sentence(process, "printed")
        self.assertEqual(self.info(self.folder / "a.spz")["splats"], 216)

    def test_a_full_stderr_ends_nothing(self):
        with open("/dev/full", "w") as full:
            process = run_with(["turntable", self.scene, self.folder / "a.mp4", "--width", 32, "--height", 32,
                                "--frames", 2], stderr=full)
        self.assertEqual(process.returncode, 0)

    def test_the_limit_for_file_sizes_is_said(self):
        for name in ["a.ply", "a.mp4"]:
            place = self.write(f"out/{name}", b"old")
            command = (["convert", self.scene, place] if name == "a.ply" else
                       ["turntable", self.scene, place, "--width", 64, "--height", 64, "--frames", 20])
            process = run_with(command,
                               preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000)))
            self.assert_one_sentence(process, "File too large")
            self.assertEqual(process.returncode, 1)
            self.assertEqual(place.read_bytes(), b"old")
        self.assertEqual(self.out_listing(), ["a.mp4", "a.ply"])

    def test_pipes_and_devices_are_no_input_and_no_output(self):
        os.mkfifo(self.folder / "pipe.ply")
        for arguments in [["info", self.folder / "pipe.ply"], ["info", "/dev/zero"],
                          ["edit", "--recipe", self.folder / "pipe.ply"],
                          ["turntable", self.scene, self.folder / "a.mp4", "--path",
                           self.folder / "pipe.ply"],
                          ["project", self.folder / "pipe.ply"]]:
            process = run_with(arguments, stdin=subprocess.DEVNULL)
            self.assert_one_sentence(process, "device" if "/dev/zero" in arguments else "pipe")
        for place in ["/dev/full", self.folder / "pipe.ply"]:
            self.assert_one_sentence(run("convert", self.scene, place, "--format", "spz"), "device")
        self.assertFalse(pathlib.Path("/dev/full").is_file())

    def test_links_stay_and_read_only_files_too(self):
        real = self.write("out/real.ply", b"old")
        link = self.folder / "link.ply"
        link.symlink_to(real)
        self.assertEqual(run("convert", self.scene, link).returncode, 0)
        self.assertTrue(link.is_symlink())
        self.assertEqual(self.info(real)["splats"], 216)
        real.chmod(0o444)
        self.assert_one_sentence(run("convert", self.scene, link), "read-only")
        real.chmod(0o640)
        self.assertEqual(run("convert", self.scene, real).returncode, 0)
        self.assertEqual(real.stat().st_mode & 0o777, 0o640)

    def test_the_input_is_not_its_own_output(self):
        before = self.scene.read_bytes()
        other_name = self.folder / "other.ply"
        other_name.symlink_to(self.scene)
        for place in [self.scene, other_name]:
            self.assert_one_sentence(run("convert", self.scene, place, "--format", "spz"), "itself")
        self.assertEqual(self.scene.read_bytes(), before)

    def test_frames_of_others_are_not_replaced(self):
        self.write("out/frame_0001.png", b"a photo")
        process = run("turntable", self.scene, self.folder / "out", "--frames", 3, "--width", 32, "--height",
                      32)
        self.assert_one_sentence(process, "frame_0001.png", "no earlier run")
        self.assertEqual((self.folder / "out/frame_0001.png").read_bytes(), b"a photo")
        self.assertEqual(self.out_listing(), ["frame_0001.png"])

    def test_names_that_are_not_utf8(self):
        folder = os.fsencode(self.folder) + b"/sz\xe9ne \xff"
        os.mkdir(folder)
        scene = folder + b"/b\xe4r.ply"
        shutil.copy(self.scene, os.fsdecode(scene))

        def run_bytes(*arguments):
            return subprocess.run([PROGRAM, *[a if isinstance(a, bytes) else str(a) for a in arguments]],
                                  capture_output=True, timeout=600)

        for name in [b"n\xe9w.spz", b"n\xe9w.compressed.ply"]:
            self.assertEqual(run_bytes("convert", scene, folder + b"/" + name).returncode, 0)
        for command in [["render", scene, folder + b"/p\xef.png", "--width", 32, "--height", 32],
                        ["turntable", scene, folder + b"/f\xef.mp4", "--width", 32, "--height", 32,
                         "--frames", 2],
                        ["turntable", scene, folder + b"/fr\xef", "--width", 32, "--height", 32, "--frames",
                         2]]:
            process = run_bytes(*command)
            self.assertEqual(process.returncode, 0, process.stderr)
        process = run_bytes("info", scene, "--json")
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertIn("%E4", json.loads(process.stdout.decode("utf-8"))["file"])
        self.assertEqual(len(os.listdir(folder)), 6)


class Losses(FilesTest):
    def test_convert_tells_what_a_format_changes_and_how_many_splats_it_holds(self):
        rows = grid_rows()
        rows[0] = rows[0][:10] + (5.9375 + math.log(2.8),) * 3 + rows[0][13:]
        rows[1] = (float("nan"),) + rows[1][1:]
        scene = self.write("large.ply", ply_bytes(rows))
        process = run("convert", scene, self.folder / "large.spz")
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertIn("215 splats written", process.stdout)
        self.assertIn("1 that the format cannot hold", process.stdout)
        self.assertIn("sizes up to 2.8 times too small (visibly for 1 splat)", process.stderr)
        self.assertIn("positions up to", process.stderr)
        process = run("convert", scene, self.folder / "large_again.ply")
        self.assertIn("216 splats written", process.stdout)
        self.assertNotIn("rounded", process.stderr)


if __name__ == "__main__":
    unittest.main()
