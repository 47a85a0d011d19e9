# SPDX-License-Identifier: Apache-2.0
"""Recordings made by hand: two blocks, and a hand that carries one of them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from replay.recording import Body, Command, Recording, Trace

from sim_node.simulated_arms import PANDA

EDGE = 0.05
FRICTION = (0.9, 0.003, 0.0)
PLACES = ((0.5, -0.15, 0.0), (0.5, 0.0, 0.0), (0.5, 0.15, 0.0))
NAMES = ("red_box", "blue_box")
#: The fingers close, carry, and open [s].
CLOSE, LIFT, LOWERED, OPEN, END = 1.0, 2.0, 3.0, 4.0, 6.0
TIMES = np.arange(0.0, END, 0.05)


def block(name: str, position: tuple[float, float, float]) -> Body:
    return Body(name, "box", (EDGE,) * 3, 0.08, FRICTION, position, (0.0, 0.0, 0.0, 1.0))


TABLE = Body(
    "fixed_0", "box", (1.0, 1.2, 0.04), 0.0, (0.9, 0.0, 0.0), (0.35, 0, -0.02), (0, 0, 0, 1)
)


def command() -> Command:
    """The arm rests at home; only the fingers move."""
    times = np.array([0.0, CLOSE, CLOSE + 0.2, OPEN, OPEN + 0.2])
    fingers = np.array([0.04, 0.04, 0.015, 0.015, 0.04])
    positions = np.column_stack([np.tile(PANDA.home, (5, 1)), fingers, fingers])
    return Command(0.0, times, positions, np.zeros_like(positions))


def poses(red: NDArray[Any], blue: NDArray[Any]) -> NDArray[np.float64]:
    """Poses of the upright blocks, shape (t, 2, 7), from their positions (t, 3)."""
    result = np.zeros((len(TIMES), 2, 7))
    result[:, :, 6] = 1.0
    result[:, 0, :3], result[:, 1, :3] = red, blue
    return result


def carried_red() -> NDArray[np.float64]:
    """Where red is: from the left place, through the air, to the top of blue, shape (t, 3)."""
    start, end = np.array([0.5, -0.15, EDGE / 2]), np.array([0.5, 0.0, 1.5 * EDGE])
    share = np.clip((TIMES - LIFT) / (LOWERED - LIFT), 0.0, 1.0)[:, None]
    return start + share * (end - start)


def standing_blue() -> NDArray[np.float64]:
    return np.tile([0.5, 0.0, EDGE / 2], (len(TIMES), 1))


def trace(red: NDArray[Any] | None = None, blue: NDArray[Any] | None = None) -> Trace:
    red = carried_red() if red is None else red
    blue = standing_blue() if blue is None else blue
    joints = np.tile([*PANDA.home, 0.04, 0.04], (len(TIMES), 1))
    return Trace(TIMES, joints, poses(red, blue), NAMES)


def recording(**changed: Any) -> Recording:
    """Red is put on blue."""
    values: dict[str, Any] = {
        "seed": 7,
        "source": "process",
        "goal": "red_box on blue_box",
        "success": True,
        "robot": "panda",
        "joints": PANDA.joints,
        "places": PLACES,
        "bodies": (
            TABLE,
            block("red_box", (0.5, -0.15, EDGE / 2)),
            block("blue_box", (0.5, 0.0, EDGE / 2)),
        ),
        "start": np.array([*PANDA.home, 0.04, 0.04]),
        "commands": (command(),),
        "trace": trace(),
        "relations": (("blue_box", "up", "stack1"), ("red_box", "up", "blue_box")),
    }
    return Recording(**{**values, **changed})
