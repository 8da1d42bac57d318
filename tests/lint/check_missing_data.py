"""Data or machinery that is missing is seen: a test program without it returns the skip code, or fails where
CI is set.
check_missing_data.py [--display PROGRAM] [--device PROGRAM] [--plug-in PROGRAM CASE] [DATA_PROGRAM...]"""
import argparse
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

SKIP_CODE = 77
UNITTEST = '''import unittest
class Case(unittest.TestCase):
    @unittest.skip("[skip] {}")
    def test_left_out(self): pass
    def test_done(self): pass
'''


class Check:
    """A command, what its environment lacks, and its exit code where CI is set."""

    def __init__(self, command, lacks=None, in_ci=1):
        self.command = [str(word) for word in command]
        self.lacks = lacks or {}
        self.in_ci = in_ci


def checks_of(arguments, folder):
    runner = [sys.executable, pathlib.Path(__file__).resolve().parent.parent / "run_unittest.py"]
    (folder / "test_data.py").write_text(UNITTEST.format("the shared scenes are not there"))
    (folder / "test_right.py").write_text(UNITTEST.format("this user may not mount"))
    checks = [Check([*runner, "test_data"]), Check([*runner, "test_right"], in_ci=SKIP_CODE)]
    checks += [Check([program]) for program in arguments.data]
    if arguments.display:
        checks.append(Check([arguments.display], {"DISPLAY": "", "WAYLAND_DISPLAY": ""}))
    if arguments.device:
        checks.append(Check([arguments.device], {"VK_ICD_FILENAMES": "/none", "VK_DRIVER_FILES": "/none"}))
    if arguments.plug_in:
        program, case = arguments.plug_in
        # the plug-in is looked for in the folder above
        copied = folder / "tests" / pathlib.Path(program).name
        copied.parent.mkdir()
        shutil.copy(program, copied)
        checks.append(Check([copied, f"-tc={case}"]))
    return checks


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--display")
    parser.add_argument("--device")
    parser.add_argument("--plug-in", nargs=2)
    parser.add_argument("data", nargs="*")
    wrong = 0
    with tempfile.TemporaryDirectory(prefix="gse-missing-") as name:
        folder = pathlib.Path(name)
        nothing = {"GSE_GOLDENS": f"{folder}/none/goldens", "GSE_SHARED": f"{folder}/none"}
        for check in checks_of(parser.parse_args(), folder):
            for ci, wanted in (("", SKIP_CODE), ("true", check.in_ci)):
                environment = {**os.environ, "CI": ci, **nothing, **check.lacks}
                environment = {key: value for key, value in environment.items() if value or key == "CI"}
                process = subprocess.run(check.command, cwd=folder, env=environment, capture_output=True,
                                         text=True)
                said = process.stdout + process.stderr
                if process.returncode != wanted:
                    print(f"{check.command[0]} with CI={ci!r} returned {process.returncode}\n{said}")
                    wrong += 1
                elif not any(text in said for text in ("[skip]", "nothing may be skipped", "is not there")):
                    print(f"{check.command[0]} does not say what is missing")
                    wrong += 1
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
