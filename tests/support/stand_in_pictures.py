#!/usr/bin/env python3
"""Pictures of the stand-in server: PNG with zlib alone, a deterministic drawing, broken files on purpose."""
import functools
import random
import struct
import zlib

SIGNATURE = b"\x89PNG\r\n\x1a\n"
CHANNELS = {0: 1, 2: 3, 4: 2, 6: 4}
COLOURS = {"red": (255, 0, 0), "green": (0, 200, 0), "blue": (0, 0, 255), "golden": (255, 200, 40),
           "white": (255, 255, 255), "yellow": (255, 255, 0)}


class Picture:
    """Rows of interleaved bytes; `channels` is 1, 2, 3 or 4."""

    def __init__(self, width, height, channels, data):
        self.width, self.height, self.channels, self.data = width, height, channels, data

    def colour(self):
        """Red, green and blue; alpha is dropped, as sd-server does."""
        if self.channels == 3:
            return self
        out = bytearray()
        for at in range(0, len(self.data), self.channels):
            pixel = self.data[at:at + self.channels]
            out += pixel[:3] if self.channels == 4 else pixel[:1] * 3
        return Picture(self.width, self.height, 3, bytes(out))

    @functools.lru_cache(None)
    def luma(self):
        colour = self.colour().data
        return [(colour[i] * 299 + colour[i + 1] * 587 + colour[i + 2] * 114) // 1000
                for i in range(0, len(colour), 3)]

    def alpha(self):
        if self.channels not in (2, 4):
            return None
        return [self.data[i] for i in range(self.channels - 1, len(self.data), self.channels)]


def chunk(name, data, broken=False):
    crc = zlib.crc32(name + data) ^ (1 if broken else 0)
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", crc)


def header(width, height, depth, colour, interlace=0):
    return chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, depth, colour, 0, 0, interlace))


def rows(picture, depth=8):
    step = picture.width * picture.channels
    out = bytearray()
    for y in range(picture.height):
        out.append(0)
        line = picture.data[y * step:(y + 1) * step]
        out += line if depth == 8 else b"".join(struct.pack(">H", value * 257) for value in line)
    return bytes(out)


def encode_png(picture, depth=8, texts=True):
    colour = {1: 0, 2: 4, 3: 2, 4: 6}[picture.channels]
    text = chunk(b"tEXt", b"parameters\0\x1b[31mprompt") if texts else b""
    return (SIGNATURE + header(picture.width, picture.height, depth, colour) + text
            + chunk(b"IDAT", zlib.compress(rows(picture, depth), 1)) + chunk(b"IEND", b""))


def unfilter(raw, width, height, step):
    line_bytes = width * step
    out, before, at = bytearray(), bytearray(line_bytes), 0
    for _ in range(height):
        kind, line = raw[at], bytearray(raw[at + 1:at + 1 + line_bytes])
        at += 1 + line_bytes
        for i in range(line_bytes if kind else 0):
            a = line[i - step] if i >= step else 0
            b, c = before[i], before[i - step] if i >= step else 0
            if kind == 1:
                add = a
            elif kind == 2:
                add = b
            elif kind == 3:
                add = (a + b) // 2
            else:
                p = a + b - c
                pa, pb, pc = abs(p - a), abs(p - b), abs(p - c)
                add = a if pa <= pb and pa <= pc else b if pb <= pc else c
            line[i] = (line[i] + add) & 255
        out += line
        before = line
    return bytes(out)


@functools.lru_cache(64)
def decode_png(data):
    """Picture of an 8-bit PNG without interlace; None for everything else."""
    if data[:8] != SIGNATURE:
        return None
    at, packed, size = 8, b"", None
    try:
        while at + 12 <= len(data):
            length, name = struct.unpack(">I4s", data[at:at + 8])
            body = data[at + 8:at + 8 + length]
            at += 12 + length
            if name == b"IHDR":
                size = struct.unpack(">IIBBBBB", body)
            elif name == b"IDAT":
                packed += body
        width, height, depth, colour, _, _, interlace = size
        if depth != 8 or interlace or colour not in CHANNELS or width * height > 1 << 24:
            return None
        step = CHANNELS[colour]
        raw = zlib.decompressobj().decompress(packed, (width * step + 1) * height)
        if len(raw) != (width * step + 1) * height:
            return None
        return Picture(width, height, step, unfilter(raw, width, height, step))
    except (struct.error, zlib.error, TypeError, IndexError):
        return None


