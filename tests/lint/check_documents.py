#!/usr/bin/env python3
"""Holds the documents to what is there: length of the README, links, cited sections, commands and options of
the programs."""
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

README_LINES = 200
MEAN_WORDS, MOST_WORDS = 15, 30   # of a sentence in the README and the guide
PROGRAMS = {"gseditpro", "gseditpro-lab"}
WRAPPERS = {"packaging/run": "gseditpro", "build/release/gseditpro": "gseditpro",
            "build/release/gseditpro-lab": "gseditpro-lab"}
LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")
FENCE = re.compile(r"^```.*?^```", re.M | re.S)
COMMAND_FENCE = re.compile(r"^```sh\n(.*?)^```", re.M | re.S)
CODE = re.compile(r"`([^`]+)`")
# studies that are not in the repository
GONE = re.compile(r"(?<![\w/])(?:method|views|formats|starter|ux|goldens)\.md\b")
CITATION = re.compile(r"\b([A-Z]{4,})\.md, \"?([A-Z][\w ,-]*)")
SOURCES = ("app", "ui", "engine", "shaders", "tests", "packaging")
SUFFIXES = {".h", ".cpp", ".cu", ".inl", ".comp", ".py", ".cmake"}


class Programs:
    """Options that `--help` of the programs lists: program -> command -> options."""

    def __init__(self, paths):
        self.paths = {pathlib.Path(path).name: path for path in paths}
        self.known = {}

    def help(self, program, *command):
        key = (program, *command)
        if key not in self.known:
            run = subprocess.run([self.paths[program], *command, "--help"], capture_output=True, text=True)
            self.known[key] = run.stdout if run.returncode == 0 else ""
        return self.known[key]

    def commands(self, program, *command):
        text = self.help(program, *command)
        _, _, rest = text.partition("Subcommands:")
        return set(re.findall(r"^  ([a-z][a-z-]*)\b", rest, re.M))

    def options(self, program, *command):
        return set(re.findall(r"(?<![\w-])(--?[A-Za-z][\w-]*)", self.help(program, *command)))

    def all_options(self):
        found = set()
        for program in self.paths:
            found |= self.options(program)
            for command in self.commands(program):
                found |= self.options(program, command)
                for below in self.commands(program, command):
                    found |= self.options(program, command, below)
        return found


def anchor_of(heading):
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def headings(path):
    return re.findall(r"^#+ (.*)$", FENCE.sub("", path.read_text()), re.M)


def citable(path):
    """Places of a document that sources may cite: headings, and first cells of tables ("SKIPS.md, E5")."""
    cells = re.findall(r"^\| *([\w ]+?) *\|", path.read_text(), re.M)
    return {title.lower() for title in headings(path) + cells}


def documents(root):
    listed = subprocess.run(["git", "-C", str(root), "ls-files", "-co", "--exclude-standard", "*.md"],
                            capture_output=True, text=True)
    if listed.returncode == 0:
        return [root / name for name in listed.stdout.splitlines() if (root / name).is_file()]
    return [path for path in sorted(root.rglob("*.md")) if "build" not in path.relative_to(root).parts]


def check_links(root, path):
    for target in LINK.findall(FENCE.sub("", path.read_text())):
        if re.match(r"[a-z]+:", target):
            continue
        name, _, anchor = target.partition("#")
        file = path if not name else (path.parent / name).resolve()
        if not file.exists():
            yield f"{path.relative_to(root)}: the link {target} leads nowhere"
        elif anchor and file.suffix == ".md" and anchor not in {anchor_of(text) for text in headings(file)}:
            yield f"{path.relative_to(root)}: {target}: there is no such heading"


def sentences(text):
    """Sentences of the prose: no code, no tables, no headings."""
    text = FENCE.sub("\n\n", text)
    lines = [line for line in text.splitlines() if not re.match(r"\s*(#|\||<!--|!\[)", line)]
    prose = re.sub(r"\n(?=- |\d+\. |\n)", "\n\n", "\n".join(lines))
    for paragraph in re.split(r"\n\s*\n", prose):
        plain = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", CODE.sub("code", paragraph))
        plain = re.sub(r"^\s*(- |\d+\. )", "", plain).replace("*", "").replace("\n", " ")
        yield from (part for part in re.split(r"(?<=[.!?])\s+", plain) if re.search(r"[a-z]", part))


def check_prose(root, path):
    counts = []
    for sentence in sentences(path.read_text()):
        words = len(sentence.split())
        counts.append(words)
        if words > MOST_WORDS:
            yield f"{path.relative_to(root)}: {words} words in one sentence: \"{sentence[:60]}...\""
    if counts and sum(counts) / len(counts) > MEAN_WORDS:
        yield f"{path.relative_to(root)}: {sum(counts) / len(counts):.1f} words a sentence on average"


def command_lines(text):
    for fence in COMMAND_FENCE.findall(text):
        yield from fence.replace("\\\n", " ").splitlines()
    for code in CODE.findall(FENCE.sub("", text)):
        if code.split()[0] in PROGRAMS | set(WRAPPERS):
            yield code


def words_of(line):
    try:
        return shlex.split(line, comments=True)
    except ValueError:
        return line.split()


