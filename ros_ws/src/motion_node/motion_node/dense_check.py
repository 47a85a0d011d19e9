# SPDX-License-Identifier: Apache-2.0
"""An independent look at a trajectory, all along it, before it is sent.

Nothing of the optimisation is used: the trajectory's own cubics, kinematics in numbers, the blocks
where they were seen and where the hand takes them, hulls that cover the arm's meshes. Between two
moments a body moves by no more than its joints' turns times their arms, so a stretch of time is
free if the gaps at its ends are larger than that together; if they are not, it is halved.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from .blocks import ROUND, Block, Scene
from .hull_distances import MovingBox, MovingSpheres, Upright
from .obstacles import Obstacle
from .phases import PICK, Phase
from .robots.link_poses import joint_axes, link_poses
from .robots.model import ArmModel
from .timing.trajectory import Interval, Trajectory

Array = NDArray[np.float64]

TABLE: Final = "the table"
#: Moments of a way that are looked at first.
MOMENTS: Final = 24
#: Stretches are halved so often; bodies move by a millimetre or so in the shortest.
HALVINGS: Final = 6
#: A way that is left for so short a time is over [s].
_OVER: Final = 1e-3
#: What is nearer than it may be where a way ends comes no nearer than this in between [m].
_MEANT: Final = 0.002


@dataclass(frozen=True)
class Contact:
    """What comes too near to what.

    Attributes:
        phase: during which.
        time: since the trajectory's start [s].
        body, other: the pair, in words.
        gap: between them [m]; negative if they overlap.
    """

    phase: Phase
    time: float
    body: str
    other: str
    gap: float


@dataclass(frozen=True)
class Checked:
    """What a look at a trajectory came to.

    Attributes:
        least: the smallest gap found between what must not touch [m].
        contacts: the worst contact of each phase that has one.
    """

    least: float
    contacts: tuple[Contact, ...]


def check(
    model: ArmModel,
    trajectory: Trajectory,
    scene: Scene | None,
    obstacles: Sequence[Obstacle],
    clearance: float = 0.0,
    floor: float = 0.0,
    since: float = 0.0,
) -> Checked:
    """Whether hand, fingers, links and what is held touch nothing but what they mean to.

    Args:
        scene: the blocks before the trajectory; None: nobody knows where they are.
        clearance: gap that counts as free [m]; what is nearer at the start may stay so.
        floor: height of the table [m].
        since: what is before this time of the trajectory is not looked at [s].
    """
    blocks = {block.name: block for stack in (scene.stacks if scene else ()) for block in stack}
    around = _uprights(obstacles)
    least, contacts = np.inf, list[Contact]()
    hold: tuple[Block, Array, Array] | None = None
    for interval in trajectory.intervals:
        phase = interval.phase
        if interval.gripping:
            hand = _hand(model, trajectory.sample(np.array([interval.end]))[0].arm)
            if phase.kind == PICK:
                block = blocks.pop(phase.object_name)
                inverse = hand[0, :3, :3].T
                pose = _rotation(block.yaw)
                offset = inverse @ (np.array(block.position_world) - hand[0, :3, 3])
                hold = (block, inverse @ pose, offset)
            elif hold is not None:
                block, turn, offset = hold
                rotation = hand[0, :3, :3] @ turn
                x, y, z = (float(value) for value in hand[0, :3, 3] + hand[0, :3, :3] @ offset)
                yaw = float(np.arctan2(rotation[1, 0], rotation[0, 0]))
                blocks[block.name] = replace(block, position_world=(x, y, z), yaw=yaw)
                hold = None
            continue
        if interval.end - since < _OVER:
            continue
        interval = replace(interval, start=max(interval.start, since))
        others = _joined(_upright_blocks(list(blocks.values())), around)
        way = _WayCheck(model, trajectory, interval, others, floor, hold, {*blocks, TABLE})
        found, contact = way.run(clearance)
        least = min(least, found)
        if contact is not None:
            contacts.append(contact)
    return Checked(float(least), tuple(contacts))


class _WayCheck:
    """One way of the arm, between two switches."""

    def __init__(
        self,
        model: ArmModel,
        trajectory: Trajectory,
        interval: Interval,
        others: Upright,
        floor: float,
        hold: tuple[Block, Array, Array] | None,
        blocks: set[str],
    ) -> None:
        self._model, self._trajectory, self._interval = model, trajectory, interval
        self._others, self._floor, self._hold, self._blocks = others, floor, hold, blocks

    def run(self, clearance: float) -> tuple[float, Contact | None]:
        """The smallest gap that was seen, and the worst contact, if there is one."""
        times = np.linspace(self._interval.start, self._interval.end, MOMENTS)
        gaps, moves, names = self._look(times)
        free = np.full(gaps.shape[1], clearance)
        # What stands on something touches it at a switch; blocks are not where they were seen.
        meant = np.array([name in self._blocks for _, name in names])
        nearest = np.minimum(gaps[0], gaps[-1]) - _MEANT
        free = np.where(meant, np.minimum(free, nearest), free)
        if self._interval.phase.start is None:
            free = np.minimum(free, gaps[0] - _MEANT)
        least, contact = np.inf, None
        starts, ends = times[:-1], times[1:]
        first, second = gaps[:-1], gaps[1:]
        travel = np.maximum(moves[:-1], moves[1:]) * np.diff(times)[:, None]
        for _ in range(HALVINGS + 1):
            both = np.minimum(first, second) if len(first) else gaps
            if both.size:
                least = min(least, float(both.min()))
            worst = self._worst(starts, ends, first, second, names, free)
            if worst is not None and (contact is None or worst.gap < contact.gap):
                contact = worst
            # A gap between two moments is at least (first + second - travel) / 2.
            open_ = (((first + second - travel) / 2) < free).any(axis=1)
            open_ &= (np.minimum(first, second) >= free).all(axis=1)
            if not open_.any():
                break
            starts, ends = starts[open_], ends[open_]
            first, second = first[open_], second[open_]
            middle = (starts + ends) / 2
            here, moving, _ = self._look(middle)
            starts, ends = np.append(starts, middle), np.append(middle, ends)
            first, second = np.vstack([first, here]), np.vstack([here, second])
            travel = np.vstack([moving, moving]) * (ends - starts)[:, None]
        return least, contact

    def _worst(
        self,
        starts: Array,
        ends: Array,
        first: Array,
        second: Array,
        names: Sequence[tuple[str, str]],
        free: Array,
    ) -> Contact | None:
        for times, gaps in ((starts, first), (ends, second)):
            missing = gaps - free
            if gaps.size and missing.min() < 0:
                row, column = np.unravel_index(int(missing.argmin()), gaps.shape)
                body, other = names[int(column)]
                return Contact(
                    self._interval.phase,
                    float(times[row]),
                    body,
                    other,
                    float(gaps[row, column]),
                )
        return None

    def _look(self, times: Array) -> tuple[Array, Array, list[tuple[str, str]]]:
        """Gaps (k, pairs) [m], most speeds of their bodies (k, pairs) [m/s], and the pairs."""
        positions, rates = self._trajectory.sample(times)
        poses = link_poses(self._model, positions.arm)
        arm, gripper = self._model.arm, self._model.arm.gripper
        hand = poses[gripper.hand_link]
        rotation, origin = hand[:, :3, :3], hand[:, :3, 3]

        def box(low: Sequence[float], high: Sequence[float]) -> MovingBox:
            middle, half = np.add(low, high) / 2, np.subtract(high, low) / 2
            return MovingBox(rotation, origin + rotation @ middle, half)

        x, y = gripper.hand_half
        boxes = [("hand", box((-x, -y, gripper.hand_top), (x, y, gripper.palm)))]
        thick, depth = gripper.finger_thickness, gripper.finger_depth
        half = np.array([thick, depth / 2, (gripper.finger_tip - gripper.palm) / 2])
        for side, finger in ((1.0, positions.fingers[:, 0]), (-1.0, positions.fingers[:, 1])):
            middle = np.column_stack(
                [0 * finger, side * (finger + depth / 2), 0 * finger + gripper.palm + half[2]]
            )
            center = origin + np.einsum("kij,kj->ki", rotation, middle)
            boxes.append(("fingers", MovingBox(rotation, center, half)))
        if self._hold is not None:
            block, turn, offset = self._hold
            held = MovingBox(rotation @ turn, origin + rotation @ offset, np.array(block.size) / 2)
            boxes.append((block.name, held))
        balls = (*arm.bodies, *arm.upper_bodies)
        centers = [
            poses[ball.link][:, :3, 3] + poses[ball.link][:, :3, :3] @ np.array(ball.center)
            for ball in balls
        ]
        spheres = MovingSpheres(np.stack(centers, axis=1), np.array([b.radius for b in balls]))
        # (k, bodies, others), the table last.
        gaps = np.concatenate(
            [np.stack([body.gaps(self._others) for _, body in boxes], axis=1),
             spheres.gaps(self._others)], axis=1,
        )  # fmt: skip
        table = np.column_stack(
            [*[body.above(self._floor) for _, body in boxes], spheres.above(self._floor)]
        )
        gaps = np.concatenate([gaps, table[:, :, None]], axis=2)
        middles = np.concatenate(
            [np.stack([body.center for _, body in boxes], axis=1), spheres.center], axis=1
        )
        radii = np.append([body.radius for _, body in boxes], spheres.radius)
        speed = _speed(joint_axes(self._model, poses), np.abs(rates.arm), middles, radii)
        count = len(times)
        names = [name for name, _ in boxes] + [ball.name for ball in balls]
        pairs = [(name, other) for name in names for other in (*self._others.names, TABLE)]
        moving = np.repeat(speed, gaps.shape[2], axis=1)
        return gaps.reshape(count, -1), moving, pairs


def _hand(model: ArmModel, q: Array) -> Array:
    return link_poses(model, q)[model.arm.gripper.hand_link]


def _speed(joints: tuple[Array, Array], rates: Array, centers: Array, radii: Array) -> Array:
    """No point of a body is faster, shape (k, bodies) [m/s].

    A tenth is added for what happens between two moments.
    """
    directions, points = joints
    arms = np.cross(directions[:, None], centers[:, :, None] - points[:, None])
    reach = np.sqrt((arms**2).sum(axis=3)) + radii[:, None]
    return np.asarray(1.1 * np.einsum("kj,kbj->kb", rates, reach) + 1e-3)


def _rotation(yaw: float) -> Array:
    cos, sin = np.cos(yaw), np.sin(yaw)
    return np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])


def _upright_blocks(blocks: Sequence[Block]) -> Upright:
    return Upright(
        tuple(block.name for block in blocks),
        np.array([block.position_world for block in blocks]).reshape(-1, 3),
        np.array([block.size for block in blocks]).reshape(-1, 3) / 2,
        np.array([block.yaw for block in blocks]),
        np.array([block.shape in ROUND for block in blocks], dtype=bool),
    )


def _uprights(obstacles: Sequence[Obstacle]) -> Upright:
    return Upright(
        tuple(item.name for item in obstacles),
        np.array([item.position_world for item in obstacles]).reshape(-1, 3),
        np.array([item.size for item in obstacles]).reshape(-1, 3) / 2,
        np.array([item.yaw for item in obstacles]),
        np.array([item.round for item in obstacles], dtype=bool),
    )


def _joined(first: Upright, second: Upright) -> Upright:
    return Upright(
        first.names + second.names,
        np.vstack([first.center, second.center]),
        np.vstack([first.half, second.half]),
        np.append(first.yaw, second.yaw),
        np.append(first.round, second.round),
    )
