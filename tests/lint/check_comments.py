#!/usr/bin/env python3
"""Holds doc comments and help texts to their form: a noun or verb first, short sentences, documents that
exist."""
import pathlib
import re
import sys
import tempfile

ROOMS = ("app", "ui", "engine", "shaders", "tests")
SUFFIXES = {".h", ".cpp", ".inl", ".cu", ".comp"}
MOST_WORDS = 30
BEGINNINGS = re.compile(r"(What|The same|Of|Where|Whether)\b")
# Stops that end no sentence.
ABBREVIATION = re.compile(r"\b(e\.g|i\.e|et al|vs|cf|Eq|Sec|Fig|etc|St|p|pp|No)\.(?=\s)")
CITED = re.compile(r"\b([\w-]+)\.md\b(,? (\d+(?:\.\d+)*)\b)?")
# Sections of documents that lay beside the repository once.
OUTSIDE = re.compile(r"\b(?:method|views|raster|formats|design|style) [A-Z]?\d+(?:\.\d+)*\b(?! ?(?:px|%|MB))")
LITERAL = r'"((?:\\.|[^"\\])*)"'
LITERALS = re.compile(LITERAL)
FIELD_HELP = re.compile(r'\bf\(\s*"[a-z_0-9]+",\s*self\.[\w.]+,\s*(?:\w+\(\s*)?((?:' + LITERAL + r'\s*)+)')
OPTION_HELP = re.compile(r'\badd_(?:option|flag|subcommand)\(\s*"[^"]*",(?:\s*[\w.\->&*\[\]]+,)?\s*((?:'
                         + LITERAL + r'\s*)+)\)')


def comment_blocks(lines):
    """Yields (line number, text) of the comment that begins the file, and of every block of /// lines."""
    block, first = [], 0
    in_head = True
    for number, line in enumerate(lines + [""], 1):
        text = line.strip()
        doc = re.match(r"///(?!/) ?(.*)", text)
        head = re.match(r"//(?!/) ?(.*)", text) if in_head else None
        if block and (not (doc or head) or (doc and in_head)):
            yield first, "\n".join(block)
            block = []
        in_head = head is not None
        if doc or head:
            first = first if block else number
            block.append((doc or head).group(1))


def help_texts(text):
    """Yields (line number, text) of descriptions in lists of fields and in options of the command line."""
    for pattern in (FIELD_HELP, OPTION_HELP):
        for found in pattern.finditer(text):
            yield text[:found.start()].count("\n") + 1, "".join(LITERALS.findall(found.group(1)))


def sentences(text):
    text = "\n".join(line for line in text.split("\n") if not line.startswith("|"))   # no tables
    # A line that ends in ";" or ":" ends an entry of a list, as a blank line ends a paragraph.
    for paragraph in re.split(r"\n\s*\n|\n(?=\s*(?:[-*] |\d+\. ))|(?<=[;:])\n", text):
        if all(line.startswith("  ") for line in paragraph.split("\n") if line.strip()) and "\n\n" in text:
            continue   # an example in code, or a formula
        plain = re.sub(r"\s+", " ", paragraph).strip()
        plain = ABBREVIATION.sub(lambda found: found.group(0)[:-1], plain)
        yield from re.split(r"(?<=[.!?])[)\"]? (?=[\"(`\[A-Z0-9])|(?<=[.!?]) (?=[a-z_]+\()", plain)


def word_count(sentence):
    return sum(1 for word in sentence.split() if re.search(r"\w", word))


def check_text(text, documents):
    begins = BEGINNINGS.match(text.lstrip())
    if begins:
        yield f"begins with \"{begins.group(1)}\""
    for sentence in sentences(text):
        words = word_count(sentence)
        if words > MOST_WORDS:
            yield f"{words} words in one sentence: \"{sentence[:60]}...\""
    for cited in OUTSIDE.findall(text):
        yield f"\"{cited}\" is no document of the repository"
    for name, section, number in CITED.findall(text):
        if name not in documents:
            yield f"{name}.md is not in the repository"
        elif section and not any(heading.startswith(number) for heading in documents[name]):
            yield f"{name}.md has no section {number}"


def documents_of(root):
    """Name -> headings of every document."""
    found = {}
    for path in root.rglob("*.md"):
        if not {"build", "out"} & set(path.relative_to(root).parts):
            found.setdefault(path.stem,
                             []).extend(re.findall(r"^#+ (.*)$", path.read_text(errors="replace"), re.M))
    return found


def check_file(root, path, documents):
    relative = path.relative_to(root)
    text = path.read_text(encoding="utf-8", errors="replace")
    for kind, texts in (("", comment_blocks(text.split("\n"))), ("a help text ", help_texts(text))):
        for number, block in texts:
            for problem in check_text(block, documents):
                yield f"{relative}:{number}: {kind}{problem}"


def check(root, rooms):
    documents = documents_of(root)
    for room in rooms:
        for path in sorted((root / room).rglob("*")):
            if path.suffix in SUFFIXES and path.is_file():
                yield from check_file(root, path, documents)


def self_test():
    """Every rule is broken once; each must be seen, and what keeps them must pass."""
    words = "word " * 20
    long = "word " * (MOST_WORDS + 1)
    head = "// A file.\n"
    broken = {
        "what.h": "// What it is.\n", "same.h": head + "/// The same at the end.\nint x;\n",
              "of.h": head + "    /// Of a view.\n",
        "whether.h": head + "/// Whether it is.\nint x;\n",
        "where.h": head + "/// Where it lies.\n", "long.h": head + "/// Short. " + long + ".\n",
        "lines.h": head + "/// " + "word " * 20 + "\n/// " + "word " * 20 + "\n",
              "head.h": "// " + long + "\n",
        "document.h": head + "/// Weights (method.md 6.4).\n",
              "outside.h": head + "/// Weights (method 6.4).\n",
              "section.h": head + "/// Weights (MANUAL.md, 6).\n",
        "field.h": head + 'f("count", self.count, "Of the views " "of it.", Range{0, 1});\n',
        "option.cpp": head + 'command->add_option("--out", options->output, "' + long + '");\n',
        "command.cpp": head + 'app.add_subcommand("edit", "What changes");\n',
    }
    whole = {
        "good.h": head + "/// Count of words, e.g. Three. " + words + ".\n///\n/// " + words +
                  "\n/// - " + words + "\n/// - " + words + "\n///\n///   code(" + long + ");\n///\n/// End.\n"
                  "int x;  // of a view\n// What follows is no doc comment.\n/// See MANUAL.md, Labels.\n",
        "help.h": head + 'f("count", self.count, "Views that vote.", Range{0, 1});\ng("What");\n',
    }
    missed = []
    for name, text in {**broken, **whole}.items():
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            (root / "engine").mkdir()
            (root / "MANUAL.md").write_text("# Method\n\n## Labels\n")
            (root / "engine" / name).write_text(text)
            seen = list(check(root, ["engine"]))
        if bool(seen) != (name in broken):
            missed.append(f"{name}: {seen}")
    print("\n".join(missed + [f"{len(missed)} cases were judged wrong"]))
    return len(missed)


def main():
    if sys.argv[1:] == ["--self-test"]:
        return 1 if self_test() else 0
    root = pathlib.Path(sys.argv[1]).resolve()
    rooms = sys.argv[2:]   # named ones are checked whole
    violations = list(check(root, rooms or ROOMS))
    print("\n".join(violations) if violations else "comments and help texts keep their form")
    return 1 if violations else 0


if __name__ == "__main__":
    sys.exit(main())
