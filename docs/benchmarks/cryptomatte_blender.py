#!/usr/bin/env python3
"""Cryptomattes of lookfrom as Blender's compositor reads them.

Needs: pip packages bpy (5.0.1 was used, Python 3.11), numpy, OpenEXR; a release build of lookfrom.

    cryptomatte_blender.py --lookfrom target/release/lookfrom SCENE...

Of each scene a small picture with both Cryptomattes is rendered. Blender's node makes the matte of every name of its manifest, which
has to be the sum of the coverage that the file has for the identifier. Exits with 1 where it is not.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np
import OpenEXR

WIDTH, HEIGHT = 120, 90


def coverage(channels: dict, layer: str, identifier: int) -> np.ndarray:
    """The sum of the coverage of an identifier over the ranks of a layer."""
    total = np.zeros((HEIGHT, WIDTH), np.float32)
    for pair in range(3):
        for rank, part in ("RG", "BA"):
            is_it = channels[f"{layer}{pair:02}.{rank}"].pixels.view(np.uint32) == identifier
            total += np.where(is_it, channels[f"{layer}{pair:02}.{part}"].pixels, 0)
    return total


def blenders(file: Path, layer: str, name: str, output: Path) -> np.ndarray:
    """The matte of a name, by Blender's compositor."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    tree = bpy.data.node_groups.new("mattes", "CompositorNodeTree")
    tree.interface.new_socket(name="Image", in_out="OUTPUT", socket_type="NodeSocketColor")
    node, out = tree.nodes.new("CompositorNodeCryptomatteV2"), tree.nodes.new("NodeGroupOutput")
    node.source, node.image = "IMAGE", bpy.data.images.load(str(file))
    node.layer_name, node.matte_id = layer, name
    tree.links.new(node.outputs["Matte"], out.inputs[0])
    scene.compositing_node_group = tree
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    scene.collection.objects.link(camera)
    scene.camera, scene.render.engine, scene.cycles.samples = camera, "CYCLES", 1
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = WIDTH, HEIGHT, 100
    scene.view_settings.view_transform = "Raw"
    scene.render.image_settings.file_format, scene.render.filepath = "OPEN_EXR", str(output)
    scene.render.image_settings.color_depth = "32"
    bpy.ops.render.render(write_still=True)
    return OpenEXR.File(str(output), separate_channels=True).channels()["R"].pixels


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--lookfrom", required=True)
    parser.add_argument("scenes", nargs="+", metavar="SCENE")
    arguments = parser.parse_args()
    failed = False
    for scene in arguments.scenes:
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "mattes.exr"
            size = ["--size", f"{WIDTH}x{HEIGHT}", "--samples", "16", "--cryptomatte", "object,material"]
            subprocess.run([arguments.lookfrom, "render", scene, "-q", "-o", file, *size], check=True)
            read = OpenEXR.File(str(file), separate_channels=True)
            header, channels = read.header(), read.channels()
            for key in [name for name in header if name.endswith("/manifest")]:
                layer, differences = header[key.replace("manifest", "name")], []
                for name, identifier in json.loads(header[key]).items():
                    expected = coverage(channels, layer, int(identifier, 16))
                    # The node takes names with commas between them.
                    if "," not in name:
                        found = blenders(file, layer, name, Path(folder) / "matte.exr")
                        differences.append(float(np.abs(found - expected).max()))
                print(f"{scene}: {layer}, {len(differences)} names, greatest difference {max(differences, default=0.0)}")
                failed |= max(differences, default=0.0) > 1e-6
    sys.exit(failed)


if __name__ == "__main__":
    main()
