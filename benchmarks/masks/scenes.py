# SPDX-License-Identifier: Apache-2.0
"""Draws scenes to train on: blocks of any size on any row, seen from anywhere in front of it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import yaml
from perception.scenes import FIRST_SEED
from tasks.draw import draw_row
from tasks.family import Row, Viewpoint
from tasks.view import camera_of

from scene_graph import BOX, COLORS, CYLINDER, ROW_OF_THREE, Stacks, object_name
from sim_node import SceneError, World, parse_scene, random_arrangement

#: Seeds begin here: no benchmark comes so far.
TRAINING_SEED: Final = FIRST_SEED + 1_000_000
#: So high are towers at most [m].
HIGHEST: Final = 0.34
#: Sizes of pictures [px].
SIZES: Final = ((256, 256), (256, 256), (640, 480), (320, 240))
_HOME: Final = (0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785)


@dataclass(frozen=True)
class TrainingScene:
    """A scene, and states to be seen in it."""

    seed: int
    scene: Mapping[str, Any]
    layouts: tuple[Stacks, ...]

    def world(self) -> World:
        """A world of its own to draw it in; to be closed. Raises SceneError where it cannot be."""
        return World(parse_scene(yaml.safe_dump(dict(self.scene))))


def draw_scene(number: int, states: int) -> TrainingScene:
    """The n-th scene that can be, with so many states."""
    for attempt in range(1000):
        rng = np.random.default_rng([TRAINING_SEED + number, attempt])
        try:
            drawn = _draw(TRAINING_SEED + number, rng, states)
            drawn.world().close()
        except (SceneError, ValueError):
            continue
        return drawn
    raise AssertionError("no scene that can be was drawn")


def _draw(seed: int, rng: np.random.Generator, states: int) -> TrainingScene:
    usual = rng.random() < 0.3
    places = tuple(place[:2] for place in ROW_OF_THREE) if usual else draw_row(Row(), rng)
    named = _usual_blocks(rng) if usual else _blocks(rng)
    together = sum(block["size"][2] for block in named.values())
    highest = HIGHEST if usual else min(HIGHEST, together)
    view = Viewpoint(
        elevation=float(rng.uniform(0.15, 0.55)),
        vertical_fov=float(rng.uniform(0.42, 0.9)),
        distance=float(rng.uniform(0.7, 1.2)),
        target_height=float(rng.uniform(0.08, 0.2)),
    )
    if usual and rng.random() < 0.5:
        view = Viewpoint()
    camera = camera_of(view, places, highest, float(rng.uniform(-0.42, 0.42)))
    camera["width"], camera["height"] = SIZES[int(rng.integers(len(SIZES)))]
    scene = {
        "places": [list(place) for place in places],
        "blocks": {"named": named},
        "cameras": [camera],
        "yaw_jitter": 0.05 if usual else float(rng.choice([0.05, 0.785])),
        "light": {
            "direction": [round(float(v), 3) for v in rng.uniform([0.2, -1.5, 0.5], [1.5, 1.5, 2])],
            "ambient": float(rng.uniform(0.3, 0.7)),
            "diffuse": float(rng.uniform(0.2, 0.6)),
            "specular": float(rng.uniform(0.0, 0.3)),
        },
        "arm": {"home": _arm(rng)},
        "obstacles": _things(places, np.array(camera["position"]), rng),
    }
    layouts = tuple(_layout(named, len(places), rng) for _ in range(states))
    return TrainingScene(seed, scene, layouts)


def _usual_blocks(rng: np.random.Generator) -> dict[str, Any]:
    colors = rng.permutation(list(COLORS))[: rng.integers(3, 8)]
    return {object_name(str(color), BOX): {"size": [0.045] * 3} for color in colors}


def _blocks(rng: np.random.Generator) -> dict[str, Any]:
    named: dict[str, Any] = {}
    low, high = (0.03, 0.06) if rng.random() < 0.7 else (0.026, 0.07)
    cubes, alike, round_ones = rng.random() < 0.7, rng.random() < 0.25, rng.random() < 0.25
    common = float(rng.uniform(low, high))
    for color in rng.permutation(list(COLORS))[: rng.integers(2, 8)]:
        shape = CYLINDER if round_ones and rng.random() < 0.5 else BOX
        lengths = rng.uniform(low, high, 3)
        if alike:
            lengths[:] = common
        elif cubes:
            lengths[:] = lengths[0]
        elif shape == CYLINDER:
            lengths[1] = lengths[0]
        named[object_name(str(color), shape)] = {"size": [round(float(v), 4) for v in lengths]}
    return named


def _layout(named: Mapping[str, Any], places: int, rng: np.random.Generator) -> Stacks:
    """Some of the blocks, in towers that are not too high."""
    while True:
        count = int(rng.integers(max(1, len(named) - 2), len(named) + 1))
        chosen = [str(name) for name in rng.permutation(list(named))[:count]]
        layout = random_arrangement(chosen, rng, places)
        if max(sum(named[name]["size"][2] for name in stack) for stack in layout) <= HIGHEST:
            return layout


def _arm(rng: np.random.Generator) -> list[float]:
    """At home, or anywhere near it, over the places as well."""
    if rng.random() < 0.4:
        return list(_HOME)
    off = rng.normal(0.0, [0.35, 0.35, 0.15, 0.35, 0.1, 0.3, 0.5])
    return [round(float(value), 3) for value in np.array(_HOME) + off]


def _things(
    places: tuple[tuple[float, float], ...], camera: np.ndarray, rng: np.random.Generator
) -> list[dict[str, Any]]:
    """Clutter behind and beside the row; seldom something before or over it, which hides it."""
    found: list[dict[str, Any]] = []
    middle = np.mean(places, axis=0)
    toward = (camera[:2] - middle) / np.linalg.norm(camera[:2] - middle)
    hides = rng.random() < 0.3
    for _ in range(40):
        if len(found) == 4:
            break
        size = rng.uniform([0.02, 0.02, 0.02], [0.14, 0.14, 0.25])
        shape = str(rng.choice([BOX, BOX, CYLINDER, "sphere"]))
        if shape != BOX:
            size[1] = size[0]
        if shape == "sphere":
            size[:] = round(min(float(size[0]), 0.1), 4)
        at = middle + rng.uniform(-0.4, 0.4, 2)
        height = 0.5 * float(size[2]) + 1e-4
        if hides and not found:
            at = middle + rng.uniform(0.08, 0.35) * toward + rng.uniform(-0.2, 0.2, 2)
            height += float(rng.choice([0.0, rng.uniform(0.0, 0.3)]))
        nearest = min(math.dist(at, place) for place in places)
        before = max(float((at - place) @ toward) for place in places) > -0.04
        if nearest < 0.06 + 0.7 * max(size[:2]) or (before and not (hides and not found)):
            continue
        found.append(
            {
                "name": f"thing {len(found)}",
                "shape": shape,
                "size": [round(float(value), 4) for value in size],
                "position": [round(float(value), 4) for value in (*at, height)],
                "yaw": round(float(rng.uniform(-1.5, 1.5)), 3),
                "color": [round(float(value), 3) for value in rng.uniform(0.05, 0.95, 3)],
            }
        )
        if rng.random() < 0.35:
            break
    return found
