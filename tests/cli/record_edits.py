#!/usr/bin/env python3
"""Records the bytes and figures of a fixed list of edits, and compares two such records.

    record_edits.py PROGRAM --out SUMS.json [--only NAME ...] [--keep FOLDER]
    record_edits.py --compare BEFORE.json AFTER.json
    record_edits.py --list

Recording runs each recipe once, headless and without the answer cache. The record holds the exit code, the
sha256 of scene.ply and source.ply, and the report in a canonical form. Times, memory, paths and versions are
left out of it. Comparing prints one line per recipe and field that differs, and exits 1 where there is one.
"""
import argparse
import hashlib
import json
import os
import pathlib
import random
import struct
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
SHARED = pathlib.Path(os.environ.get("GSE_SHARED") or ROOT / "../shared").resolve()
STARTER = ROOT / "assets/models/starter"
BEAR = str(ROOT / "assets/scenes/bear/scene.ply")
CAMERAS = str(ROOT / "assets/scenes/bear/cameras.json")
FILM = ["--turntable-size", "32", "--turntable-frames", "2"]   # the film is no part of the record
MISSING = "not there"

# ---- recipes ----------------------------------------------------------------------------------------------


def bear(sentence, *arguments, source="bear", scene=BEAR):
    """The arguments of an edit of the bundled scene."""
    return [scene, "--source", source, "--prompt", sentence, *arguments]


def scan(path, source, sentence, *arguments):
    """The arguments of an edit of a scanned scene."""
    return [str(SHARED / "data" / path), "--source", source, "--prompt", sentence, *arguments]


SDS = ["--method", "sds", "--iterations", "40"]
TUNED = ["--dreambooth", "--dreambooth-steps", "6", "--dreambooth-class-images", "2",
         "--dreambooth-class-steps", "2"]
HAT = "a bear wearing a blue hat on the grass"

# {out}: the folder of another recipe's results; such a recipe stands behind the one that it needs. {lora}: a
# LoRA with random weights.
RECIPES = {
    "recolour": bear("a blue bear on the grass"),
    "material": bear("a golden bear on the grass", "--method", "auto", "--mode", "modify", "--target",
                     "golden"),
    "draft": bear("a wooden bear on the grass", "--quality", "draft", "--method", "views"),
    "fine": bear("a stone bear on the grass", "--quality", "fine"),
    "ground": bear("a bear on the snow", source="grass"),
    "dyed": bear("a dark pink bear on the grass"),
    "pattern": bear("a striped bear on the grass"),
    "metal": bear("a copper bear on the grass", "--seed", "5"),
    "replace": bear("a red cat on the grass"),
    "replace_fine": bear("a green frog on the grass", "--mode", "replace", "--quality", "fine"),
    "replace_draft": bear("a snowman on the grass", "--quality", "draft", "--shape-rounds", "2"),
    "worn": bear(HAT),
    "worn_draft": bear("a bear wearing a pink spotted scarf on the grass", "--quality", "draft", "--mode",
                       "add", "--target", "scarf"),
    "flames": bear("a bear in flames on the grass"),
    "beside": bear("a bear with a red ball beside it on the grass"),
    "under": bear("a bear with a red ball under it on the grass", "--quality", "draft"),
    "worn_again": bear("a bear wearing a golden hat", "--use-label", source="hat", scene="{worn}/edit.gsep"),
    "instead_of_hat": bear("a bear wearing a golden crown", "--use-label", source="hat",
                           scene="{worn}/edit.gsep"),
    "box": bear("a red toy on the grass", "--cut-out", ".25,.1,.75,.9", source="toy"),
    "box_ground": bear("a bear on the sand", "--cut-out", ".1,.6,.9,.95", source="ground"),
    "sds": bear("a golden bear on the grass", *SDS),
    "sds_add": bear(HAT, *SDS, "--no-gate-guidance"),
    "sds_replace": bear("a red cat on the grass", *SDS, "--mode", "replace"),
    "dreambooth": bear("a green bear on the grass", *TUNED),
    "dreambooth_lora": bear("a green bear on the grass", *TUNED, "--dreambooth-rank", "4", *SDS),
    "few_steps": bear("a green bear on the grass", "--lora", "{lora}"),
    "thresholds": bear("a purple bear on the grass", "--tau", "0.55", "--left-out", "3, 17",
                       "--attention-threshold", "0.4",
                       "--keep-mass", "0.3", "--fallback-mass", "0.4", "--second-look", "1", "--rivals",
                       "grass", "--no-focus"),
    "fit": bear("a yellow bear on the grass", "--strength", "1.2", "--colour-coupling", "0.5",
                "--view-strength", "0.6",
                "--rounds", "2", "--background", "grey", "--front", "none", "--image-size", "64"),
    "cameras": bear("a white bear on the grass", "--cameras", CAMERAS, "--up", "y"),
    "everything": bear("a red bear on the grass", "--no-localize", "--quality", "draft"),
    "attention": bear(HAT, "--place-views", "0", "--quality", "draft"),
    "variations": bear("an orange bear on the grass", "--variations", "2", "--quality", "draft"),
    "demo": ["--demo"],
    "refused_word": bear("a red submarine on the grass", source="submarine"),
    "refused_search": bear("a red bear on the grass", "--least-confidence", "0.999"),
    "scan_word": scan("scenes/statue_st-peter.sog", "statue", "a golden statue"),
    "scan_replace": scan("scenes/plant_lastchance.splat", "vase", "a yellow mushroom"),
    "scan_box": scan("scenes/person_biker.compressed.ply", "man", "a man wearing a red hat", "--cut-out",
                     ".41,.03,.59,.97,270,15,1"),
    "scan_cut_out": scan("real/scenes/vase_flowers.splat", "vase", "a blue vase", "--up", "z",
                         "--least-confidence", "0"),
}

