#!/usr/bin/env python3
"""Runs sentences of the development suite on the bundled scene, for a contact sheet and a table.

    sentence_sheet.py PROGRAM --out FOLDER [--count 60] [--seed 1] [-- EDIT_OPTION ...]

Sentences are about a red bear on grass, and ask for operations that the bundled model does. FOLDER/table.tsv
holds a line per sentence: id, sentence, exit code, steps done, splats changed, what was said. Each row of
FOLDER/sheet_N.png is a sentence: before, after, after from behind. FOLDER/ID is what the edit left. Sentences
whose folder is there already are not run again.
"""
import argparse
import json
import os
import pathlib
import random
import re
import struct
import subprocess
import sys
import zlib

ROOT = pathlib.Path(__file__).resolve().parents[2]
SHARED = pathlib.Path(os.environ.get("GSE_SHARED") or ROOT / "../shared").resolve()
BEAR = ROOT / "assets/scenes/bear/scene.ply"
DOABLE = {"recolour", "material", "pattern", "ground", "replace", "add", "none"}
SIDE = 128          # of a picture of the film, pixels
SHEET_ROWS = 10     # sentences in a column of a sheet
SHEET_COLUMNS = 2
GAP = 4             # pixels between pictures

# ---- PNG --------------------------------------------------------------------------------------------------


def read_png(path):
    """(width, rows) of an 8-bit RGB picture; a row is bytes."""
    data, at, packed, width, height = path.read_bytes(), 8, b"", 0, 0
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        if kind == b"IHDR":
            width, height, depth, colour = struct.unpack(">IIBB", body[:10])
            assert (depth, colour) == (8, 2), path
        if kind == b"IDAT":
            packed += body
        at += 12 + size
    raw, stride, rows, last = zlib.decompress(packed), width * 3, [], bytes(width * 3)
    for y in range(height):
        begin = y * (stride + 1)
        last = unfiltered(raw[begin], raw[begin + 1:begin + 1 + stride], last)
        rows.append(last)
    return width, rows


def unfiltered(kind, line, above):
    """A line of a PNG without its filter."""
    line = bytearray(line)
    for i in range(len(line)):
        left = line[i - 3] if i >= 3 else 0
        corner = above[i - 3] if i >= 3 else 0
        if kind == 1:
            line[i] = (line[i] + left) & 255
        elif kind == 2:
            line[i] = (line[i] + above[i]) & 255
        elif kind == 3:
            line[i] = (line[i] + (left + above[i]) // 2) & 255
        elif kind == 4:
            nearest = left + above[i] - corner
            near = min((abs(nearest - left), 0, left), (abs(nearest - above[i]), 1, above[i]),
                       (abs(nearest - corner), 2, corner))
            line[i] = (line[i] + near[2]) & 255
    return bytes(line)


def write_png(path, width, rows):
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    raw = b"".join(b"\0" + row for row in rows)
    header = struct.pack(">IIBBBBB", width, len(rows), 8, 2, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(raw))
                     + chunk(b"IEND", b""))


# Five rows of three pixels per digit.
GLYPHS = {"0": "75557", "1": "26227", "2": "71747", "3": "71717", "4": "55711", "5": "74717", "6": "74757",
          "7": "71122", "8": "75757", "9": "75717"}


def number_rows(number, height):
    """A picture of a number, white on grey, `height` rows high."""
    scale, text = 4, str(number)
    width = (4 * len(text) + 1) * scale
    rows = []
    for y in range(height):
        row = bytearray(b"\x40\x40\x40" * width)
        line = y // scale - 1
        if 0 <= line < 5:
            for index, digit in enumerate(text):
                bits = int(GLYPHS[digit][line])
                for x in range(3):
                    if bits >> (2 - x) & 1:
                        begin = (1 + 4 * index + x) * scale * 3
                        row[begin:begin + 3 * scale] = b"\xff" * (3 * scale)
        rows.append(bytes(row))
    return rows

# ---- sentences --------------------------------------------------------------------------------------------


def unescaped(text):
    return re.sub(r"\\(n|t|r|s|\\|u[0-9a-fA-F]{4})",
                  lambda m: {"n": "\n", "t": "\t", "r": "\r", "s": " ", "\\": "\\"}.get(m[1])
                  or chr(int(m[1][1:], 16)), text)


