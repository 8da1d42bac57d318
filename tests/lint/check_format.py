#!/usr/bin/env python3
"""Holds the sources to .clang-format and every line to 110 columns; prints one line per file or line that
breaks it.
check_format.py ROOT, or --self-test."""
import pathlib
import shutil
import subprocess
import sys
import tempfile

COLUMNS = 110
FORMATTED = {".h", ".cpp", ".inl", ".cu"}
# clang-format does not read these: their lines are counted alone.
COUNTED = {".comp", ".glsl", ".vert", ".frag", ".py", ".cmake", ".txt"}
ROOMS = ("app", "engine", "ui", "tests", "shaders", "packaging")
# Trainers for a GPU, written wider; files of data.
WIDER = ("packaging/train_", "tests/fuzz/corpus")
SKIP_CODE = 77


def sources(root, suffixes):
    return [path for room in ROOMS for path in sorted((root / room).rglob("*")) if path.suffix in suffixes
            and path.is_file()]


def long_lines(root):
    for path in sources(root, FORMATTED | COUNTED):
        if str(path.relative_to(root)).startswith(WIDER):
            continue
        for number, line in enumerate(path.read_text(encoding="utf-8").split("\n"), 1):
            literal = 'R"' in line or line.lstrip().startswith('"')   # text that cannot be broken
            if len(line) > COLUMNS and not literal:
                yield f"{path.relative_to(root)}:{number}: {len(line)} columns (at most {COLUMNS})"


def unformatted(root):
    files = sources(root, FORMATTED)
    for begin in range(0, len(files), 200):
        found = subprocess.run(["clang-format", "--dry-run", "--style=file",
                                *map(str, files[begin:begin + 200])],
                               cwd=root, capture_output=True, text=True).stderr
        names = {line.split(":")[0] for line in found.splitlines() if "[-Wclang-format-violations]" in line}
        yield from (f"{pathlib.Path(name).relative_to(root)}: run clang-format -i on it"
                    for name in sorted(names))


def violations(root):
    return [*long_lines(root), *unformatted(root)]


def self_test(style):
    """A file that is not formatted and a line that is too long are both found."""
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        shutil.copy(style, root / ".clang-format")
        for name, text in {"app/a.cpp": "// x\nint  a;\n", "shaders/b.comp": "// " + "x" * COLUMNS + "\n",
                           "tests/d.py": "# " + "x" * COLUMNS + "\n", "ui/c.cpp": "// x\nint c;\n"}.items():
            (root / name).parent.mkdir(exist_ok=True)
            (root / name).write_text(text)
        found = violations(root)
    wanted = ["tests/d.py:1", "shaders/b.comp:1", "app/a.cpp"]
    right = len(found) == 3 and all(name in line for name, line in zip(wanted, found))
    print("all are found" if right else f"found {found}")
    return 0 if right else 1


def main():
    root = pathlib.Path(__file__).resolve().parent.parent.parent
    if shutil.which("clang-format") is None:
        print("[skip] clang-format is not there")
        return SKIP_CODE
    if sys.argv[1:] == ["--self-test"]:
        return self_test(root / ".clang-format")
    found = violations(pathlib.Path(sys.argv[1]).resolve())
    print("\n".join(found) if found else "everything is formatted")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
