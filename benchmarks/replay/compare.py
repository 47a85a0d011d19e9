# SPDX-License-Identifier: Apache-2.0
"""Whether two engines end in the same scene graph, and if not, where they part."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scene_graph import SceneObject, split_object_name
from sim_node.ground_truth import graph_of_poses

from .grasps import Grasp, grasps, hand_poses, slip
from .recording import Recording, Trace

Array = NDArray[np.float64]

#: Blocks that are farther apart than this in the two engines have parted [m]: a third of a block.
PARTED: Final = 0.015
#: A block that slid so far in the hand was not held [m].
SLID: Final = 0.005
#: So long after the fingers open a block may still tip over because of how it was let go [s].
AFTERMATH: Final = 1.0

REFUSED: Final = "a trajectory was refused"
SLIPPED: Final = "slipped from the fingers"
SLIPPED_BEFORE: Final = "slipped from the fingers in pybullet, and not in MuJoCo"
MISSED: Final = "was not between the fingers"
TOPPLED: Final = "fell after it was put down"
PUSHED: Final = "was pushed by what was carried"
TOUCHED: Final = "was touched by the hand"
ASIDE: Final = "stands a little aside"

Relations = tuple[tuple[str, str, str], ...]


@dataclass(frozen=True)
class Verdict:
    """What the second judge says of a task.

    Attributes:
        seed: of the task.
        same: whether both engines end in the same scene graph.
        success: whether the goal was reached in the engine that executed it.
        moved: whether the task changed the scene graph at all, as recorded.
        trajectories: how many the arm was given.
        grasps: how many blocks were carried.
        relations: of the end in the replay.
        missing, extra: relations that only the recording has, and only the replay.
        final_deviation: largest distance of a block's two final positions [m].
        largest_deviation: the same over the whole task [m].
        recorded_slips, replayed_slips: of each grasp, see :func:`replay.grasps.slip` [m].
        parted_at: when a block was first farther than ``PARTED`` from where the recording has it,
            [s]; None: never.
        parted_block: that block; empty: none.
        cause: in a few words, of a difference; empty where there is none.
        sentence: the same with block, phase and distances.
        notes: what the replay noted.
    """

    seed: int
    same: bool
    success: bool
    moved: bool
    trajectories: int
    grasps: int
    relations: Relations
    missing: Relations
    extra: Relations
    final_deviation: float
    largest_deviation: float
    recorded_slips: tuple[float, ...]
    replayed_slips: tuple[float, ...]
    parted_at: float | None
    parted_block: str
    cause: str
    sentence: str
    notes: tuple[str, ...]

    def to_json(self) -> dict[str, Any]:
        """For a file; NaN slips, of nothing, are left out."""
        content = asdict(self)
        for key in ("recorded_slips", "replayed_slips"):
            content[key] = [value for value in content[key] if np.isfinite(value)]
        return content


def relations_of(recording: Recording, poses: Array) -> Relations:
    """Up-relations, sorted, of blocks at poses (b, 7): the ground truth's own rule."""
    objects = []
    for block, pose in zip(recording.blocks, poses.tolist()):
        color, shape = split_object_name(block.name)
        x, y, z, *quaternion = pose
        objects.append(
            SceneObject(block.name, color, shape, (x, y, z), tuple(quaternion), block.size)
        )
    graph = graph_of_poses(sorted(objects, key=lambda item: item.name), recording.places)
    found = ((item.subject, item.predicate, item.object) for item in graph.relations)
    return tuple(sorted(found))


