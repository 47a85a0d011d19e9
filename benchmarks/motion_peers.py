# SPDX-License-Identifier: Apache-2.0
"""Others' optimisers, in a virtual environment and a process of their own: rai's KOMO, TOPP-RA."""

from __future__ import annotations

import json
import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from motion_node.timing.limits import JointLimits
from scene_graph import Move

PROCESS: Final = Path(__file__).parent / "motion_peer_process.py"
#: rai's loads what Debian calls liblapack3, libglfw3, libglew2.2 and libfreetype6.
WHEELS: Final = ("robotic", "toppra")


class Peers:
    """Asks a process that stays; to be closed.

    Args:
        environment: with the wheels of ``WHEELS``.

    Raises:
        FileNotFoundError: if it lacks one.
    """

    def __init__(self, environment: Path) -> None:
        python = environment / "bin" / "python"
        missing = [
            name
            for name in WHEELS
            if not list(environment.glob(f"lib/python3*/site-packages/{name}"))
        ]
        if not python.exists() or missing:
            raise FileNotFoundError(
                f"{environment} has no {' and no '.join(missing) or 'python'}; make one: python3 "
                f"-m venv {environment} && {environment}/bin/pip install {' '.join(WHEELS)}, or "
                "leave PEERS out"
            )
        self._process = subprocess.Popen(
            [str(python.absolute()), str(PROCESS)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            cwd=tempfile.gettempdir(),  # rai leaves a log where it is started
        )

    def komo(
        self,
        heights: Sequence[int],
        places: Sequence[tuple[float, float]],
        moves: Sequence[Move],
    ) -> tuple[float, bool]:
        """How long rai's KOMO takes for moves [s], and whether what it found is feasible."""
        answer = self._ask(
            "komo",
            heights=list(heights),
            places=list(places),
            moves=[[move.source, move.target] for move in moves],
        )
        return answer["seconds"], answer["feasible"]

    def toppra(self, q: NDArray[np.float64], limits: JointLimits, points: int) -> float:
        """The sum of the fastest durations of paths by TOPP-RA [s].

        Args:
            q: shape (paths, steps + 1, n) [rad].
            points: of its grid.
        """
        answer = self._ask(
            "toppra",
            paths=q.tolist(),
            velocity=limits.velocity.tolist(),
            acceleration=limits.acceleration.tolist(),
            points=points,
        )
        return float(sum(answer["durations"]))

    def _ask(self, what: str, **request: Any) -> dict[str, Any]:
        assert self._process.stdin is not None and self._process.stdout is not None
        self._process.stdin.write(json.dumps({"ask": what, **request}) + "\n")
        self._process.stdin.flush()
        line = self._process.stdout.readline()
        if not line:
            raise RuntimeError(f"{PROCESS.name} ended with code {self._process.wait()}")
        answer: dict[str, Any] = json.loads(line)
        return answer

    def close(self) -> None:
        """Ends the process."""
        assert self._process.stdin is not None
        self._process.stdin.close()
        self._process.wait()
