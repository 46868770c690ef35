"""Views of a model around it, with depth, normals, masks and camera matrices, as NeRF and its descendants read them.

python nerf_dataset.py MODEL FOLDER [--views 100] [--size 400] [--samples 64]

FOLDER/transforms.json has the field of view and, for each view, the file and the matrix from the camera to the world in
OpenGL's axes (x right, y up, z backward). Pictures are PNGs with alpha; depths (along the view axis, 0 where nothing is) and
normals are .npy files beside them.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import numpy as np

import lookfrom


def directions(count: int) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """Unit vectors evenly over the upper half of a sphere: a Fibonacci spiral."""
    height = (np.arange(count) + 0.5) / count
    angle = np.pi * (1 + np.sqrt(5)) * np.arange(count)
    radius = np.sqrt(1 - height**2)
    return np.stack([radius * np.cos(angle), height, radius * np.sin(angle)], axis=-1)


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("model")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--views", type=int, default=100)
    parser.add_argument("--size", type=int, default=400)
    parser.add_argument("--samples", type=int, default=64)
    arguments = parser.parse_args()
    arguments.folder.mkdir(parents=True, exist_ok=True)

    # Read once; the light of the studio stays where it is.
    session = lookfrom.Session(
        arguments.model,
        size=arguments.size,
        samples=arguments.samples,
        background="transparent",
        view="persp",
    )
    assert session.bounds is not None, "the model is empty"
    low, high = map(np.array, session.bounds)
    middle, distance = (low + high) / 2, 1.6 * np.linalg.norm(high - low)
    frames = []
    for index, direction in enumerate(directions(arguments.views)):
        session.set(lookfrom=middle + distance * direction, lookat=middle, fov=40)
        name = f"{index:04}"
        session.render().save(arguments.folder / f"{name}.png")
        labels = session.labels()
        np.save(
            arguments.folder / f"{name}-depth.npy", np.where(labels.hit, labels.depth, 0).astype(np.float32)
        )
        np.save(arguments.folder / f"{name}-normal.npy", labels.normal)
        matrix = session.camera.world_from_camera("opengl")
        frames.append({"file_path": f"{name}.png", "transform_matrix": matrix.tolist()})
    k = session.camera.intrinsics
    transforms = {
        "camera_angle_x": 2 * np.arctan(0.5 * arguments.size / k[0, 0]),
        "fl_x": k[0, 0],
        "fl_y": k[1, 1],
        "cx": k[0, 2],
        "cy": k[1, 2],
        "w": arguments.size,
        "h": arguments.size,
        "frames": frames,
    }
    (arguments.folder / "transforms.json").write_text(json.dumps(transforms, indent=1))


if __name__ == "__main__":
    main()