def suite():
    """[(id, sentence, plan)] of a red bear on grass whose operations are done."""
    result = []
    for line in (SHARED / "data/sentences/sentences_dev.tsv").read_text().splitlines():
        columns = line.split("\t")
        if line.startswith("#") or len(columns) < 5:
            continue
        name, scene, source, sentence, plan = columns[:5]
        operations = {step.split("(")[0].strip() for step in plan.split("|")[0].split(";")}
        if scene == "red bear; grass" and source == "bear" and operations <= DOABLE:
            result.append((name, unescaped(sentence), plan))
    return result


def run_one(program, folder, sentence, options, scene=BEAR):
    """Runs an edit; keeps what it said beside its folder."""
    log = folder.with_suffix(".json")
    if not log.exists():
        process = subprocess.run(
            [program, "-q", "edit", str(scene), "--source", "bear", "--prompt", sentence, "--out",
             str(folder), "--turntable-size", str(SIDE), "--turntable-frames", "2", *options],
            capture_output=True, text=True, errors="replace")
        log.write_text(json.dumps({"exit_code": process.returncode, "said": process.stderr.strip(),
                                   "printed": process.stdout.strip()}))
    return json.loads(log.read_text())


def steps_of(folder):
    """[(report, whether it was done)] of an edit's folder."""
    path = folder / "report.json"
    if not path.exists():
        return []
    report = json.loads(path.read_text())
    if "steps" not in report:
        return [(report, report.get("judgement", {}).get("passed", True))]
    return [(step.get("report"), step["done"]) for step in report["steps"]]


def changed_splats(report):
    return 0 if report is None else report["labelled"] + report["added"] + report["removed"]


def pictures_of(folder):
    """Before, after, after from behind: the first step's before, and the last one's after."""
    sheets = sorted(folder.glob("[0-9]*/before_after.png")) or list(folder.glob("before_after.png"))
    if not sheets:
        return None
    _, first = read_png(sheets[0])
    _, last = read_png(sheets[-1])
    left, right = slice(0, SIDE * 3), slice((SIDE + 2) * 3, (2 * SIDE + 2) * 3)
    return [[row[left] for row in first[:SIDE]], [row[right] for row in last[:SIDE]],
            [row[right] for row in last[2 * SIDE:3 * SIDE]]]


def cell_of(number, folder):
    """One sentence's row of the sheet."""
    label = number_rows(f"{number:02}", SIDE)
    pictures = pictures_of(folder) or [[b"\x20" * (SIDE * 3)] * SIDE] * 3
    gap = b"\0" * (3 * GAP)
    return [gap.join([label[y], *(picture[y] for picture in pictures)]) + gap for y in range(SIDE)]


def write_sheets(folder, cells):
    per_sheet = SHEET_ROWS * SHEET_COLUMNS
    for sheet in range(0, len(cells), per_sheet):
        part = cells[sheet:sheet + per_sheet]
        blank = [b"\0" * len(part[0][0])] * SIDE
        part += [blank] * (-len(part) % SHEET_ROWS)
        columns = [part[i:i + SHEET_ROWS] for i in range(0, len(part), SHEET_ROWS)]
        rows = []
        for line in range(SHEET_ROWS):
            rows += [b"".join(column[line][y] for column in columns) for y in range(SIDE)]
            rows += [b"\0" * len(rows[-1])] * GAP
        write_png(folder / f"sheet_{sheet // per_sheet + 1}.png", len(rows[0]) // 3, rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--count", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    given, _, options = " ".join(sys.argv[1:]).partition(" -- ")
    arguments = parser.parse_args(given.split())
    arguments.out.mkdir(parents=True, exist_ok=True)
    sentences = suite()
    chosen = random.Random(arguments.seed).sample(sentences, min(arguments.count, len(sentences)))
    cells, lines = [], ["number\tid\tsentence\texit code\tsteps done\tsplats changed\tsaid\tplan"]
    for number, (name, sentence, plan) in enumerate(sorted(chosen), 1):
        folder = arguments.out / name
        outcome = run_one(arguments.program, folder, sentence, options.split())
        steps = steps_of(folder)
        done = sum(1 for _, is_done in steps if is_done)
        said = " / ".join(outcome["said"].splitlines())
        lines.append("\t".join([str(number), name, " ".join(sentence.split()), str(outcome["exit_code"]),
                                f"{done} of {len(steps)}", str(sum(changed_splats(r) for r, _ in steps)),
                                said, plan]))
        print(lines[-1], flush=True)
        cells.append(cell_of(number, folder))
        (arguments.out / "table.tsv").write_text("\n".join(lines) + "\n")
    write_sheets(arguments.out, cells)


if __name__ == "__main__":
    main()