def colour_of(prompt):
    for word in prompt.lower().replace(",", " ").replace(".", " ").split():
        if word in COLOURS:
            return COLOURS[word]
    return None


def block_means(picture):
    """Mean colour of every cell of 8 x 8 pixels."""
    sums = {}
    for y in range(picture.height):
        for x in range(picture.width):
            at = (y * picture.width + x) * 3
            cell = sums.setdefault((x // 8, y // 8), [0, 0, 0, 0])
            for c in range(3):
                cell[c] += picture.data[at + c]
            cell[3] += 1
    return {key: [value / cell[3] for value in cell[:3]] for key, cell in sums.items()}


def coarse(picture):
    """One pixel per cell of 8 x 8."""
    means = block_means(picture.colour())
    width, height = (picture.width + 7) // 8, (picture.height + 7) // 8
    cells = (means[x, y] for y in range(height) for x in range(width))
    return Picture(width, height, 3, bytes(min(int(value + .5), 255) for cell in cells for value in cell))


def red_parts(picture):
    """Mask of what is red."""
    colour = picture.colour().data
    red = [colour[i] - max(colour[i + 1], colour[i + 2]) for i in range(0, len(colour), 3)]
    return [255 if value > 30 else 0 for value in red]


def draw(picture, mask, prompt, seed, noise=0, drift=0, exact_outside=False, edits=""):
    """The answer to a request: a pure function of what it holds. `mask` is a list of 0 to 255, or None."""
    if mask is None and edits == "red":
        mask = red_parts(picture)
    kept = None if mask is None else bytes(255 if value > 127 else 0 for value in mask)
    return drawn(picture, kept, prompt, seed, noise, drift, exact_outside)


@functools.lru_cache(64)
def drawn(picture, mask, prompt, seed, noise, drift, exact_outside):
    source = picture.colour()
    width, height = source.width, source.height
    inside = bytes((255,)) * (width * height) if mask is None else mask
    colour = colour_of(prompt)
    chosen = [i for i, value in enumerate(inside) if value > 127]
    disc = None
    if " add " in f" {prompt.lower()} " and chosen:
        disc = (sum(i % width for i in chosen) / len(chosen), sum(i // width for i in chosen) / len(chosen),
                (len(chosen) / 3.1416) ** .5 / 2)
    means = block_means(source)
    rand = random.Random(seed)
    out = bytearray(width * height * 3)
    for y in range(height):
        for x in range(width):
            i = y * width + x
            from_x = min(max(x - drift, 0), width - 1)
            pixel = source.data[(y * width + from_x) * 3:(y * width + from_x) * 3 + 3]
            value = [.9 * p + .1 * m for p, m in zip(pixel, means[x // 8, y // 8])]
            if inside[i] > 127:
                if disc is not None:
                    if (x - disc[0]) ** 2 + (y - disc[1]) ** 2 <= disc[2] ** 2 and colour:
                        value = list(colour)
                elif colour:
                    light = max(value)
                    value = [light * c / 255 for c in colour]
                if noise:
                    value = [v + rand.uniform(-noise, noise) for v in value]
            elif exact_outside:
                value = list(pixel)
            for c in range(3):
                out[i * 3 + c] = min(max(int(value[c] + .5), 0), 255)
    return Picture(width, height, 3, bytes(out))


def unrelated(width, height, seed):
    """Picture that has nothing to do with what was sent: text-to-image without a word."""
    rand = random.Random(seed + 1)
    return Picture(width, height, 3, bytes(rand.randrange(256) for _ in range(width * height * 3)))


def resized(picture, width, height):
    out = bytearray()
    for y in range(height):
        for x in range(width):
            at = ((y * picture.height // height) * picture.width + x * picture.width // width) * 3
            out += picture.data[at:at + 3]
    return Picture(width, height, 3, bytes(out))


def interlaced(picture):
    """PNG in the seven passes of Adam7."""
    raw = bytearray()
    for x0, y0, dx, dy in ((0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4), (1, 0, 2, 2),
                           (0, 1, 1, 2)):
        for y in range(y0, picture.height, dy):
            line = b"".join(picture.data[(y * picture.width + x) * 3:(y * picture.width + x) * 3 + 3]
                            for x in range(x0, picture.width, dx))
            if line:
                raw += b"\0" + line
    return (SIGNATURE + header(picture.width, picture.height, 8, 2, 1)
            + chunk(b"IDAT", zlib.compress(bytes(raw))) + chunk(b"IEND", b""))


def with_alpha(picture, alpha_of):
    out = bytearray()
    for i in range(picture.width * picture.height):
        out += picture.data[i * 3:i * 3 + 3] + bytes((alpha_of(i),))
    return Picture(picture.width, picture.height, 4, bytes(out))


def grey(picture, alpha=False):
    luma = picture.luma()
    data = bytes(luma) if not alpha else b"".join(bytes((value, 255)) for value in luma)
    return Picture(picture.width, picture.height, 2 if alpha else 1, data)


def palette_png(picture):
    body = b"".join(b"\0" + bytes(picture.luma()[y * picture.width:(y + 1) * picture.width])
                    for y in range(picture.height))
    table = b"".join(bytes((i, 255 - i, 0)) for i in range(256))
    return (SIGNATURE + header(picture.width, picture.height, 8, 3) + chunk(b"PLTE", table)
            + chunk(b"IDAT", zlib.compress(body)) + chunk(b"IEND", b""))


def bomb(picture):
    packer = zlib.compressobj(9)
    packed = b"".join(packer.compress(bytes(1 << 20)) for _ in range(64)) + packer.flush()
    return (SIGNATURE + header(picture.width, picture.height, 8, 2) + chunk(b"IDAT", packed)
            + chunk(b"IEND", b""))


def sized_header(width, height):
    return (SIGNATURE + header(width, height, 8, 2) + chunk(b"IDAT", zlib.compress(bytes(64)))
            + chunk(b"IEND", b""))


def animated(picture):
    plain = encode_png(picture, texts=False)
    return plain[:33] + chunk(b"acTL", struct.pack(">II", 2, 0)) + plain[33:]


def wrong_crc(picture):
    data = zlib.compress(rows(picture))
    return (SIGNATURE + header(picture.width, picture.height, 8, 2) + chunk(b"IDAT", data, True)
            + chunk(b"IEND", b""))


# Name of a fault -> bytes of the file in place of the right picture.
FILES = {
    "png_cut": lambda p: encode_png(p)[:-400],
    "png_crc": wrong_crc,
    "png_huge": lambda p: sized_header(65535, 65535),
    "png_zero": lambda p: sized_header(0, 0),
    "png_tiny": lambda p: encode_png(Picture(1, 1, 3, b"\1\2\3")),
    "png_bomb": bomb,
    "png_16": lambda p: encode_png(p, 16),
    "png_grey": lambda p: encode_png(grey(p)),
    "png_grey_alpha": lambda p: encode_png(grey(p, True)),
    "png_palette": palette_png,
    "png_opaque": lambda p: encode_png(with_alpha(p, lambda i: 255)),
    "png_holes": lambda p: encode_png(with_alpha(p, lambda i: 0 if i % 2 else 255)),
    "png_interlaced": interlaced,
    "png_animated": animated,
    "gif": lambda p: b"GIF89a" + struct.pack("<HH", p.width, p.height) + bytes(64),
    "svg": lambda p: b'<svg xmlns="http://www.w3.org/2000/svg" width="8" height="8"/>',
    "bmp": lambda p: b"BM" + bytes(64),
    "size_double": lambda p: encode_png(resized(p, p.width * 2, p.height * 2)),
    "size_triple": lambda p: encode_png(resized(p, p.width * 3, p.height * 3)),
    "size_plus8": lambda p: encode_png(resized(p, p.width + 8, p.height + 8)),
    "size_turned": lambda p: encode_png(resized(p, p.height, p.width)),
    "unrelated": lambda p: encode_png(unrelated(p.width, p.height, 7)),
}