# ---- the canonical report ---------------------------------------------------------------------------------

# Keys of a report that had another name before: old name -> new name.
RENAMED = {
    "rivals": "competing_words", "second_look": "retry_passes", "keep_mass": "min_cluster_mass",
    "fallback_mass": "min_segment_attention", "evidence_px": "coverage_px", "focus": "reframe_views",
           "tau": "label_threshold",
    "left_out": "excluded_views", "look_again": "prune_added", "look_again_tau": "prune_added_threshold",
}
# Keys that hold times, memory, paths or versions, and one of a setting that is gone.
LEFT_OUT = {"seconds", "class_seconds", "peak_rss_mb", "version", "model", "scene", "cameras", "lora",
            "cached", "polish_steps"}

def canonical(value, key=""):
    """The report with its keys under their new names, without what differs from run to run."""
    if key == "files":   # sizes and fingerprints of some hold times; of the evidence there are sums
        return sorted(name for name in value if not name.startswith("evidence/"))
    if key == "settings_from" and isinstance(value, list):
        fields = {entry["field"].split(".")[-1]: [entry["value"], entry["source"]] for entry in value}
        return canonical(fields)
    if isinstance(value, list):
        return [canonical(entry) for entry in value]
    if not isinstance(value, dict):
        return value
    names = {name: RENAMED.get(name, name) for name in value if name not in LEFT_OUT}
    return {new: canonical(value[name], new) for name, new in names.items()}


def sha256(data):
    return hashlib.sha256(data).hexdigest()


def evidence_sums(folder):
    """One sum for the pictures of each kind: the renders of all views, the attention of all views, and so
    on."""
    kinds = {}
    for path in sorted(folder.glob("*")):
        kind = path.stem.split("_")[-1] if path.stem.startswith("view_") else path.stem
        kinds.setdefault(kind, hashlib.sha256()).update(path.name.encode() + path.read_bytes())
    return {kind: digest.hexdigest() for kind, digest in kinds.items()}


def record_folder(folder):
    """The record of one folder of results."""
    entry = {}
    for name in ("scene.ply", "source.ply"):
        path = folder / name
        entry[name] = sha256(path.read_bytes()) if path.exists() else MISSING
    entry["evidence"] = evidence_sums(folder / "evidence")
    for name in ("report", "recipe"):
        path = folder / f"{name}.json"
        entry[name] = canonical(json.loads(path.read_text())) if path.exists() else MISSING
    entry["report_sum"] = sha256(json.dumps(entry["report"], sort_keys=True).encode())
    return entry

# ---- recording --------------------------------------------------------------------------------------------


def lora_bytes(rank=2, size=0.05):
    """A LoRA with random weights, by kohya's names, for the values of the bundled model's cross-attention."""
    with (STARTER / "unet/diffusion_pytorch_model.safetensors").open("rb") as file:
        shapes = json.loads(file.read(struct.unpack("<Q", file.read(8))[0]))
    draw, header, data = random.Random(3), {}, b""
    for layer in sorted(name for name in shapes if name.endswith("attn2.to_v.weight")):
        stem = "lora_unet_" + layer.removesuffix(".weight").replace(".", "_")
        rows, columns = shapes[layer]["shape"]
        for name, shape in (("lora_down.weight", [rank, columns]), ("lora_up.weight", [rows, rank]),
                            ("alpha", [])):
            count = shape[0] * shape[1] if shape else 1
            values = [draw.gauss(0, size) if shape else float(rank) for _ in range(count)]
            header[f"{stem}.{name}"] = {"dtype": "F32", "shape": shape,
                                        "data_offsets": [len(data), len(data) + 4 * count]}
            data += struct.pack(f"<{count}f", *values)
    text = json.dumps(header).encode()
    return struct.pack("<Q", len(text)) + text + data


