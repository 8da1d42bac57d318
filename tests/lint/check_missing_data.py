"""Data that is missing is seen: a test program without it returns the skip code, or fails where CI is set.
check_missing_data.py TEST_PROGRAM..."""
import os
import pathlib
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


def main():
    wrong = 0
    with tempfile.TemporaryDirectory(prefix="gse-missing-") as folder:
        runner = [sys.executable, str(pathlib.Path(__file__).resolve().parent.parent / "run_unittest.py")]
        (pathlib.Path(folder) / "test_data.py").write_text(UNITTEST.format("the shared scenes are not there"))
        (pathlib.Path(folder) / "test_right.py").write_text(UNITTEST.format("this user may not mount"))
        commands = [([program], 1) for program in sys.argv[1:]]
        commands += [([*runner, "test_data"], 1), ([*runner, "test_right"], SKIP_CODE)]
        for command, in_ci in commands:
            for ci, wanted in (("", SKIP_CODE), ("true", in_ci)):
                environment = {**os.environ, "CI": ci, "GSE_GOLDENS": f"{folder}/none/goldens", "GSE_SHARED": f"{folder}/none"}
                process = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
                if process.returncode != wanted:
                    print(f"{command[0]} with CI={ci!r} returned {process.returncode}\n{process.stdout}{process.stderr}")
                    wrong += 1
                elif "[skip]" not in process.stdout + process.stderr and "is not there" not in process.stdout + process.stderr:
                    print(f"{command[0]} does not say what is missing")
                    wrong += 1
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
