# SPDX-License-Identifier: Apache-2.0
"""Draws the scenes of a set: the same number gives the same scene, and nothing else matters."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
import yaml
from tasks.draw import draw_row
from tasks.family import Row, Viewpoint
from tasks.two_rows import TwoRows
from tasks.view import camera_of

from scene_graph import BASIC_COLORS, BOX, COLORS, CYLINDER, ROW_OF_THREE, Stacks, object_name
from sim_node import World, all_layouts, parse_scene, random_arrangement, random_layout
from sim_node.scene.table import TABLE_LOWER, TABLE_UPPER

#: Benchmarks' seeds begin here; nothing is tuned on them.
FIRST_SEED: Final = 1000
#: Things that are not blocks stand this far from every place [m].
CLUTTER_GAP: Final = 0.11
#: Edge of a block in the plain world [m].
EDGE: Final = 0.045
#: A world in which blocks have any colour.
COLORFUL: Final[Mapping[str, Any]] = {"blocks": {"colors": list(COLORS)}}
#: Nothing stands this near to the arm's base [m].
ARM_FOOT: Final = 0.17


@dataclass(frozen=True)
class Drawn:
    """One picture's scene.

    Attributes:
        seed: of what the world draws.
        layout: where the blocks stand.
        scene: content of its scene file; None: the plain world.
        light: exposure, and gains of red, green and blue; None: as the sensor has it.
    """

    seed: int
    layout: Stacks
    scene: Mapping[str, Any] | None = None
    light: tuple[float, tuple[float, float, float]] | None = None

    def world(self) -> World:
        """A world of its own to draw it in; to be closed."""
        return World(None if self.scene is None else parse_scene(yaml.safe_dump(dict(self.scene))))


def plain(blocks: int, **camera: Any) -> Callable[[int], Drawn]:
    """Random states of so many blocks in the plain world.

    Args:
        camera: what is not as usual about it, by the keys of a scene file.
    """
    scene = {"cameras": [{"name": "camera", **camera}]} if camera else None
    return lambda number: Drawn(
        FIRST_SEED + number, random_layout(FIRST_SEED + number, blocks), scene
    )


@functools.cache
def _states_of_six() -> tuple[Stacks, ...]:
    return tuple(all_layouts([object_name(color, BOX) for color in BASIC_COLORS[:6]]))


def state_of_six(number: int) -> Drawn:
    """All 20,160 states of six blocks, in an order in which any first ones are a fair sample."""
    states = _states_of_six()
    order = np.random.default_rng(FIRST_SEED).permutation(len(states))
    return Drawn(FIRST_SEED + number, states[order[number % len(states)]], None)


def turned(degrees: float) -> Callable[[int], Drawn]:
    """Random states of six blocks, the camera turned about the middle of the row."""

    def draw(number: int) -> Drawn:
        seed = FIRST_SEED + number
        camera = camera_of(
            Viewpoint(), [place[:2] for place in ROW_OF_THREE], 0.36, math.radians(degrees)
        )
        return Drawn(seed, random_layout(seed, 6), {"cameras": [camera]})

    return draw


def shifted_stacks(most: float) -> Callable[[int], Drawn]:
    """Random states of six blocks whose stacks are further apart than those trained on (5.4.1).

    Args:
        most: greatest distance that is added between neighbours, in edges of a block.
    """

    def draw(number: int) -> Drawn:
        seed = FIRST_SEED + number
        rng = np.random.default_rng([seed, 9])
        added = EDGE * rng.uniform(0.0, most, len(ROW_OF_THREE) - 1)
        along = np.array([y for _, y, _ in ROW_OF_THREE])
        along[1:] += np.cumsum(added)
        along -= 0.5 * (along[0] + along[-1])
        places = [(x, round(float(y), 4)) for (x, _, _), y in zip(ROW_OF_THREE, along)]
        camera = camera_of(Viewpoint(), places, 8 * EDGE, 0.0)
        scene = {"places": [list(place) for place in places], "cameras": [camera]}
        return Drawn(seed, random_layout(seed, 6), scene)

    return draw


def colored(
    colors: tuple[str, ...],
    exposure: tuple[float, float] = (1.0, 1.0),
    red: tuple[float, float] = (1.0, 1.0),
    blue: tuple[float, float] = (1.0, 1.0),
    shapes: tuple[str, ...] = (BOX,),
) -> Callable[[int], Drawn]:
    """Three to seven blocks of any of so many colours, in light that is drawn anew.

    Args:
        exposure, red, blue: ranges of the light's strength, and of gains over green.
    """

    def draw(number: int) -> Drawn:
        seed = FIRST_SEED + number
        rng = np.random.default_rng([seed, 10])
        chosen = rng.permutation(list(colors))[: rng.integers(3, 8)]
        names = [object_name(str(color), str(rng.choice(list(shapes)))) for color in chosen]
        light = (
            float(rng.uniform(*exposure)),
            (float(rng.uniform(*red)), 1.0, float(rng.uniform(*blue))),
        )
        return Drawn(seed, random_arrangement(names, rng), COLORFUL, light)

    return draw


#: Colours beside which a block's paint may have come out, for each of the basic ones.
BESIDE: Final[Mapping[str, tuple[str, ...]]] = {
    "red": ("orange", "pink"),
    "orange": ("red", "yellow"),
    "yellow": ("orange",),
    "green": ("cyan",),
    "cyan": ("green", "blue"),
    "blue": ("purple", "cyan"),
    "purple": ("blue",),
    "pink": ("red",),
}


def between_colors(most: int = 2) -> Callable[[int], Drawn]:
    """Four to six blocks; the paint of up to ``most`` of them came out between two colours.

    A block is called by the colour that its paint was to have. The other colour has 20 to 50 % of
    it, which may look more like that one.
    """

    def draw(number: int) -> Drawn:
        seed = FIRST_SEED + number
        rng = np.random.default_rng([seed, 15])
        chosen = [str(color) for color in rng.permutation(BASIC_COLORS)[: rng.integers(4, 7)]]
        mixed = [color for color in chosen if color in BESIDE][: rng.integers(1, most + 1)]
        named: dict[str, Any] = {}
        for color in mixed:
            other = str(rng.choice(BESIDE[color]))
            share = rng.uniform(0.2, 0.5)
            paint = (1.0 - share) * np.array(COLORS[color]) + share * np.array(COLORS[other])
            named[object_name(color, BOX)] = {"paint": [round(float(part), 3) for part in paint]}
        layout = random_arrangement([object_name(color, BOX) for color in chosen], rng)
        light = (float(rng.uniform(0.85, 1.1)), (1.0, 1.0, 1.0))
        return Drawn(seed, layout, {"blocks": {"named": named}}, light)

    return draw


def any_number(number: int) -> Drawn:
    """One to twelve blocks, up to as high as the arm stacks them, on three places."""
    seed = FIRST_SEED + number
    rng = np.random.default_rng([seed, 11])
    colors = rng.permutation(list(COLORS))[: rng.integers(1, 13)]
    names = [object_name(str(color), BOX) for color in colors]
    while max(map(len, layout := random_arrangement(names, rng))) > 11:
        pass
    blocks = {"most": 12, "colors": list(COLORS)}
    camera = {"name": "camera", "position": [1.6, 0.0, 0.45], "target": [0.5, 0.0, 0.24]}
    return Drawn(seed, layout, {"blocks": blocks, "cameras": [camera]})


def beside_the_picture(number: int) -> Drawn:
    """Six blocks, the camera turned so far that some of them may be outside its picture."""
    seed = FIRST_SEED + number
    rng = np.random.default_rng([seed, 12])
    aside, up = rng.uniform(-0.3, 0.3), rng.uniform(0.05, 0.22)
    target = [0.5, round(float(aside), 4), round(float(up), 4)]
    return Drawn(seed, random_layout(seed, 6), {"cameras": [{"name": "camera", "target": target}]})


def solids(
    shapes: tuple[str, ...],
    edges: tuple[float, float],
    cubes: bool = False,
    clutter: bool = False,
    azimuth: float = 0.2618,
    size: tuple[int, int] = (256, 256),
) -> Callable[[int], Drawn]:
    """Blocks of many sizes, turned anyhow, on a row of 2 to 5 places anywhere in reach.

    Args:
        shapes: of which each block is one.
        edges: least and greatest edge of a block [m].
        cubes: whether the three edges of a box are equal.
        clutter: whether things that are not blocks stand around.
        azimuth: greatest angle of the camera beside the row's front [rad].
        size: of the picture [px].
    """

    def draw(number: int) -> Drawn:
        seed = FIRST_SEED + number
        rng = np.random.default_rng([seed, 8])
        places = draw_row(Row(), rng)
        colors = [str(color) for color in rng.permutation(BASIC_COLORS)[: rng.integers(3, 7)]]
        named: dict[str, Any] = {}
        for color in colors:
            shape = str(rng.choice(shapes))
            lengths = [round(float(value), 4) for value in rng.uniform(*edges, 3)]
            if shape == CYLINDER:
                lengths[1] = lengths[0]
            if cubes:
                lengths = [lengths[0]] * 3
            named[object_name(color, shape)] = {"size": lengths}
        layout = random_arrangement(list(named), rng, len(places))
        highest = sum(item["size"][2] for item in named.values())
        camera = camera_of(Viewpoint(), places, highest, float(rng.uniform(-azimuth, azimuth)))
        camera |= {"width": size[0], "height": size[1]}
        scene: dict[str, Any] = {
            "places": [list(place) for place in places],
            "blocks": {"named": named},
            "cameras": [camera],
            "yaw_jitter": 0.785,
        }
        if clutter:
            scene["obstacles"] = _clutter(places, camera["position"], rng)
        return Drawn(seed, layout, scene)

    return draw


def two_rows(blocks: int) -> Callable[[int], Drawn]:
    """Random states on two rows of three places each, in half of them a block behind a tower."""

    def draw(number: int) -> Drawn:
        seed, rows = FIRST_SEED + number, TwoRows()
        rng = np.random.default_rng([seed, 8])
        places = rows.places(rng)
        colors = [str(color) for color in rng.permutation(BASIC_COLORS)[:blocks]]
        layout = rows.layout([object_name(color, BOX) for color in colors], rng)
        scene = {"places": [list(place) for place in places], "cameras": [rows.view(rng)]}
        return Drawn(seed, layout, scene)

    return draw


#: A second camera that looks from the side, and from higher up.
ASIDE: Final[Mapping[str, Any]] = {
    "name": "side", "position": [0.8, -1.05, 0.75], "target": [0.5, 0.0, 0.1], "vertical_fov": 0.6,
}  # fmt: skip


def low_rows(blocks: int) -> Callable[[int], Drawn]:
    """Two rows as :func:`two_rows` has them, the first camera so low that they hide one another."""
    draw = two_rows(blocks)

    def low(number: int) -> Drawn:
        drawn = draw(number)
        scene = dict(drawn.scene or {})
        camera = {"name": "camera", "position": [1.45, 0.0, 0.4], "target": [0.5, 0.0, 0.08]}
        return replace(drawn, scene=scene | {"cameras": [camera, dict(ASIDE)]})

    return low


def behind_a_thing(blocks: int) -> Callable[[int], Drawn]:
    """Random states of a row, a thing before the first camera that hides part of a stack."""

    def draw(number: int) -> Drawn:
        seed = FIRST_SEED + number
        rng = np.random.default_rng([seed, 16])
        camera = {"name": "camera"}
        x, y = rng.uniform(0.72, 0.8), rng.uniform(-0.18, 0.18)
        width, height = rng.uniform(0.03, 0.06), rng.uniform(0.08, 0.16)
        thing = {
            "name": "thing", "shape": str(rng.choice([BOX, CYLINDER])),
            "size": [round(float(value), 4) for value in (width, width, height)],
            "position": [round(float(x), 4), round(float(y), 4)],
            "color": [round(float(value), 3) for value in rng.uniform(0.1, 0.9, 3)],
        }  # fmt: skip
        scene = {"cameras": [camera, dict(ASIDE)], "obstacles": [thing]}
        return Drawn(seed, random_layout(seed, blocks), scene)

    return draw


def _clutter(
    places: tuple[tuple[float, float], ...], camera: list[float], rng: np.random.Generator
) -> list[dict[str, Any]]:
    """Up to three things around the row, none of them between a place and the camera."""
    found: list[dict[str, Any]] = []
    middle = np.mean(places, axis=0)
    toward = np.array(camera[:2]) - middle
    toward /= np.linalg.norm(toward)
    for _ in range(40):
        if len(found) == 3:
            break
        at = middle + rng.uniform(-0.3, 0.3, 2)
        width, height = rng.uniform(0.03, 0.12), rng.uniform(0.02, 0.2)
        if min(math.dist(at, place) for place in places) < CLUTTER_GAP + 0.7 * width:
            continue
        if math.hypot(*at) < ARM_FOOT + 0.71 * width:
            continue
        if not (np.array(TABLE_LOWER) < at).all() or not (at < np.array(TABLE_UPPER)).all():
            continue
        if max(float((at - place) @ toward) for place in places) > -0.05:
            continue
        if any(math.dist(at, item["position"]) < 0.18 for item in found):
            continue
        found.append(
            {
                "name": f"thing {len(found)}",
                "shape": str(rng.choice([BOX, CYLINDER])),
                "size": [round(float(value), 4) for value in (width, width, height)],
                "position": [round(float(value), 4) for value in at],
                "color": [round(float(value), 3) for value in rng.uniform(0.1, 0.9, 3)],
            }
        )
    return found
