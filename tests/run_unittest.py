"""Runs one module of unittest for CTest: run_unittest.py MODULE. What was skipped ("[skip] ...") makes the
exit code 77, which CTest shows as skipped. Where CI is set, data or a model that "is not there" is a
failure."""
import os
import sys
import unittest

SKIP_CODE = 77


def main():
    sys.path.insert(0, os.getcwd())
    tests = unittest.defaultTestLoader.loadTestsFromName(sys.argv[1])
    result = unittest.TextTestRunner(verbosity=2).run(tests)
    skipped = [f"{test}: {reason}" for test, reason in result.skipped if reason.startswith("[skip]")]
    for line in skipped:
        print(line, file=sys.stderr)
    if not result.wasSuccessful() or result.testsRun == 0:
        return 1
    if os.environ.get("CI", "") not in {"", "0", "false"} and any("not there" in line for line in skipped):
        print("CI is set: nothing may be skipped because it is not there", file=sys.stderr)
        return 1
    return SKIP_CODE if skipped else 0


if __name__ == "__main__":
    sys.exit(main())