def filled(argument, results):
    """The argument with the paths of files that the recording itself makes."""
    for name in ("lora", *RECIPES):
        argument = argument.replace("{" + name + "}",
                                    str(results / ("lcm.safetensors" if name == "lora" else name)))
    return argument


def record(program, name, results):
    """Runs one recipe; returns its part of the record."""
    out = results / name
    command = [program, "-q", "edit", *(filled(argument, results) for argument in RECIPES[name]), *FILM,
               "--headless", "--no-cache",
               "--out", str(out)]
    process = subprocess.run(command, capture_output=True, text=True, errors="replace")
    entry = {"exit_code": process.returncode}
    if process.returncode != 0:
        entry["message"] = process.stderr.replace(str(results), "").strip().splitlines()
    folders = sorted(path for path in out.iterdir() if path.is_dir()
                     and path.name.isdigit()) if out.exists() else []
    found = pathlib.Path(str(out) + ".search")
    for folder in folders or [found if found.exists() else out]:
        entry["/".join(["results", folder.name] if folders else ["results"])] = record_folder(folder)
    return entry


def needed(name):
    """The recipes that have to run before this one."""
    return [other for other in RECIPES if any("{" + other + "}" in argument for argument in RECIPES[name])]


def record_all(program, names, results, out):
    """Runs the recipes in order. The record is written after each: one that is stopped holds what was
    reached."""
    (results / "lcm.safetensors").write_bytes(lora_bytes())
    wanted = set(names) | {other for name in names for other in needed(name)}
    sums = {}
    for name in (name for name in RECIPES if name in wanted):
        begin = time.monotonic()
        sums[name] = record(program, name, results)
        out.write_text(json.dumps(sums, indent=1) + "\n")
        print(f"{name}: exit code {sums[name]['exit_code']}, {time.monotonic() - begin:.1f} s", flush=True)

# ---- comparing --------------------------------------------------------------------------------------------


def leaves(value, path=""):
    """(path, value) of everything that is neither a dictionary nor a list; an empty one is a leaf."""
    if isinstance(value, dict) and value:
        for name in value:
            yield from leaves(value[name], f"{path}.{name}" if path else name)
    elif isinstance(value, list) and value:
        for index, entry in enumerate(value):
            yield from leaves(entry, f"{path}[{index}]")
    else:
        yield path, value


def field_of(path):
    """The path without the positions in lists."""
    return "".join(part.split("]", 1)[-1] if i else part for i, part in enumerate(path.split("[")))


def differences(before, after):
    """Lines about the recipes and fields that differ. A recipe that only one of the records holds is a
    difference."""
    lines = []
    for name in [*before, *(name for name in after if name not in before)]:
        if name not in before or name not in after:
            lines.append(f"{name}: only in the {'first' if name in before else 'second'} record")
            continue
        old, new = (dict(leaves(canonical(record[name]))) for record in (before, after))
        fields = {}
        for path in [*old, *(path for path in new if path not in old)]:
            values = old.get(path, MISSING), new.get(path, MISSING)
            if values[0] != values[1] and not path.endswith("report_sum"):
                fields.setdefault(field_of(path), []).append(values)
        for field, values in fields.items():
            more = f" (and {len(values) - 1} more)" if len(values) > 1 else ""
            lines.append(f"{name}: {field}: {values[0][0]} -> {values[0][1]}{more}")
    return lines


def compare(before, after):
    lines = differences(*(json.loads(pathlib.Path(path).read_text()) for path in (before, after)))
    print("\n".join(lines) if lines else "no differences")
    return 1 if lines else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", nargs="?", help="gseditpro")
    parser.add_argument("--out", type=pathlib.Path, help="file for the record")
    parser.add_argument("--only", nargs="+", default=list(RECIPES), choices=list(RECIPES), metavar="NAME",
                        help="recipes to run")
    parser.add_argument("--keep", type=pathlib.Path,
                        help="folder for the results themselves; without it they are deleted")
    parser.add_argument("--compare", nargs=2, metavar=("BEFORE", "AFTER"), help="records to compare")
    parser.add_argument("--list", action="store_true", help="print the recipes")
    options = parser.parse_args()
    if options.list:
        for name, arguments in RECIPES.items():
            print(name + ":", " ".join(arguments))
        return 0
    if options.compare:
        return compare(*options.compare)
    if not options.program or not options.out:
        parser.error("PROGRAM and --out are needed")
    with tempfile.TemporaryDirectory(prefix="gse-record-") as folder:
        results = options.keep or pathlib.Path(folder)
        results.mkdir(parents=True, exist_ok=True)
        record_all(os.path.abspath(options.program), options.only, results.resolve(), options.out)
    return 0


if __name__ == "__main__":
    sys.exit(main())
