"""Changes, one after the other, everything that a reference case states beside its tensors, and asks that its
tests then fail: a constant that is written into a test would not notice. With --some, one of each case: the
rest is for the full run.
check_constants.py TEST_PROGRAM SHARED_FOLDER [--some]"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile

SKIP_CODE = 77
# Cases whose constants are compared, and the tests that read them.
CASES = {"dreambooth": "dreambooth: without prior*,dreambooth: UNet and text*", "schedulers": "schedulers: *",
         "sds": "sds: *",
         "pipeline_sd1": "pipeline_sd1: *", "lcm": "lcm: *", "ip2p": "ip2p: *",
         "taesd_img2img": "taesd_img2img: *"}
# What has no effect because of what stands beside it: a text guidance of 1 turns the picture's off too.
WITHOUT_EFFECT = {("ip2p", "nocfg", "image_guidance_scale")}
# AdamW does not see the length of a gradient unless it is shorter than its epsilon.
SHORTEST = {"max_grad_norm": 1e-9}


def leaves(node, path=()):
    """Every number and text of a JSON tree, with the way to it."""
    if isinstance(node, dict):
        items = node.items()
    elif isinstance(node, list):
        items = enumerate(node)
    else:
        yield path, node
        return
    for key, value in items:
        yield from leaves(value, (*path, key))


def changed(tree, path):
    tree = json.loads(json.dumps(tree))
    node = tree
    for key in path[:-1]:
        node = node[key]
    value = node[path[-1]]
    if isinstance(value, str):
        node[path[-1]] = value + " dog"
    elif isinstance(value, int):
        node[path[-1]] = value + 1
    else:
        node[path[-1]] = value * SHORTEST.get(path[-1], 3)
    return tree


def run(program, goldens, tests):
    return subprocess.run([program, f"--test-case={tests}"], env={**os.environ, "GSE_GOLDENS": str(goldens)},
                          capture_output=True, text=True)


def main():
    program = sys.argv[1]
    shared = pathlib.Path(os.environ.get("GSE_SHARED") or sys.argv[2])
    goldens = pathlib.Path(os.environ.get("GSE_GOLDENS") or shared / "goldens").resolve()
    if not goldens.is_dir():
        print(f"[skip] {goldens} is not there")
        return 1 if os.environ.get("CI", "") not in {"", "0", "false"} else SKIP_CODE
    failures = 0
    for case, tests in CASES.items():
        stated = json.loads((goldens / case / "case.json").read_text())
        if run(program, goldens, tests).returncode != 0:
            print(f"{case}: fails as it stands")
            return 1
        read = [leaf for leaf in leaves(stated) if (case, *leaf[0]) not in WITHOUT_EFFECT]
        for path, value in read[:1] if "--some" in sys.argv else read:
            with tempfile.TemporaryDirectory(prefix="gse-goldens-") as folder:
                copy = pathlib.Path(folder) / "goldens"
                (copy / case).mkdir(parents=True)
                for other in goldens.iterdir():
                    if other.name != case:
                        (copy / other.name).symlink_to(other)
                for file in (goldens / case).iterdir():
                    if file.name != "case.json":
                        (copy / case / file.name).symlink_to(file)
                (copy / case / "case.json").write_text(json.dumps(changed(stated, path)))
                noticed = run(program, copy, tests).returncode != 0
            failures += not noticed
            print(f"{'noticed ' if noticed else 'NOT READ'} {case}: {'.'.join(map(str, path))} = {value}",
                  flush=True)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
