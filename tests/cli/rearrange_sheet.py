#!/usr/bin/env python3
"""Runs sentences of the development suite that remove, move, resize, turn or copy things of the sample scene.

    rearrange_sheet.py PROGRAM --out FOLDER [--count 0] [--seed 1] [-- EDIT_OPTION ...]

Sentences are about a red bear on grass; those with a hat begin with an edit that gives it one. Of every step
that removes, transforms or copies, the splats before and after are held against what the plan asks.
FOLDER/table.tsv holds a line per sentence: id, sentence, exit code, splats before and after, verdict, what
was said. Rows of FOLDER/sheet_N.png: before, after, after from behind. Sentences whose folder is there
already are not run again. A count of 0 means all.
"""
import argparse
import array
import json
import pathlib
import random
import re
import sys

import sentence_sheet

SCENES = {"red bear; grass": None, "red bear; blue hat; grass": "a bear wearing a blue hat"}
REARRANGED = {"remove", "transform", "duplicate"}
STEP = re.compile(r"(\w+)\(([^)]*)\)")
CLEAR = 0.05        # of the size of a thing: less is no change
MOVED = 0.2         # of the size of a thing: least distance of a move
TRIM = 0.02         # share of the splats that bounds leave out on either side
SHAPE = 0.02        # of the size: a thing that only moves keeps its size to that
LEFT = 0.05         # share of a thing's splats that a label may miss, or take of another thing


def suite():
    """[(id, scene words, sentence, plan)] of steps that are done on the bundled scene."""
    result = []
    path = sentence_sheet.SHARED / "data/sentences/sentences_dev.tsv"
    for line in path.read_text().splitlines():
        columns = line.split("\t")
        if line.startswith("#") or len(columns) < 5 or columns[1] not in SCENES or columns[2] != "bear":
            continue
        operations = {name for name, _ in STEP.findall(columns[4])}
        if operations & REARRANGED and operations <= REARRANGED | sentence_sheet.DOABLE | {"alter", "pose"}:
            result.append((columns[0], columns[1], sentence_sheet.unescaped(columns[3]), columns[4]))
    return result


def hatted_scene(program, folder, words):
    """The bundled scene as the words say, made by an edit where it must be."""
    if SCENES[words] is None:
        return sentence_sheet.BEAR
    made = folder / "_with_hat"
    sentence_sheet.run_one(program, made, SCENES[words], [])
    return made / "scene.ply"


# ---- splats -----------------------------------------------------------------------------------------------


def read_splats(path):
    """{column: array} of a PLY with float columns."""
    head, body = path.read_bytes().split(b"end_header\n", 1)
    lines = head.decode().splitlines()
    columns = [line.split()[2] for line in lines if line.startswith("property float ")]
    count = next(int(line.split()[2]) for line in lines if line.startswith("element vertex"))
    assert sum(line.startswith("property") for line in lines) == len(columns), path
    values = array.array("f", body[:4 * count * len(columns)])
    return {name: values[i::len(columns)] for i, name in enumerate(columns)}


def keys_of(splats):
    """Colour and opacity of every splat: they stay what they are where a thing is moved."""
    return list(zip(splats["opacity"], splats["f_dc_0"], splats["f_dc_1"], splats["f_dc_2"]))


def bounds(splats, rows):
    """((low, high) of x, of height, of z) without the outermost splats; -y is up."""
    def pair(values):
        values = sorted(values)
        cut = int(TRIM * len(values))
        return values[cut], values[len(values) - 1 - cut]
    return (pair([splats["x"][i] for i in rows]), pair([-splats["y"][i] for i in rows]),
            pair([splats["z"][i] for i in rows]))


class Step:
    """Splats of a labelled thing before a step and after it."""

    def __init__(self, folder):
        self.before, self.after = read_splats(folder / "source.ply"), read_splats(folder / "scene.ply")
        old = [i for i, label in enumerate(self.before["label"]) if label > 0.5]
        keys = keys_of(self.before)
        own = {keys[i] for i in old}
        rest = {key for i, key in enumerate(keys) if self.before["label"][i] <= 0.5}
        self.old = [i for i in old if keys[i] not in rest]
        self.new = [i for i, key in enumerate(keys_of(self.after)) if key in own and key not in rest]

    def counts(self):
        return len(self.before["x"]), len(self.after["x"])


def size(box):
    return [high - low for low, high in box]


def middle(box):
    return [(low + high) / 2 for low, high in box]


