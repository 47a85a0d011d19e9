# SPDX-License-Identifier: Apache-2.0
"""What was executed: the scene before, what the controller was told, and what came of it.

A recording says nothing in words of one physics engine: bodies with sizes, masses and frictions,
trajectories as a joint_trajectory_controller gets them, and poses over time.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, Final
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Of the format; a recording of another one is refused.
VERSION: Final = 1
BOX: Final = "box"
CYLINDER: Final = "cylinder"
SPHERE: Final = "sphere"


class RecordingError(ValueError):
    """A recording that cannot be used; the sentence says what to do."""


@dataclass(frozen=True)
class Body:
    """Something on the table, or the table.

    Attributes:
        name: of the block; of a thing that does not move, whatever it is called.
        shape: ``box``, ``cylinder`` (upright in its own frame) or ``sphere``.
        size: full extents in its own frame [m].
        mass: [kg]; 0: it does not move.
        friction: sliding [], spinning [m], rolling [m]. Those of two bodies are combined as
            pybullet does, see :func:`replay.model.pair_friction`.
        position, quaternion: pose of its centre in world [m; x, y, z, w].
    """

    name: str
    shape: str
    size: tuple[float, float, float]
    mass: float
    friction: tuple[float, float, float]
    position: tuple[float, float, float]
    quaternion: tuple[float, float, float, float]


@dataclass(frozen=True)
class Command:
    """A trajectory, or with no points the order to stand still.

    Attributes:
        begins: when it starts, since the recording's start [s].
        times: of the points since then, shape (t,) [s].
        positions: shape (t, n), joints in the recording's order [rad, m].
        velocities: same shape, or None where the message had none.
    """

    begins: float
    times: Array
    positions: Array
    velocities: Array | None


@dataclass(frozen=True)
class Trace:
    """How things stood over time.

    Attributes:
        times: since the recording's start, shape (t,) [s].
        joints: shape (t, n) [rad, m].
        poses: of the blocks in the order of ``names``, shape (t, b, 7): position [m] and
            quaternion (x, y, z, w) in world.
        names: of the blocks.
        notes: what happened that no number says, such as a trajectory that was refused.
    """

    times: Array
    joints: Array
    poses: Array
    names: tuple[str, ...]
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Recording:
    """One executed task.

    Attributes:
        seed: of the task.
        source: ``graph``: the four nodes; ``process``: planners and simulator in one process.
        goal: in words.
        success: whether the goal was reached by the simulator's ground truth.
        robot: name of the arm.
        joints: names of its joints, n of them.
        places: on the table, from the left [m].
        bodies: all things before anything moved.
        start: joint positions then, shape (n,) [rad, m].
        commands: by the time of their beginning.
        trace: blocks and joints in the engine in which it was executed.
        relations: of the final ground truth, (subject, predicate, object), sorted.
    """

    seed: int
    source: str
    goal: str
    success: bool
    robot: str
    joints: tuple[str, ...]
    places: tuple[tuple[float, float, float], ...]
    bodies: tuple[Body, ...]
    start: Array
    commands: tuple[Command, ...]
    trace: Trace
    relations: tuple[tuple[str, str, str], ...]

    @property
    def blocks(self) -> tuple[Body, ...]:
        """The bodies that can be moved."""
        return tuple(body for body in self.bodies if body.mass > 0.0)

    def save(self, path: Path) -> None:
        """Writes the recording as one file, whole or not at all (NumPy's .npz, JSON inside)."""
        plain = {
            "version": VERSION,
            **{key: getattr(self, key) for key in _PLAIN},
            "bodies": [asdict(body) for body in self.bodies],
            "begins": [command.begins for command in self.commands],
            "names": self.trace.names,
            "notes": self.trace.notes,
        }
        arrays: dict[str, Any] = {"start": self.start}
        for index, command in enumerate(self.commands):
            arrays[f"times_{index}"] = command.times
            arrays[f"positions_{index}"] = command.positions
            if command.velocities is not None:
                arrays[f"velocities_{index}"] = command.velocities
        for key in ("times", "joints", "poses"):
            arrays[f"trace_{key}"] = getattr(self.trace, key)
        part = path.with_suffix(".part")
        with part.open("wb") as file:
            np.savez_compressed(file, about=np.array(json.dumps(plain)), **arrays)
        part.replace(path)


_PLAIN: Final = ("seed", "source", "goal", "success", "robot", "joints", "places", "relations")


def load_recording(path: Path) -> Recording:
    """Reads what :meth:`Recording.save` wrote.

    Raises:
        RecordingError: it cannot be read, or is of another version.
    """
    try:
        with np.load(path, allow_pickle=False) as arrays:
            return _recording(arrays)
    except RecordingError as error:
        raise RecordingError(f"{path}: {error}") from None
    except (OSError, EOFError, BadZipFile, ValueError, KeyError, TypeError) as error:
        raise RecordingError(
            f"{path} is no recording ({type(error).__name__}: {error}); remove it, and it is made "
            "anew"
        ) from error


def _recording(arrays: Mapping[str, Any]) -> Recording:
    about = json.loads(str(arrays["about"]))
    if about["version"] != VERSION:
        raise RecordingError(
            f"its format has the number {about['version']}, this code reads {VERSION}; "
            "remove it, and it is made anew"
        )
    commands = tuple(
        Command(
            begins,
            arrays[f"times_{index}"],
            arrays[f"positions_{index}"],
            arrays.get(f"velocities_{index}"),
        )
        for index, begins in enumerate(about["begins"])
    )
    trace = Trace(
        arrays["trace_times"],
        arrays["trace_joints"],
        arrays["trace_poses"],
        tuple(about["names"]),
        tuple(about["notes"]),
    )
    bodies = tuple(_body(item) for item in about["bodies"])
    return Recording(
        seed=about["seed"],
        source=about["source"],
        goal=about["goal"],
        success=about["success"],
        robot=about["robot"],
        joints=tuple(about["joints"]),
        places=_tuples(about["places"]),
        bodies=bodies,
        start=arrays["start"],
        commands=commands,
        trace=trace,
        relations=_tuples(about["relations"]),
    )


def _body(item: Mapping[str, Any]) -> Body:
    return Body(
        item["name"],
        item["shape"],
        tuple(item["size"]),
        item["mass"],
        tuple(item["friction"]),
        tuple(item["position"]),
        tuple(item["quaternion"]),
    )


def _tuples(rows: list[list[Any]]) -> tuple[Any, ...]:
    return tuple(tuple(row) for row in rows)


def without_commands(recording: Recording) -> Recording:
    """The same scene with an arm that is told nothing: the trivial baseline."""
    return replace(recording, commands=())
