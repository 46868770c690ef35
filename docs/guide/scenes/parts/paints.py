"""Writes three materials of formulas as MERL's .binary files: pearl, velvet and a paint that reflects to where light comes from.

    python3 paints.py
"""

import math
import struct

H, D, PHI = 24, 12, 8
SCALES = (1500.0, 1500.0 / 1.15, 1500.0 / 1.66)


def gloss(cos, alpha):
    bottom = cos * cos * (alpha * alpha - 1) + 1
    return alpha * alpha / (math.pi * bottom * bottom)


def pearl(h, d):
    """A lacquer whose colour turns with the angle of light to the half vector, over a pale ground."""
    turn = [0.5 + 0.5 * math.cos(7 * math.cos(d) + 2.1 * k) for k in range(3)]
    return [0.1 + 0.25 * hue * gloss(math.cos(h), 0.35) for hue in turn]


def velvet(h, d):
    """Dark, but for light from aside."""
    rim = math.sin(h) ** 6 * 0.6
    return [0.02 + rim * weight for weight in (0.9, 0.15, 0.5)]


def reflector(h, d):
    """Bright where the angle of light to the half vector is small."""
    back = gloss(math.cos(d), 0.25) * 0.35
    return [0.12 + back, 0.1 + 0.9 * back, 0.02 + 0.3 * back]


for name, material in (("pearl", pearl), ("velvet", velvet), ("reflector", reflector)):
    cells = []
    for h in range(H):
        for d in range(D):
            cells += [material(math.pi / 2 * ((h + 0.5) / H) ** 2, math.pi / 2 * (d + 0.5) / D)] * PHI
    with open(f"{name}.binary", "wb") as file:
        file.write(struct.pack("<3i", H, D, PHI))
        for channel, scale in enumerate(SCALES):
            file.write(struct.pack(f"<{len(cells)}d", *(cell[channel] * scale for cell in cells)))
