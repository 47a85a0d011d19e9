# SPDX-License-Identifier: Apache-2.0
"""Runs in a virtual environment of its own, with ``robotic`` and ``toppra``: asked and answering
in lines of JSON, so that nothing of theirs is loaded beside the code that they are compared with.
"""

from __future__ import annotations

import json
import sys
import time
from typing import Any

import numpy as np

STEPS = 20
#: Blocks are let go in the middle of their places, on top of what stands there [m].
EDGE = 0.045


def toppra_durations(request: dict[str, Any]) -> dict[str, Any]:
    """The durations of paths."""
    import toppra
    import toppra.algorithm
    import toppra.constraint

    toppra.setup_logging("ERROR")
    limits = [
        constraint(np.stack([-np.array(request[name]), request[name]], axis=1))
        for name, constraint in (
            ("velocity", toppra.constraint.JointVelocityConstraint),
            ("acceleration", toppra.constraint.JointAccelerationConstraint),
        )
    ]
    grid = np.linspace(0.0, 1.0, request["points"])
    durations = []
    for path in request["paths"]:
        knots = np.linspace(0.0, 1.0, len(path))
        spline = toppra.SplineInterpolator(knots, np.array(path), bc_type="clamped")
        algorithm = toppra.algorithm.TOPPRA(limits, spline, gridpoints=grid)
        _, speeds, _ = algorithm.compute_parameterization(0.0, 0.0)
        durations.append(float((2 * np.diff(grid) / (speeds[1:] + speeds[:-1])).sum()))
    return {"durations": durations}


def komo_seconds(request: dict[str, Any]) -> dict[str, Any]:
    """rai's KOMO on moves of blocks: a phase for each pick and place and one for the way home.

    On rai's own Panda, its arm and table kept from colliding; its blocks are not (with them in, it
    finds nothing feasible at any length).
    """
    import robotic as ry

    config = ry.Config()
    config.addFile(ry.raiPath("scenarios/pandaSingle.g"))
    base = config.getFrame("l_panda_base")
    middle, turn = base.getPosition(), base.getRotationMatrix()
    table = config.getFrame("table")
    top = table.getPosition()[2] + table.getSize()[2] / 2

    def world(x: float, y: float, height: float) -> list[float]:
        point = middle + turn @ np.array([x, y, 0.0])
        return [*point[:2], top + height]

    stacks: list[list[str]] = []
    for place, (count, (x, y)) in enumerate(zip(request["heights"], request["places"])):
        stacks.append([])
        for level in range(count):
            name = f"block{place}_{level}"
            frame = config.addFrame(name)
            frame.setShape(ry.ST.box, [EDGE, EDGE, EDGE]).setPosition(
                world(x, y, (level + 0.5) * EDGE)
            )
            stacks[-1].append(name)
        config.addFrame(f"place{place}").setPosition(world(x, y, 0.0))
    home, down = config.getJointState(), [0.0, 0.0, 1.0]
    moves = request["moves"]
    phases = 2 * len(moves) + 1
    begin = time.perf_counter()
    komo = ry.KOMO(config, phases, STEPS, 2, True)
    komo.addControlObjective([], 0, 1e-2)
    komo.addControlObjective([], 2, 1.0)
    for index, (source, target) in enumerate(moves):
        pick, place = 2 * index + 1, 2 * index + 2
        block = stacks[source].pop()
        x, y = request["places"][target]
        goal = world(x, y, (len(stacks[target]) + 0.5) * EDGE)
        stacks[target].append(block)
        komo.addModeSwitch([pick, place], ry.SY.stable, ["l_gripper", block], True)
        komo.addModeSwitch([place, -1.0], ry.SY.stable, ["table", block], False)
        komo.addObjective([pick], ry.FS.positionDiff, ["l_gripper", block], ry.OT.eq, [1e2])
        komo.addObjective([pick], ry.FS.vectorZ, ["l_gripper"], ry.OT.eq, [1e1], down)
        komo.addObjective([place], ry.FS.position, [block], ry.OT.eq, [1e2], goal)
        komo.addObjective([place], ry.FS.vectorZ, ["l_gripper"], ry.OT.eq, [1e1], down)
        for switch in (pick, place):
            komo.addObjective([switch], ry.FS.qItself, [], ry.OT.eq, [1e0], [], 1)
            around = [switch - 0.2, switch + 0.2]
            komo.addObjective(
                around, ry.FS.vectorZ, ["l_gripper"], ry.OT.sos, [1e0], [0.0, 0.0, 1.0]
            )
    komo.addObjective([phases], ry.FS.qItself, [], ry.OT.eq, [1e1], home)
    komo.addObjective([], ry.FS.jointLimits, [], ry.OT.ineq, [1e0])
    komo.addObjective([], ry.FS.accumulatedCollisions, [], ry.OT.eq, [1e0])
    solver = ry.NLP_Solver(komo.nlp(), verbose=0)
    found = solver.solve()
    return {"seconds": time.perf_counter() - begin, "feasible": bool(found.feasible)}


ANSWERS = {"toppra": toppra_durations, "komo": komo_seconds}


def main() -> None:
    for line in sys.stdin:
        request = json.loads(line)
        print(json.dumps(ANSWERS[request["ask"]](request)), flush=True)


if __name__ == "__main__":
    main()
