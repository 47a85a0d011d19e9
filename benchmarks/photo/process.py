# SPDX-License-Identifier: Apache-2.0
"""Blender as a Python module (the wheel ``bpy``): renders the scenes that it is told, one a line.

Runs in a virtual environment of its own. Each line of its input is a scene as
:func:`photo.render.told` writes it; the picture goes to the file that the scene names, and a line
with the file's name is the answer. Light, table and what stands around are drawn from the scene's
seed, blocks are as they are told.
"""

from __future__ import annotations

import json
import math
import os
import sys
import tempfile
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from mathutils import Matrix, Vector

#: Paths for each pixel; what grain is left the denoiser takes away.
SAMPLES = 24


def main() -> None:
    """Until the input ends."""
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # Blender tells of each tile on what would be the answers
    with tempfile.TemporaryDirectory() as folder:
        for line in sys.stdin:
            scene = json.loads(line)
            rgb, depth = render(scene, Path(folder))
            partial = Path(scene["file"]).with_suffix(".part.npz")
            np.savez_compressed(partial, rgb=rgb, depth=depth)
            partial.replace(scene["file"])
            print(scene["file"], file=answers, flush=True)


def render(told: dict[str, Any], folder: Path) -> tuple[Any, Any]:
    """Colours, uint8 (h, w, 3), and distances along the optical axis, float32 (h, w) [m]."""
    rng = np.random.default_rng(told["seed"])
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    _settings(scene, told, rng)
    _camera(scene, told["camera"])
    _table(rng)
    _light(scene, rng)
    for number, block in enumerate(told["blocks"]):
        _block(number, block, rng)
    _outputs(scene, folder)
    bpy.ops.render.render()
    width, height = told["camera"]["width"], told["camera"]["height"]
    depth = _read(folder / "depth0001.exr", width, height)[..., 0].astype(np.float32)
    depth[depth > told["camera"]["far"]] = 0.0
    rgb = _read(folder / "image0001.png", width, height)[..., :3]
    return np.round(255.0 * rgb).astype(np.uint8), depth


def _settings(scene: Any, told: dict[str, Any], rng: np.random.Generator) -> None:
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.samples = SAMPLES
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.use_denoising = True
    scene.cycles.max_bounces = 5
    scene.cycles.seed = int(rng.integers(2**31))
    scene.render.threads_mode = "FIXED"
    scene.render.threads = told["threads"]
    scene.render.resolution_x = told["camera"]["width"]
    scene.render.resolution_y = told["camera"]["height"]
    scene.view_settings.view_transform = "Standard"
    scene.view_layers[0].use_pass_z = True


def _camera(scene: Any, told: dict[str, Any]) -> None:
    camera = bpy.data.cameras.new("camera")
    camera.sensor_fit = "VERTICAL"
    camera.angle_y = told["vertical_fov"]
    camera.clip_start, camera.clip_end = 0.01, 20.0
    item = bpy.data.objects.new("camera", camera)
    # Blender's cameras look along -z with y up, the optical frame along z with y down.
    item.matrix_world = Matrix(told["world_from_optical"]) @ Matrix.Diagonal((1, -1, -1, 1))
    scene.collection.objects.link(item)
    scene.camera = item


def _material(name: str, color: Any, roughness: float, metallic: float = 0.0) -> Any:
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    surface = material.node_tree.nodes["Principled BSDF"]
    surface.inputs["Base Color"].default_value = (*_linear(color), 1.0)
    surface.inputs["Roughness"].default_value = roughness
    surface.inputs["Metallic"].default_value = metallic
    return material


def _linear(color: Any) -> tuple[float, ...]:
    """Of sRGB, as which colours are told."""
    return tuple(c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in color)


def _block(number: int, told: dict[str, Any], rng: np.random.Generator) -> None:
    """With rounded edges, of rubber or of metal; where and how large it is told."""
    x, y, z = told["size"]
    if told["shape"] == "box":
        bpy.ops.mesh.primitive_cube_add(size=1.0)
    elif told["shape"] == "cylinder":
        bpy.ops.mesh.primitive_cylinder_add(radius=0.5, depth=1.0, vertices=64)
    else:
        bpy.ops.mesh.primitive_uv_sphere_add(radius=0.5, segments=48, ring_count=24)
    item = bpy.context.object
    item.scale = (x, y, z)
    bpy.ops.object.transform_apply(location=False, rotation=False, scale=True)
    if told["shape"] != "sphere":
        bevel = item.modifiers.new("edges", "BEVEL")
        bevel.width, bevel.segments = float(rng.uniform(0.0005, 0.002)), 3
        bevel.limit_method = "ANGLE"
    qx, qy, qz, qw = told["quaternion"]
    item.rotation_mode = "QUATERNION"
    item.rotation_quaternion = (qw, qx, qy, qz)
    item.location = told["position"]
    if rng.random() < 0.5:
        material = _material(f"rubber {number}", told["color"], float(rng.uniform(0.5, 0.9)))
    else:
        material = _material(f"metal {number}", told["color"], float(rng.uniform(0.2, 0.4)), 1.0)
    item.data.materials.append(material)
    if told["shape"] != "box":
        bpy.ops.object.shade_auto_smooth()


