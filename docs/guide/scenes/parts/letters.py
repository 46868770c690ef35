#!/usr/bin/env python3
"""Writes letters.ttf: a TrueType font of the letters of "lookfrom", of strokes that overlap, for the guide and the tests."""

import struct
from pathlib import Path


def rectangle(x0, y0, x1, y1):
    return [(x0, y0), (x0, y1), (x1, y1), (x1, y0)]


def ring(x, y, rx, ry, backwards=False):
    """An ellipse: corners of a square are off the curve (third value), its sides' middles on it."""
    around = [(x - rx, y), (x - rx, y + ry, 0), (x, y + ry), (x + rx, y + ry, 0),
              (x + rx, y), (x + rx, y - ry, 0), (x, y - ry), (x - rx, y - ry, 0)]
    return around[::-1] if backwards else around


def arch(x0, x1):
    return [(x0, 280), (x0, 510, 0), ((x0 + x1) // 2, 510), (x1, 510, 0), (x1, 280), (x1 - 100, 280),
            (x1 - 100, 410, 0), ((x0 + x1) // 2, 410), (x0 + 100, 410, 0), (x0 + 100, 280)]


LETTERS = {  # the advance, and the contours: outer ones clockwise
    "l": (220, [rectangle(60, 0, 160, 720)]),
    "o": (580, [ring(290, 250, 250, 260), ring(290, 250, 150, 160, backwards=True)]),
    "k": (480, [rectangle(60, 0, 160, 720), [(150, 190), (150, 330), (290, 500), (410, 500)],
                [(215, 280), (290, 370), (470, 0), (350, 0)]]),
    "f": (340, [rectangle(90, 0, 190, 560), rectangle(20, 420, 310, 500),
                [(90, 560), (90, 720, 0), (260, 720), (330, 720), (330, 630), (270, 630), (190, 630, 0), (190, 560)]]),
    "r": (350, [rectangle(60, 0, 160, 500),
                [(60, 300), (60, 510, 0), (270, 510), (340, 510), (340, 410), (270, 410), (160, 410, 0), (160, 300)]]),
    "m": (760, [rectangle(60, 0, 160, 500), arch(60, 430), rectangle(330, 0, 430, 300), arch(330, 700),
                rectangle(600, 0, 700, 300)]),
    " ": (300, []),
}
KERNING = {("k", "o"): -60}


def glyph(contours):
    if not contours:
        return b""
    points = [point for contour in contours for point in contour]
    xs, ys = [p[0] for p in points], [p[1] for p in points]
    data = struct.pack(">hhhhh", len(contours), min(xs), min(ys), max(xs), max(ys))
    end = -1
    for contour in contours:
        end += len(contour)
        data += struct.pack(">H", end)
    data += struct.pack(">H", 0)
    data += bytes(0 if len(p) == 3 else 1 for p in points)
    for values in (xs, ys):
        data += b"".join(struct.pack(">h", b - a) for a, b in zip([0, *values], values))
    return data + b"\0" * (-len(data) % 4)


def font():
    names = [None, *LETTERS]
    glyphs = [b"", *(glyph(contours) for _, contours in LETTERS.values())]
    advances = [500, *(advance for advance, _ in LETTERS.values())]
    offsets = [sum(map(len, glyphs[:k])) for k in range(len(glyphs) + 1)]
    groups = sorted((ord(name), k) for k, name in enumerate(names) if name)
    cmap = struct.pack(">HHL", 12, 0, 16 + 12 * len(groups)) + struct.pack(">LL", 0, len(groups))
    cmap += b"".join(struct.pack(">LLL", code, code, k) for code, k in groups)
    pairs = sorted((names.index(a), names.index(b), value) for (a, b), value in KERNING.items())
    kern = struct.pack(">HHHHHHHHH", 0, 1, 0, 14 + 6 * len(pairs), 1, len(pairs), 6, 0, 0)
    kern += b"".join(struct.pack(">HHh", *pair) for pair in pairs)
    tables = {
        b"cmap": struct.pack(">HHHHL", 0, 1, 3, 10, 12) + cmap,
        b"glyf": b"".join(glyphs),
        b"head": struct.pack(">LLLLHHQQhhhhHHhhh", 0x10000, 0, 0, 0x5F0F3CF5, 0, 1000, 0, 0, 0, -10, 760, 720, 0, 8, 2, 1, 0),
        b"hhea": struct.pack(">LhhhHhhhhhhhhhhhH", 0x10000, 800, -200, 100, 760, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, len(glyphs)),
        b"hmtx": b"".join(struct.pack(">Hh", advance, 0) for advance in advances),
        b"kern": kern,
        b"loca": b"".join(struct.pack(">L", offset) for offset in offsets),
        b"maxp": struct.pack(">LH", 0x10000, len(glyphs)) + b"\0" * 26,
    }
    header = struct.pack(">LHHHH", 0x10000, len(tables), 128, 3, 16 * len(tables) - 128)
    place, records, body = 12 + 16 * len(tables), b"", b""
    for tag, data in tables.items():
        records += tag + struct.pack(">LLL", 0, place + len(body), len(data))
        body += data + b"\0" * (-len(data) % 4)
    return header + records + body


Path(__file__).with_name("letters.ttf").write_bytes(font())
