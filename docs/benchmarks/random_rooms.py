#!/usr/bin/env python3
"""Random rooms with windows under a sun and a sky, for portals.py: walls with one to three openings, a few boxes, sometimes
a hole in the ceiling; the sun is anywhere, in one of four rooms below the horizon.

    random_rooms.py /tmp/rooms 0 20 && portals.py --lookfrom target/release/lookfrom --size 192 /tmp/rooms/*.toml
"""

import argparse
import random
from pathlib import Path

HEAD = """[camera]
lookfrom = [{x}, 1.6, {z}]
lookat = [{at}, 1.2, 0]
fov = 70

[render]
depth = 6

[materials.plaster]
diffuse = {albedo}

[materials.wood]
diffuse = "#a9744a"
specular = 0.1

[materials.cloth]
diffuse = "#40658f"

[[light]]
type = "sun_and_sky"
elevation = {elevation}
azimuth = {azimuth}
"""
THICKNESS = 0.2


def box(low, high, material):
    low, high = ([round(x, 3) for x in corner] for corner in (low, high))
    return f'[[box]]\nmin = {low}\nmax = {high}\nmaterial = "{material}"\n'


class Room:
    """Half of its width (x) and depth (z), its height, and its boxes."""

    def __init__(self, chance):
        self.chance = chance
        self.half = (chance.uniform(2, 5), chance.uniform(3, 6))
        self.height = chance.uniform(2.4, 4)
        self.boxes = []

    def along(self, axis):
        """Half the length of a wall across an axis: 0 for x, 1 for z."""
        return self.half[1 - axis]

    def add_wall(self, axis, sign, holes):
        """Slabs around holes, which are (from, to) along the wall and (from, to) above the floor."""
        inner = self.half[axis]
        across = (inner, inner + THICKNESS) if sign > 0 else (-inner - THICKNESS, -inner)

        def slab(along, heights):
            if min(along[1] - along[0], heights[1] - heights[0]) > 1e-3:
                corners = [(across[k], heights[k], along[k]) if axis == 0 else (along[k], heights[k], across[k]) for k in (0, 1)]
                self.boxes.append(box(*corners, "plaster"))

        end = self.along(axis) + THICKNESS
        start = -end
        for along, (low, high) in sorted(holes):
            slab((start, along[0]), (0, self.height))
            slab(along, (0, low))
            slab(along, (high, self.height))
            start = along[1]
        slab((start, end), (0, self.height))

    def window(self, axis):
        along, width, low = self.along(axis), self.chance.uniform(0.5, 1.6), self.chance.uniform(0.2, 1.2)
        start = self.chance.uniform(-along + THICKNESS, along - THICKNESS - width)
        return (start, start + width), (low, min(self.height - 0.2, low + self.chance.uniform(0.6, 1.8)))

    def add_walls(self):
        holes = {(axis, sign): [] for axis in (0, 1) for sign in (1, -1)}
        for _ in range(self.chance.choice([1, 1, 2, 3])):
            wall = (self.chance.choice([0, 0, 1]), self.chance.choice([-1, 1]))
            window = self.window(wall[0])
            (start, end), _ = window
            if all(start > other[1] + 0.1 or end < other[0] - 0.1 for other, _ in holes[wall]):
                holes[wall].append(window)
        for (axis, sign), windows in holes.items():
            self.add_wall(axis, sign, windows)

    def add_level(self, heights, material, holes):
        """Floor or ceiling: whole, or around a hole of 1 × 1."""
        x, z = (half + THICKNESS for half in self.half)
        parts = [((-x, -z), (x, z))]
        for hx, hz in holes:
            parts = [((-x, -z), (x, hz)), ((-x, hz + 1), (x, z)), ((-x, hz), (hx, hz + 1)), ((hx + 1, hz), (x, hz + 1))]
        for low, high in parts:
            self.boxes.append(box((low[0], heights[0], low[1]), (high[0], heights[1], high[1]), material))

    def add_furniture(self):
        for _ in range(self.chance.randint(1, 5)):
            x, z = (self.chance.uniform(-half, half - 1) for half in self.half)
            size = [self.chance.uniform(0.3, most) for most in (1, 1.5, 1)]
            high = (x + size[0], size[1], min(z, 0) + size[2])
            self.boxes.append(box((x, 0, min(z, 0)), high, self.chance.choice(["wood", "cloth", "plaster"])))


def scene(seed):
    chance = random.Random(seed)
    room = Room(chance)
    room.add_level((-THICKNESS, 0), "wood", [])
    room.add_walls()
    skylight = [tuple(chance.uniform(-half + 0.3, half - 1.3) for half in room.half)] if chance.random() < 0.2 else []
    room.add_level((room.height, room.height + THICKNESS), "plaster", skylight)
    room.add_furniture()
    width, depth = room.half
    elevation = chance.uniform(10, 70) if chance.random() < 0.75 else chance.uniform(-5, 0)
    place = {"x": width / 2, "z": depth - 0.4, "at": width * chance.uniform(-0.3, 0.3)}
    light = {"albedo": chance.uniform(0.5, 0.85), "elevation": elevation, "azimuth": chance.uniform(0, 360)}
    return HEAD.format(**{key: round(value, 3) for key, value in (place | light).items()}) + "\n" + "\n".join(room.boxes)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("first", type=int, help="the seed of the first room")
    parser.add_argument("end", type=int, help="the seed after the last")
    args = parser.parse_args()
    args.folder.mkdir(parents=True, exist_ok=True)
    for seed in range(args.first, args.end):
        (args.folder / f"room{seed}.toml").write_text(scene(seed))


if __name__ == "__main__":
    main()