def compare(recording: Recording, replayed: Trace) -> Verdict:
    """Holds the replay's trace against the recording's."""
    recorded = recording.trace
    there = at_times(replayed, recorded.times)
    apart = np.linalg.norm(there.poses[:, :, :3] - recorded.poses[:, :, :3], axis=2)
    final = np.linalg.norm(replayed.poses[-1, :, :3] - recorded.poses[-1, :, :3], axis=1)
    hand, held = hand_poses(recording), grasps(recording)
    relations = relations_of(recording, replayed.poses[-1])
    verdict = Verdict(
        seed=recording.seed,
        same=relations == recording.relations,
        success=recording.success,
        moved=relations_of(recording, recorded.poses[0]) != recording.relations,
        trajectories=sum(len(command.times) > 0 for command in recording.commands),
        grasps=sum(bool(grasp.block) for grasp in held),
        relations=relations,
        missing=tuple(sorted(set(recording.relations) - set(relations))),
        extra=tuple(sorted(set(relations) - set(recording.relations))),
        final_deviation=float(final.max()),
        largest_deviation=float(apart.max()),
        recorded_slips=tuple(slip(grasp, recorded, hand) for grasp in held),
        replayed_slips=tuple(slip(grasp, there, hand) for grasp in held),
        parted_at=None,
        parted_block="",
        cause="",
        sentence="",
        notes=replayed.notes,
    )
    entries = np.flatnonzero(apart.max(axis=1) > PARTED)
    if len(entries):
        entry = int(entries[0])
        name = recorded.names[int(apart[entry].argmax())]
        verdict = replace(verdict, parted_at=float(recorded.times[entry]), parted_block=name)
    if verdict.same:
        return verdict
    cause, phase = _cause(verdict, held)
    return replace(verdict, cause=cause, sentence=_sentence(verdict, cause, phase))


def at_times(trace: Trace, times: Array) -> Trace:
    """The entries of a trace that are next to times [s], moved on to them in a straight line."""
    after = np.clip(np.searchsorted(trace.times, times), 1, len(trace.times) - 1)
    before = after - 1
    span = trace.times[after] - trace.times[before]
    share = np.clip((times - trace.times[before]) / span, 0.0, 1.0)
    poses = (1 - share[:, None, None]) * trace.poses[before] + share[:, None, None] * trace.poses[
        after
    ]
    # Between two entries a block hardly turns; what matters of it is the position.
    poses[:, :, 3:] = trace.poses[after][:, :, 3:]
    joints = (1 - share[:, None]) * trace.joints[before] + share[:, None] * trace.joints[after]
    return replace(trace, times=times, joints=joints, poses=poses)


def _cause(verdict: Verdict, held: tuple[Grasp, ...]) -> tuple[str, str]:
    """The cause, and the phase in which it shows."""
    if verdict.notes:
        return REFUSED, "as the arm was not where the trajectory begins"
    if verdict.parted_at is None:
        return ASIDE, "at the end"
    time, block = verdict.parted_at, verdict.parted_block
    for number, grasp in enumerate(held, start=1):
        carrying = f"while {grasp.block or 'nothing'} was carried in move {number}"
        if time < grasp.start:
            return TOUCHED, f"on the way to {grasp.block or 'a block'} in move {number}"
        if time <= grasp.end and block == grasp.block:
            slips = (verdict.replayed_slips[number - 1], verdict.recorded_slips[number - 1])
            here, before = np.nan_to_num(slips)
            if max(here, before) < SLID:
                return MISSED, carrying
            return (SLIPPED if here > before else SLIPPED_BEFORE), carrying
        if time <= grasp.end:
            return PUSHED, carrying
        if time <= grasp.end + AFTERMATH:
            return TOPPLED, f"after {grasp.block or 'nothing'} was let go in move {number}"
    return TOPPLED, "after the last move"


def _sentence(verdict: Verdict, cause: str, phase: str) -> str:
    slips = [
        f"{1e3 * max((value for value in values if np.isfinite(value)), default=0.0):.1f}"
        for values in (verdict.recorded_slips, verdict.replayed_slips)
    ]
    when = "" if verdict.parted_at is None else f" at {verdict.parted_at:.1f} s"
    what = f"{verdict.parted_block or 'a block'} {cause}"
    if cause in (REFUSED, ASIDE):
        what = cause
    return (
        f"{what} {phase}{when}; positions end up to {1e3 * verdict.final_deviation:.1f} mm apart, "
        f"blocks slid by up to {slips[0]} mm in the hand in pybullet and {slips[1]} mm in MuJoCo"
    )