def check_command(line, programs):
    words = words_of(line.strip())
    if not words:
        return
    program = WRAPPERS.get(words[0], words[0])
    if program not in programs.paths:
        return
    command, rest = [], words[1:]
    while rest and rest[0] in programs.commands(program, *command):
        command.append(rest.pop(0))
    if not command and rest and re.fullmatch(r"[a-z][a-z-]*", rest[0]):
        yield f"\"{line.strip()}\": {program} has no command {rest[0]}"
    known = programs.options(program, *command) | programs.options(program)
    for word in rest:
        option = word.partition("=")[0].rstrip(",;")
        if re.fullmatch(r"--?[A-Za-z][\w-]*", option) and option not in known:
            yield f"\"{line.strip()}\": there is no option {option}"


def check_commands(root, path, programs):
    text = path.read_text()
    for line in command_lines(text):
        for problem in check_command(line, programs):
            yield f"{path.relative_to(root)}: {problem}"
    for code in CODE.findall(FENCE.sub("", text)):
        option = code.split()[0]
        if re.fullmatch(r"--[a-z][\w-]*", option) and option not in programs.all_options():
            yield f"{path.relative_to(root)}: no command has the option {option}"


def check_citations(root, titles):
    for folder in SOURCES:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix not in SUFFIXES or path == pathlib.Path(__file__).resolve():
                continue
            text = re.sub(r"\n\s*(///?|#|\*) ?", " ", path.read_text(errors="replace"))
            for study in () if path.parent.name == "lint" else GONE.findall(text):
                yield f"{path.relative_to(root)}: cites {study}, which is not there"
            for name, cited in CITATION.findall(text):
                if name in titles and not any(cited.lower().startswith(title) for title in titles[name]):
                    yield f"{path.relative_to(root)}: {name}.md has no section \"{cited.strip()}\""


def check_guide(root, programs):
    """The guide as HTML: it can be made, and its links lead somewhere."""
    with tempfile.TemporaryDirectory() as folder:
        run = subprocess.run([sys.executable, str(root / "packaging/guide"), programs.paths["gseditpro"],
                              str(next((root / "ui").rglob("keys.h"), root)), folder], capture_output=True,
                             text=True)
        if run.returncode != 0:
            yield f"packaging/guide: {run.stderr.strip()}"
            return
        for page in pathlib.Path(folder).glob("*.html"):
            text = page.read_text()
            for target in re.findall(r'(?:href|src)="([^"#:]+)(?:#[^"]*)?"', text):
                if not (page.parent / target).exists():
                    yield f"{page.name}: {target} is not in the guide"
            for mark in re.findall(r"<!-- (?:help|keys).*?-->", text):
                yield f"{page.name}: {mark} was not filled in"


def check(root, program_paths):
    root = root.resolve()
    lines = len((root / "README.md").read_text().splitlines())
    if lines > README_LINES:
        yield f"README.md: {lines} lines, {README_LINES} are allowed"
    programs = Programs(program_paths)
    titles = {}
    for path in documents(root):
        titles[path.stem] = citable(path)
        yield from check_links(root, path)
        artists = path == root / "README.md" or path.parent == root / "assets/guide"
        if artists:
            yield from check_prose(root, path)
        if program_paths and (artists
                              or path.name in {"CONTRIBUTING.md", "FIGURES.md", "METHOD.md",
                                               "ARCHITECTURE.md"}):
            yield from check_commands(root, path, programs)
    yield from check_citations(root, titles)
    if program_paths:
        yield from check_guide(root, programs)


def self_test():
    """Every rule is broken once in a small tree; each must be seen."""
    good = {"README.md": "# A\n\nShort text with `--out`, [b](B.md#second-part).\n\n"
                         "```sh\ngseditpro edit --out x   # why\n```\n",
            "B.md": "# Second part\n", "engine/METHOD.md": "# M\n\n## Label voting\n",
            "engine/a.h": "// METHOD.md, Label voting.\n", "assets/guide/index.md": "# G\n\nText.\n"}
    broken = [("README.md", "Short", "Short\n" * 201), ("README.md", "Short", "Short " + "word " * 40),
              ("README.md", "B.md", "C.md"),
              ("README.md", "second-part", "third"), ("README.md", "edit --out", "edt --out"),
              ("README.md", "edit --out", "edit --ot"),
              ("README.md", "`--out`", "`--ou`"), ("engine/a.h", "Label voting", "Label counting"),
              ("engine/a.h", "METHOD.md", "views.md")]
    missed = 0
    for name, before, after in [("README.md", "Short", "Short")] + broken:
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder) / "tree"
            for other, text in good.items():
                (root / other).parent.mkdir(parents=True, exist_ok=True)
                (root / other).write_text(text.replace(before, after) if other == name else text)
            program = pathlib.Path(folder) / "gseditpro"
            program.write_text('#!/bin/sh\nif [ "$1" = edit ]; then echo "  --out TEXT"; '
                           'else printf "Subcommands:\\n  edit  x\\n"; fi\n')
            program.chmod(0o755)
            seen = [problem for problem in check(root, [str(program)])
                    if not problem.startswith("packaging/guide")]
        if bool(seen) != (before != after):
            missed += 1
            print(f"{name}: {before} -> {after}: {seen}")
    print(f"{missed} cases were judged wrong")
    return missed


if __name__ == "__main__":
    if sys.argv[1] == "--self-test":
        sys.exit(1 if self_test() else 0)
    violations = list(check(pathlib.Path(sys.argv[1]), sys.argv[2:]))
    print("\n".join(violations) if violations else "the documents agree with what is there")
    sys.exit(1 if violations else 0)
