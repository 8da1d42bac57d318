#!/usr/bin/env python3
"""Checks what the desktop reads: desktop file, MIME types and icon are well formed and speak of each other."""
import configparser
import pathlib
import re
import sys
import tempfile
import xml.etree.ElementTree as xml

MIME = "{http://www.freedesktop.org/standards/shared-mime-info}"
# What the Desktop Entry Specification asks of an application, and what file managers need to open files with it.
DESKTOP_KEYS = {"Type": "Application", "Name": None, "Comment": None, "Exec": None, "Icon": None, "Categories": None,
                "MimeType": None, "Terminal": "false"}
LISTS = {"Categories", "MimeType", "Keywords"}
READERS = "engine/io/scene/scene_file.cpp"   # its table of readers names the suffixes
READER = re.compile(r'\{"([a-z.]+)",\s*detect_')
PROJECT = ".gsep"


def desktop_entry(path):
    parser = configparser.ConfigParser(interpolation=None, strict=True)
    parser.optionxform = str
    parser.read_string(path.read_text())
    return dict(parser["Desktop Entry"]), parser.sections()


def check_desktop(path):
    try:
        entry, sections = desktop_entry(path)
    except (configparser.Error, KeyError) as failure:
        yield f"{path.name}: is no desktop entry ({failure})"
        return
    if sections[0] != "Desktop Entry":
        yield f"{path.name}: the first group is not [Desktop Entry]"
    for key, wanted in DESKTOP_KEYS.items():
        if key not in entry or not entry[key] or (wanted and entry[key] != wanted):
            yield f"{path.name}: {key} is {entry.get(key, 'missing')}"
    for key in LISTS & entry.keys():
        if not entry[key].endswith(";"):
            yield f"{path.name}: the list {key} does not end in a semicolon"
    if not re.fullmatch(r"gseditpro open %[fF]", entry.get("Exec", "")):
        yield f"{path.name}: Exec does not open a file"


def mime_types(path):
    """Type -> glob patterns."""
    root = xml.parse(path).getroot()
    if root.tag != MIME + "mime-info":
        raise xml.ParseError(f"the root is {root.tag}")
    types = {}
    for entry in root.findall(MIME + "mime-type"):
        if entry.find(MIME + "comment") is None:
            raise xml.ParseError(f"{entry.get('type')} has no comment")
        types[entry.get("type")] = [glob.get("pattern") for glob in entry.findall(MIME + "glob")]
    return types


def check_types(root):
    path = root / "packaging/gseditpro-mime.xml"
    try:
        types = mime_types(path)
    except xml.ParseError as failure:
        yield f"{path.name}: {failure}"
        return
    suffixes = ["." + name for name in READER.findall((root / READERS).read_text())] + [PROJECT]
    if len(suffixes) < 6:
        yield f"{READERS}: the table of readers is not found any more"
    globs = [glob for patterns in types.values() for glob in patterns]
    for suffix in suffixes:
        if not any(glob.startswith("*.") and suffix.endswith(glob[1:]) for glob in globs):
            yield f"{path.name}: no type has files named *{suffix}"
    for type_name, patterns in types.items():
        if not patterns:
            yield f"{path.name}: {type_name} has no pattern"
    entry, _ = desktop_entry(root / "packaging/gseditpro.desktop")
    opened = set(entry.get("MimeType", "").strip(";").split(";"))
    for type_name in opened ^ set(types):
        yield f"{type_name} is named by only one of desktop file and {path.name}"


def check_icon(root):
    entry, _ = desktop_entry(root / "packaging/gseditpro.desktop")
    path = root / f"packaging/{entry.get('Icon')}.svg"
    if not path.is_file():
        yield f"{path.name}: the icon of the desktop file is missing"
        return
    try:
        icon = xml.parse(path).getroot()
    except xml.ParseError as failure:
        yield f"{path.name}: {failure}"
        return
    if icon.tag != "{http://www.w3.org/2000/svg}svg" or not icon.get("viewBox"):
        yield f"{path.name}: is no picture of a stated shape"
    names = {element.get("id") for element in icon.iter()}
    for name in re.findall(r"url\(#([^)]*)\)", path.read_text()):
        if name not in names:
            yield f"{path.name}: there is no \"{name}\""


def check(root):
    yield from check_desktop(root / "packaging/gseditpro.desktop")
    yield from check_types(root)
    yield from check_icon(root)


def self_test(root):
    """Every rule is broken once in a copy; each must be seen."""
    cases = {
        "gseditpro.desktop": [("Type=Application", "Type=Link"), ("Terminal=false", "Terminal=true"), ("open %f", "open"),
                              ("Icon=gseditpro", "Icon=other"), ("model/x-spz;", ""), ("3DGraphics;", "3DGraphics"),
                              ("[Desktop Entry]", "[Entry]")],
        "gseditpro-mime.xml": [("</mime-info>", ""), ('"*.sog"', '"*.sg"'), ('"*.gsep"', '"*.gse"'), ('"*.ply"', '"*.pl"'),
                               ("<comment>GSEditPro project</comment>", ""), ("model/x-ksplat", "model/x-k"),
                               ("shared-mime-info\"", "other\"")],
        "gseditpro.svg": [("</svg>", ""), ('id="fur"', 'id="hair"'), ("viewBox", "box")],
    }
    missed = 0
    for name, changes in cases.items():
        for before, after in changes:
            with tempfile.TemporaryDirectory() as folder:
                copy = pathlib.Path(folder)
                for part in ["packaging/" + other for other in cases] + [READERS]:
                    (copy / part).parent.mkdir(parents=True, exist_ok=True)
                    text = (root / part).read_text()
                    (copy / part).write_text(text.replace(before, after) if part.endswith("/" + name) else text)
                try:
                    seen = list(check(copy))
                except (configparser.Error, KeyError):
                    seen = ["unreadable"]
                if not seen:
                    missed += 1
                    print(f"{name}: {before} -> {after} was not seen")
    print(f"{missed} broken rules were missed")
    return missed


if __name__ == "__main__":
    if sys.argv[1] == "--self-test":
        sys.exit(1 if self_test(pathlib.Path(sys.argv[2])) else 0)
    violations = list(check(pathlib.Path(sys.argv[1])))
    print("\n".join(violations) if violations else "desktop file, types and icon agree")
    sys.exit(1 if violations else 0)
