# SPDX-License-Identifier: Apache-2.0
"""Pictures by Blender, in a virtual environment and processes of their own; kept in a folder."""

from __future__ import annotations

import json
import subprocess
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from perception.scenes import Drawn

from perception_node import PinholeCamera
from scene_graph import COLORS, SceneGraph
from sim_node import Frame, true_scene_graph
from sim_node.scene import CameraConfig

PROCESS: Final = Path(__file__).parent / "process.py"
WHEEL: Final = "bpy"
#: A picture takes seconds; beyond this Blender hangs [s].
TIMEOUT: Final = 600.0


class BlenderError(RuntimeError):
    """There is no Blender, or it ended; the sentence says what to do."""


@dataclass(frozen=True)
class Photo:
    """A picture and what it shows.

    Attributes:
        frame: without labels of blocks.
        camera: that took it.
        truth: the scene graph, for evaluation only.
    """

    frame: Frame
    camera: PinholeCamera
    truth: SceneGraph


class Blender:
    """A process that renders one scene after the other; to be closed.

    Args:
        environment: a virtual environment with the wheel ``bpy``.

    Raises:
        BlenderError: if it has none.
    """

    def __init__(self, environment: Path) -> None:
        python = environment / "bin" / "python"
        if not python.exists() or not list(environment.glob(f"lib/python3*/site-packages/{WHEEL}")):
            raise BlenderError(
                f"{environment} has no {WHEEL}; make one: python3.11 -m venv {environment} && "
                f"{environment}/bin/pip install 'bpy<5'"
            )
        self._log = tempfile.TemporaryFile("w+")  # noqa: SIM115 - closed with the process
        self._process = subprocess.Popen(
            [str(python.absolute()), str(PROCESS)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._log,
            text=True,
        )

    def render(self, scene: dict[str, Any]) -> None:
        """Writes the file that a scene names; raises BlenderError."""
        assert self._process.stdin and self._process.stdout
        try:
            self._process.stdin.write(json.dumps(scene) + "\n")
            self._process.stdin.flush()
            answer = self._process.stdout.readline()
        except BrokenPipeError:
            answer = ""
        if answer.strip() != scene["file"]:
            self._log.seek(0)
            raise BlenderError("Blender ended: " + "".join(self._log.readlines()[-3:]).strip())

    def close(self) -> None:
        """Ends the process."""
        if self._process.stdin:
            self._process.stdin.close()
        try:
            self._process.wait(timeout=10.0)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self._log.close()


def photographs(
    folder: Path, drawn: Sequence[Drawn], environment: Path | None, threads: int = 2
) -> Iterator[Photo]:
    """One picture after the other; what is in the folder is not rendered again.

    Args:
        folder: of the pictures, one file each.
        drawn: scenes of the plain world, or such as scene files tell.
        environment: see :class:`Blender`; None: nothing can be rendered.
        threads: of Blender.

    Raises:
        BlenderError: a picture is missing and cannot be rendered.
    """
    folder.mkdir(parents=True, exist_ok=True)
    blender: Blender | None = None
    try:
        for item in drawn:
            with item.world() as world:
                world.reset(item.layout, item.seed)
                truth, camera = true_scene_graph(world), world.config.camera
            path = folder / f"{item.seed}.npz"
            if not path.exists():
                if environment is None:
                    raise BlenderError(
                        f"{folder} lacks picture {item.seed}; name the virtual environment that "
                        f"holds {WHEEL} by BPY="
                    )
                blender = blender or Blender(environment)
                blender.render(told(item.seed, path, camera, truth, threads))
            with np.load(path) as file:
                rgb, depth = file["rgb"], file["depth"]
            labels = np.zeros(depth.shape, np.uint16)
            yield Photo(Frame(rgb, depth, labels), camera_of(camera), truth)
    finally:
        if blender:
            blender.close()


def told(
    seed: int, path: Path, camera: CameraConfig, truth: SceneGraph, threads: int
) -> dict[str, Any]:
    """A scene as the process reads it: metres, world frame, colours in sRGB."""
    return {
        "seed": seed,
        "file": str(path.absolute()),
        "threads": threads,
        "camera": {
            "width": camera.width,
            "height": camera.height,
            "vertical_fov": camera.vertical_fov,
            "far": camera.far,
            "world_from_optical": camera.world_from_optical.tolist(),
        },
        "blocks": [
            {
                "shape": block.shape,
                "size": list(block.size),
                "position": list(block.position_world),
                "quaternion": list(block.quaternion_world),
                "color": list(COLORS[block.color]),
            }
            for block in truth.objects
        ],
    }


def camera_of(camera: CameraConfig) -> PinholeCamera:
    """Blender's camera, whose axis goes through the middle of the picture."""
    k: NDArray[np.float64] = camera.intrinsics.copy()
    k[:2, 2] = 0.5 * camera.width - 0.5, 0.5 * camera.height - 0.5
    return PinholeCamera(k, camera.world_from_optical, camera.width, camera.height)
