#!/usr/bin/env python3
"""Checks what the desktop reads: desktop file, MIME types and icon are well formed and speak of each other.
check_packaging.py SOURCE BUILD: the icon lies in SOURCE/packaging, the files that are made of templates in
BUILD/desktop."""
import configparser
import pathlib
import re
import sys
import tempfile
import xml.etree.ElementTree as xml

MIME = "{http://www.freedesktop.org/standards/shared-mime-info}"
# What the Desktop Entry Specification asks of an application, and what file managers need to open files with
# it.
DESKTOP_KEYS = {"Type": "Application", "Name": None, "Comment": None, "Exec": None, "Icon": None,
                "Categories": None,
                "MimeType": None, "Terminal": "false"}
LISTS = {"Categories", "MimeType", "Keywords"}
PROJECT = "*.gsep"
LABORATORY = ["gseditpro-lab", "gse_starter"]
PLACES = {"gseditpro.desktop": "desktop", "gseditpro-mime.xml": "desktop", "gseditpro.svg": "packaging",
          "GseInstall.cmake": "packaging/cmake"}


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
    path = root / "desktop/gseditpro-mime.xml"
    try:
        types = mime_types(path)
    except xml.ParseError as failure:
        yield f"{path.name}: {failure}"
        return
    if not any(PROJECT in patterns for patterns in types.values()):
        yield f"{path.name}: no type has files named {PROJECT}"
    if "@" in path.read_text():
        yield f"{path.name}: a mark of the template is left"
    for type_name, patterns in types.items():
        if not patterns:
            yield f"{path.name}: {type_name} has no pattern"
    entry, _ = desktop_entry(root / "desktop/gseditpro.desktop")
    opened = set(entry.get("MimeType", "").strip(";").split(";"))
    for type_name in opened ^ set(types):
        yield f"{type_name} is named by only one of desktop file and {path.name}"


def check_icon(root):
    entry, _ = desktop_entry(root / "desktop/gseditpro.desktop")
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


def check_installed(root):
    """The laboratory is built with the tests and stays in the build folder."""
    path = root / "packaging/cmake/GseInstall.cmake"
    for target in LABORATORY:
        if target in path.read_text():
            yield f"{path.name}: {target} is installed"


def check(root):
    yield from check_installed(root)
    yield from check_desktop(root / "desktop/gseditpro.desktop")
    yield from check_types(root)
    yield from check_icon(root)


def self_test(folders):
    """Every rule is broken once in a copy; each must be seen. Which endings have a type is a matter of
    tests/unit/io."""
    cases = {
        "gseditpro.desktop": [("Type=Application", "Type=Link"), ("Terminal=false", "Terminal=true"),
                              ("open %f", "open"),
                              ("Icon=gseditpro", "Icon=other"), ("model/x-spz;", ""),
                              ("3DGraphics;", "3DGraphics"),
                              ("[Desktop Entry]", "[Entry]")],
        "gseditpro-mime.xml": [("</mime-info>", ""), ('<glob pattern="*.sog" weight="60"/>', ""),
                               ('"*.gsep"', '"*.gse"'),
                               ("<comment>GSEditPro project</comment>", ""), ("model/x-ksplat", "model/x-k"),
                               ("shared-mime-info\"", "other\"")],
        "GseInstall.cmake": [("TARGETS gseditpro RUNTIME", "TARGETS gseditpro gseditpro-lab RUNTIME"),
                             ("gse_media gse_neural_plugin",
                              "gse_media gse_neural_plugin gse_starter_plugin")],
        "gseditpro.svg": [("</svg>", ""), ('id="fur"', 'id="hair"'), ("viewBox", "box")],
    }
    missed = 0
    for name, changes in cases.items():
        for before, after in changes:
            with tempfile.TemporaryDirectory() as folder:
                copy = pathlib.Path(folder)
                for part, place in PLACES.items():
                    (copy / place).mkdir(parents=True, exist_ok=True)
                    text = (folders[place] / part).read_text()
                    (copy / place / part).write_text(text.replace(before, after) if part == name else text)
                try:
                    seen = list(check(copy))
                except (configparser.Error, KeyError):
                    seen = ["unreadable"]
                if not seen:
                    missed += 1
                    print(f"{name}: {before} -> {after} was not seen")
    print(f"{missed} broken rules were missed")
    return missed


def check_places(folders):
    """Checks a copy in which both places lie side by side."""
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for name, place in PLACES.items():
            (root / place).mkdir(parents=True, exist_ok=True)
            (root / place / name).write_text((folders[place] / name).read_text())
        return list(check(root))


if __name__ == "__main__":
    test = sys.argv[1] == "--self-test"
    source, build = map(pathlib.Path, sys.argv[2:4] if test else sys.argv[1:3])
    folders = {"packaging": source / "packaging", "packaging/cmake": source / "packaging/cmake",
               "desktop": build / "desktop"}
    if test:
        sys.exit(1 if self_test(folders) else 0)
    violations = check_places(folders)
    print("\n".join(violations) if violations else "desktop file, types and icon agree")
    sys.exit(1 if violations else 0)