def _table(rng: np.random.Generator) -> None:
    """A table of two tones that are nearly one, and a wall behind it."""
    bpy.ops.mesh.primitive_plane_add(size=4.0, location=(0.4, 0.0, 0.0))
    table = bpy.context.object
    grey = float(rng.uniform(0.2, 0.75))
    tint = np.clip(grey + rng.uniform(-0.06, 0.06, 3), 0.05, 0.9)
    material = _material("table", tint, float(rng.uniform(0.4, 0.9)))
    nodes, links = material.node_tree.nodes, material.node_tree.links
    noise, ramp = nodes.new("ShaderNodeTexNoise"), nodes.new("ShaderNodeValToRGB")
    noise.inputs["Scale"].default_value = float(rng.uniform(2.0, 60.0))
    noise.inputs["Detail"].default_value = 6.0
    for stop, change in zip(ramp.color_ramp.elements, (-1.0, 1.0)):
        shade = np.clip(tint + change * rng.uniform(0.0, 0.12), 0.03, 0.95)
        stop.color = (*_linear(shade), 1.0)
    links.new(noise.outputs["Fac"], ramp.inputs["Fac"])
    links.new(ramp.outputs["Color"], nodes["Principled BSDF"].inputs["Base Color"])
    table.data.materials.append(material)
    bpy.ops.mesh.primitive_plane_add(
        size=6.0, location=(-1.2, 0.0, 0.0), rotation=(0.0, 0.5 * math.pi, 0.0)
    )
    wall = rng.uniform(0.3, 0.85) + rng.uniform(-0.08, 0.08, 3)
    bpy.context.object.data.materials.append(_material("wall", np.clip(wall, 0.05, 0.95), 0.9))


def _light(scene: Any, rng: np.random.Generator) -> None:
    """The room's, and one to three lamps with soft shadows, from warm to cool."""
    world = bpy.data.worlds.new("room")
    world.use_nodes = True
    background = world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (*_tone(float(rng.uniform(4000, 7500))), 1.0)
    background.inputs["Strength"].default_value = float(rng.uniform(0.3, 0.7))
    scene.world = world
    for number in range(int(rng.integers(1, 4))):
        lamp = bpy.data.lights.new(f"lamp {number}", "AREA")
        lamp.size = float(rng.uniform(0.2, 1.0))
        lamp.color = _tone(float(rng.uniform(3500, 7500)))
        lamp.energy = float(rng.uniform(10.0, 28.0))
        item = bpy.data.objects.new(lamp.name, lamp)
        around, up = float(rng.uniform(-1.9, 1.9)), float(rng.uniform(0.5, 1.4))
        far = float(rng.uniform(1.4, 2.2))
        middle = Vector((0.5, 0.0, 0.1))
        item.location = middle + far * Vector(
            (math.cos(up) * math.cos(around), math.cos(up) * math.sin(around), math.sin(up))
        )
        item.rotation_mode = "QUATERNION"
        item.rotation_quaternion = (middle - item.location).to_track_quat("-Z", "Y")
        scene.collection.objects.link(item)


def _tone(kelvin: float) -> tuple[float, float, float]:
    """Light of a black body, about, of equal brightness; white at 6500 K."""
    warm = (6500.0 - kelvin) / 3000.0
    tone = np.clip([1.0 + 0.18 * warm, 1.0, 1.0 - 0.40 * warm], 0.2, 1.4)
    red, green, blue = (float(c) for c in tone / tone.mean())
    return red, green, blue


def _outputs(scene: Any, folder: Path) -> None:
    scene.use_nodes = True
    nodes, links = scene.node_tree.nodes, scene.node_tree.links
    nodes.clear()
    layers = nodes.new("CompositorNodeRLayers")
    for name, output, kind in (("image", "Image", "PNG"), ("depth", "Depth", "OPEN_EXR")):
        file = nodes.new("CompositorNodeOutputFile")
        file.base_path = str(folder)
        file.file_slots[0].path = name
        file.format.file_format = kind
        if kind == "OPEN_EXR":
            file.format.color_depth = "32"
        links.new(layers.outputs[output], file.inputs[0])


def _read(path: Path, width: int, height: int) -> Any:
    """Rows from the top, shape (h, w, 4)."""
    image = bpy.data.images.load(str(path))
    image.colorspace_settings.name = "Non-Color"
    values = np.empty(width * height * 4, np.float32)
    image.pixels.foreach_get(values)
    bpy.data.images.remove(image)
    return values.reshape(height, width, 4)[::-1]


if __name__ == "__main__":
    main()
