#!/usr/bin/env python3
"""Records what is read of scene and camera files, and compares two such records.

    record_scenes.py PROGRAM --out RECORD.json [--only TEXT ...]
    record_scenes.py --compare BEFORE.json AFTER.json

The inputs are those of data/scenes and data/odd. The record holds what `info --json` says, what was printed
beside it, and of the PLY that `convert` writes its sha256 and, of each group of columns (f_rest_3 is one of
f_rest), mean, mean size and values that are not finite; of folders of cameras what `cameras` writes.
Comparing prints a line per value that differs by more than a millionth and exits 1 where there is one. Sums
of bytes are compared with --exact only.
"""
import argparse
import array
import hashlib
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile

from record_edits import leaves

ROOT = pathlib.Path(__file__).resolve().parents[2]
SHARED = pathlib.Path(os.environ.get("GSE_SHARED") or os.environ.get("GSE_SHARED_DEFAULT")
                      or ROOT / "../shared").resolve()
DATA = SHARED / "data"
SCENES = (".ply", ".splat", ".spz", ".sog", ".zip", ".gz", ".ssproj")
CAMERAS = ("cameras.json", "transforms.json", "cameras.txt", "cameras.bin")
TYPES = {"float": ("f", 4), "double": ("d", 8), "uchar": ("B", 1), "ushort": ("H", 2), "int": ("i", 4),
         "uint": ("I", 4), "short": ("h", 2), "char": ("b", 1)}
MISSING = "not there"


def inputs():
    """Name and path of every input: scene files, unpacked scenes, folders of cameras without a scene."""
    found = {}
    for path in sorted((DATA / "scenes").iterdir()):
        found[str(path.relative_to(DATA))] = path
    for path in sorted((DATA / "odd").rglob("*")):
        if path.name.lower().endswith(SCENES):
            found[str(path.relative_to(DATA))] = path
        elif path.name in CAMERAS and not any((above / "scene.ply").exists() for above in path.parents):
            top = DATA / "odd" / pathlib.Path(*path.relative_to(DATA / "odd").parts[:2])
            found[str(top.relative_to(DATA))] = top
    return found


def column_sums(values):
    finite = [value for value in values if math.isfinite(value)]
    count = max(1, len(finite))
    return {"mean": math.fsum(finite) / count, "size": math.fsum(map(abs, finite)) / count,
            "not_finite": len(values) - len(finite)}


def ply_sums(path):
    """Rows, and sums per column, of a binary PLY whose one element has columns of one type."""
    data = path.read_bytes()
    head, _, body = data.partition(b"end_header\n")
    lines = [line.split() for line in head.decode(errors="replace").splitlines()]
    rows = next(int(line[2]) for line in lines if line[:2] == ["element", "vertex"])
    columns = [(line[1], line[2]) for line in lines if line[0] == "property" and len(line) == 3]
    sums = {"rows": rows, "sha256": hashlib.sha256(data).hexdigest(),
            "comments": [" ".join(line[1:]) for line in lines if line[0] == "comment"]}
    if len({kind for kind, _ in columns}) != 1:
        return sums | {"columns": [" ".join(column) for column in columns]}
    code, size = TYPES[columns[0][0]]
    values = array.array(code, body[:rows * len(columns) * size])
    groups = {}
    for at, (_, name) in enumerate(columns):
        groups.setdefault(name.rstrip("0123456789_"), array.array(code)).extend(values[at::len(columns)])
    sums["columns"] = {name: column_sums(group) for name, group in groups.items()}
    return sums


def run(program, arguments, hidden):
    """Exit code and what was printed on stderr, a line each, without the paths in `hidden`."""
    process = subprocess.run([program, "-q", *map(str, arguments)], capture_output=True, text=True,
                             errors="replace", timeout=600)
    said = process.stderr
    for path in hidden:
        said = said.replace(str(path), "...")
    return process, {"exit": process.returncode, "said": said.strip().splitlines()}


def camera_sums(path):
    """Count of viewpoints of a transforms.json, its size of pictures, and sums of its matrices."""
    json_text = json.loads(path.read_text())
    frames = json_text.pop("frames")
    entries = [value for frame in frames for row in frame["transform_matrix"] for value in row]
    facts = {key: value for key, value in json_text.items() if isinstance(value, (int, float))}
    return {"viewpoints": len(frames), **facts, **column_sums(entries)}


def written(program, command, path, out, sums):
    """Record of a command that writes the file `out`, with its sums."""
    _, entry = run(program, [command, path, out], [DATA, out.parent])
    if out.exists():
        entry |= sums(out)
        out.unlink()
    return entry


def record(program, path, folder):
    if path.is_dir() and not (path / "meta.json").exists() and not (path / "lod-meta.json").exists():
        return {"cameras": written(program, "cameras", path, folder / "transforms.json", camera_sums)}
    entry = {}
    process, entry["info"] = run(program, ["info", path, "--json"], [DATA, folder])
    if process.returncode == 0:
        facts = json.loads(process.stdout)
        facts.pop("file")
        facts["warnings"] = [text.replace(str(DATA), "...") for text in facts.get("warnings", [])]
        entry["info"]["facts"] = facts
    entry["convert"] = written(program, "convert", path, folder / "scene.ply", ply_sums)
    return entry


def record_all(program, only=()):
    """The record of all inputs, or of those with one of these texts in their names."""
    with tempfile.TemporaryDirectory(prefix="gse-record-") as folder:
        return {name: record(program, path, pathlib.Path(folder)) for name, path in inputs().items()
                if not only or any(text in name for text in only)}


def alike(a, b):
    """True for equal values, and for numbers that differ by less than a millionth of their size."""
    if isinstance(a, bool) or isinstance(b, bool) or not all(isinstance(v, (int, float)) for v in (a, b)):
        return a == b
    return abs(a - b) <= 1e-6 * max(1, abs(a), abs(b))


def differences(before, after, exact=False):
    """A line per value that differs."""
    lines = []
    for name in [*before, *(name for name in after if name not in before)]:
        old, new = (dict(leaves(record[name])) if name in record else {} for record in (before, after))
        for path in [*old, *(path for path in new if path not in old)]:
            values = old.get(path, MISSING), new.get(path, MISSING)
            if (exact or not path.endswith("sha256")) and not alike(*values):
                lines.append(f"{name}: {path}: {values[0]} -> {values[1]}")
    return lines


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", nargs="?", help="gseditpro")
    parser.add_argument("--out", type=pathlib.Path, help="file for the record")
    parser.add_argument("--only", nargs="+", default=[], metavar="TEXT",
                        help="inputs with one of these in their names")
    parser.add_argument("--compare", nargs=2, metavar=("BEFORE", "AFTER"), help="records to compare")
    parser.add_argument("--exact", action="store_true", help="compare the sums of bytes, too")
    options = parser.parse_args()
    if options.compare:
        lines = differences(*(json.loads(pathlib.Path(path).read_text()) for path in options.compare),
                            options.exact)
        print("\n".join(lines) if lines else "no differences")
        return 1 if lines else 0
    if not options.program or not options.out:
        parser.error("PROGRAM and --out are needed")
    sums = record_all(os.path.abspath(options.program), options.only)
    options.out.write_text(json.dumps(sums, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