def fault_of_transform(step, thing, change):
    """What is wrong about a transform; empty = nothing. Parts of a thing stand on no ground."""
    if len(step.new) != len(step.old):
        return f"{len(step.old)} splats became {len(step.new)}"
    old, new = bounds(step.before, step.old), bounds(step.after, step.new)
    grown = [b / a for a, b in zip(size(old), size(new))]
    shift = [(b - a) / max(size(old)) for a, b in zip(middle(old), middle(new))]
    lifted = 0 if " of " in thing else (new[1][0] - old[1][0]) / size(old)[1]
    words = change.split()
    told = "grown {:.2f} {:.2f} {:.2f}, shifted {:.2f} {:.2f} {:.2f}".format(*grown, *shift)
    moves = {"left": (0, -1), "right": (0, 1), "up": (1, 1), "down": (1, -1), "back": (2, 1),
             "forward": (2, -1)}
    right = True
    if words[0] in ("bigger", "smaller", "taller", "longer", "wider", "scale"):
        wanted = {"smaller": -1}.get(words[0], 1)
        axes = {"taller": [1], "longer": [1], "wider": [0]}.get(words[0], [0, 1, 2])
        factor = float(words[1]) if words[0] == "scale" else None
        right = all((grown[axis] - 1) * wanted > CLEAR for axis in axes) and abs(lifted) < 2 * CLEAR
        if factor:
            right = right and all(abs(each / factor - 1) < CLEAR for each in grown)
    elif words[0] == "move":
        axis, way = moves[words[1]]
        right = shift[axis] * way > MOVED and all(abs(each - 1) < SHAPE for each in grown)
    elif words[0] == "rotate":
        turned = words[1] in ("90", "270")
        expected = [size(old)[2], size(old)[1], size(old)[0]] if turned else None
        right = abs(grown[1] - 1) < SHAPE and abs(lifted) < CLEAR and differs(step)
        if expected:
            right = right and all(abs(a / b - 1) < CLEAR for a, b in zip(size(new), expected))
    elif words[0] in ("flip", "mirror"):
        right = all(abs(each - 1) < CLEAR for each in grown) and abs(lifted) < CLEAR and differs(step)
    return "" if right else f"asked for {change}: {told}, foot {lifted:+.2f}"


def true_things():
    """{noun: keys} of the bundled scene: its ground lies at height 0. What is in neither is the hat."""
    scene = read_splats(sentence_sheet.BEAR)
    keys = keys_of(scene)
    return {"grass": {key for key, y in zip(keys, scene["y"]) if y == 0},
            "bear": {key for key, y in zip(keys, scene["y"]) if y != 0}}


def shares_left(step):
    """{noun: share of its splats that are there after a step}."""
    things = true_things()
    before, after = set(keys_of(step.before)), set(keys_of(step.after))
    things["hat"] = before - things["grass"] - things["bear"]
    return {noun: len(keys & after) / len(keys & before) for noun, keys in things.items() if keys & before}


def fault_of_removal(step, noun):
    """What is wrong about a removal; empty = nothing. A hat goes with its wearer, healing changes ground."""
    left = shares_left(step)
    if noun not in left:
        return f"nobody knows which splats are the {noun}"
    faults = [f"{left[noun]:.0%} of the {noun} is left"] if left[noun] > LEFT else []
    for other, share in left.items():
        if other in (noun, "grass") or (noun, other) == ("bear", "hat"):
            continue
        if share < 1 - LEFT:
            faults.append(f"{1 - share:.0%} of the {other} is gone")
    return ", ".join(faults)


def differs(step):
    return any(step.before["x"][a] != step.after["x"][b] for a, b in zip(step.old, step.new))


def fault_of(step, operation, arguments):
    if operation == "remove":
        return fault_of_removal(step, arguments[0])
    if operation == "duplicate":
        wanted = int(arguments[1]) * len(step.old)
        return "" if len(step.new) == wanted else f"{len(step.new)} splats in place of {wanted}"
    return fault_of_transform(step, arguments[0], arguments[1])


def verdict_on(folder, plan):
    """(splats before, after, verdict) of the first way to do a plan."""
    steps = STEP.findall(plan.split("|")[0])
    folders = sorted(path.parent for path in folder.glob("[0-9]*/scene.ply")) or [folder]
    if not (folders[0] / "scene.ply").exists():
        return "-", "-", "nothing was made"
    if len(folders) != len(steps):
        return "-", "-", f"{len(folders)} of {len(steps)} steps"
    counts, faults = [], []
    for path, (operation, text) in zip(folders, steps):
        if operation not in REARRANGED:
            continue
        step = Step(path)
        counts.append(step.counts())
        fault = fault_of(step, operation, [word.strip() for word in text.split(",")])
        if fault:
            faults.append(fault)
    return counts[0][0], counts[-1][1], "; ".join(faults) or "right"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--count", type=int, default=0)
    parser.add_argument("--seed", type=int, default=1)
    given, _, options = " ".join(sys.argv[1:]).partition(" -- ")
    arguments = parser.parse_args(given.split())
    arguments.out.mkdir(parents=True, exist_ok=True)
    sentences = suite()
    count = min(arguments.count or len(sentences), len(sentences))
    chosen = random.Random(arguments.seed).sample(sentences, count)
    cells, lines = [], ["number\tid\tsentence\texit code\tbefore\tafter\tverdict\tsaid\tplan"]
    for number, (name, words, sentence, plan) in enumerate(sorted(chosen), 1):
        folder = arguments.out / name
        scene = hatted_scene(arguments.program, arguments.out, words)
        outcome = sentence_sheet.run_one(arguments.program, folder, sentence,
                                         ["--words", words, *options.split()], scene)
        before, after, verdict = verdict_on(folder, plan)
        said = " / ".join(outcome["said"].splitlines())
        lines.append("\t".join([str(number), name, " ".join(sentence.split()), str(outcome["exit_code"]),
                                str(before), str(after), verdict, said, plan]))
        print(lines[-1], flush=True)
        cells.append(sentence_sheet.cell_of(number, folder))
        (arguments.out / "table.tsv").write_text("\n".join(lines) + "\n")
    (arguments.out / "verdicts.json").write_text(json.dumps(
        {line.split("\t")[1]: line.split("\t")[6] for line in lines[1:]}, indent=1))
    sentence_sheet.write_sheets(arguments.out, cells)


if __name__ == "__main__":
    main()
