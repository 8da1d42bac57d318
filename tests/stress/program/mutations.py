"""Hostile files from good ones: the same seed gives the same bytes."""
import gzip
import io
import json
import re
import struct
import zipfile

NUMBERS = [b"0", b"-1", b"1e308", b"-1e308", b"1e39", b"4294967296", b"18446744073709551615",
           b"9007199254740993", b"0.5",
           b"null", b"true", b"[]", b"{}", b'"text"', b"1e-320", b"NaN", b"-0"]
WORDS = [b"\x1b[31m\x1b]0;x\x07", b"\\u0000\\u001b[2J", b"../../../../etc/passwd", b"/dev/zero",
         b"\xff\xfe\xfd", b"%s%n",
         "\u202eevil".encode(), b"A" * 5000, b""]
INTEGERS = [0, 1, 0x7f, 0x80, 0xff, 0x7fff, 0xffff, 0x7fffffff, 0x80000000, 0xffffffff, 1 << 40,
            (1 << 63) - 1, (1 << 64) - 1]
FLOATS = [float("nan"), float("inf"), float("-inf"), 1e30, -1e30, 1e-45, 88.8, 3.4e38]


def change_bytes(data, random):
    """A few changes that know nothing of the format."""
    data = bytearray(data)
    for _ in range(random.randint(1, 5)):
        if not data:
            break
        at = random.randrange(len(data))
        kind = random.randrange(8)
        if kind == 0:
            data[at] = random.randrange(256)
        elif kind == 1:
            data[at] ^= 1 << random.randrange(8)
        elif kind == 2:
            size = random.choice([1, 2, 4, 8])
            data[at:at + size] = (random.choice(INTEGERS) & ((1 << 8 * size) - 1)).to_bytes(size, "little")
        elif kind == 3:
            data[at:at + 4] = struct.pack("<f", random.choice(FLOATS))
        elif kind == 4:
            del data[at:]
        elif kind == 5:
            del data[at:at + random.randint(1, 64)]
        elif kind == 6:
            piece = data[at:at + random.randint(1, 64)]
            data[at:at] = piece * random.choice([1, 2, 50])
        else:
            data[at:at] = random.choice(WORDS)
    return bytes(data)


def change_text(data, random):
    """Changes of numbers, words and brackets in JSON and other text."""
    for _ in range(random.randint(1, 4)):
        kind = random.randrange(6)
        if kind <= 1:
            found = list(re.finditer(rb"-?[0-9][0-9.eE+-]*", data))
            if found:
                place = random.choice(found)
                data = data[:place.start()] + random.choice(NUMBERS) + data[place.end():]
        elif kind == 2:
            found = list(re.finditer(rb'"[^"\\]*"', data))
            if found:
                place = random.choice(found)
                data = data[:place.start()] + b'"' + random.choice(WORDS) + b'"' + data[place.end():]
        elif kind == 3:
            found = [place for place in re.finditer(rb"[\[{]", data)]
            if found:
                at = random.choice(found).start()
                depth = random.choice([3, 200, 200000])
                data = data[:at] + b"[" * depth + b"]" * depth + b"," + data[at:]
        elif kind == 4:
            found = list(re.finditer(rb'"[^"\\]*"\s*:', data))
            if found:   # an entry goes, or comes again with another value
                place = random.choice(found)
                data = data[:place.start()] + random.choice([b"", b'"x": 1,',
                                                             place.group(0)
                                                             + b" [1],"]) + data[place.start():]
        else:
            data = change_bytes(data, random)
    return data


def change_header(data, random):
    """Changes of the text header of a PLY file only."""
    end = data.find(b"end_header")
    if end < 0:
        return change_bytes(data, random)
    return change_text(data[:end], random) + data[end:]


def bomb(random):
    """Much of nothing."""
    return bytes(random.choice([1 << 16, 1 << 20, 1 << 24])) if random.random() < 0.9 else b"[" * (1 << 20)


def change_zip(data, random):
    """One member changed, doubled, blown up or missing; the archive itself stays whole."""
    try:
        source = zipfile.ZipFile(io.BytesIO(data))
        members = [(entry.filename, source.read(entry)) for entry in source.infolist()]
    except (zipfile.BadZipFile, NotImplementedError, EOFError, ValueError):
        return change_bytes(data, random)
    chosen = random.randrange(len(members))
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as target:
        for index, (name, content) in enumerate(members):
            if index == chosen:
                kind = random.randrange(6)
                if kind == 0:
                    continue
                if kind == 1:
                    content = bomb(random)
                elif kind == 2:
                    content = random.choice(members)[1]
                elif name.endswith(".json"):
                    content = change_text(content, random)
                else:
                    content = change_bytes(content, random)
            target.writestr(zipfile.ZipInfo(name), content,
                            random.choice([zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED]))
    return out.getvalue()


def change_gzip(data, random):
    """The content of a gzip stream changed, and packed again."""
    try:
        content = gzip.decompress(data)
    except (OSError, EOFError):
        return change_bytes(data, random)
    content = change_bytes(content, random)
    if random.random() < 0.2:   # a count of millions, and the zeros to go with it
        content = content[:8] + struct.pack("<I",
                                            random.choice([1 << 20, 1 << 24,
                                                           1 << 31])) + content[12:16] + bytes(1 << 22)
    return gzip.compress(content, 9, mtime=0)


def change_safetensors(data, random):
    """The JSON header changed, its length right again."""
    if len(data) < 8:
        return change_bytes(data, random)
    length = struct.unpack("<Q", data[:8])[0]
    header = change_text(data[8:8 + length], random)
    return struct.pack("<Q", len(header)) + header + data[8 + length:]


def mutate(data, ways, random):
    """One of these ways, or plain bytes."""
    way = random.choice([*ways, change_bytes])
    return way(data, random)
