# SPDX-License-Identifier: Apache-2.0
"""``make bench-sim``: how quick the simulator is, and whether its pictures are the physics'.

Pictures beside those of pybullet's own software renderer, in turns; every pixel of random scenes
(seeds from 1000) beside the physics' ray casts; the whole graph as fast as it goes. Writes
``benchmarks/results/sim.json``; ``QUICK=1`` looks at 10 scenes.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np
import pybullet
from results_file import Row, print_rows, quick, write_result
from sim_peer import edges, exact_ray_cast, tiny_picture
from tqdm import tqdm

from sim_node.layouts import random_layout
from sim_node.scene import CameraConfig, SceneConfig
from sim_node.world import World
from tamp_bringup.processes import NodeProcesses, use_own_domain

FIRST_SEED: Final = 1000
#: Width, height, required milliseconds.
SIZES: Final = ((256, 256, 5.0), (640, 480, 15.0))
#: Arm configurations in which it is before the camera, over the stacks [rad, m].
OVER_THE_STACKS: Final = (
    (0.0, 0.35, 0.0, -2.2, 0.0, 2.55, 0.785, 0.02, 0.02),
    (-0.3, 0.5, 0.1, -1.9, 0.2, 2.4, 0.3, 0.04, 0.04),
)


def put_arm(world: World, positions: tuple[float, ...]) -> None:
    """Puts the arm into a configuration, without physics."""
    for index, position in zip(world.joint_indices, positions):
        pybullet.resetJointState(world.robot, index, position, 0.0, physicsClientId=world.client)


def put_arm_away(world: World) -> None:
    """Where no ray meets it: the physics knows its hulls, the camera its looks."""
    pybullet.resetBasePositionAndOrientation(
        world.robot, (0.0, 0.0, 100.0), (0.0, 0.0, 0.0, 1.0), physicsClientId=world.client
    )


def milliseconds(picture: Callable[[], object]) -> float:
    """Wall time of one picture."""
    begin = time.perf_counter()
    picture()
    return 1000.0 * (time.perf_counter() - begin)


def picture_rows(scenes: int) -> list[Row]:
    """Times of pictures with the arm in view, ours and pybullet's in turns.

    The first picture of a scene, and one after the arm has moved on: a camera that runs takes ten
    of those a second, and one of the first only after a reset.
    """
    rows = []
    for width, height, required in SIZES:
        first, later, theirs = [], [], []
        camera = replace(CameraConfig(), width=width, height=height)
        with World(SceneConfig(cameras=(camera,))) as world:
            for seed in tqdm(range(FIRST_SEED, FIRST_SEED + scenes), f"{width}x{height}"):
                world.reset(random_layout(seed, 3 + seed % 5), seed)
                put_arm(world, OVER_THE_STACKS[seed % len(OVER_THE_STACKS)])
                first.append(milliseconds(world.render))
                theirs.append(milliseconds(lambda: tiny_picture(world)))
                put_arm(world, OVER_THE_STACKS[(seed + 1) % len(OVER_THE_STACKS)])
                later.append(milliseconds(world.render))
        name = f"{width}x{height}, colour, depth and labels, arm in view"
        for who, times, bound, note in (
            ("ours, as a running camera takes them", later, f"<= {required}", None),
            ("ours, the first after a reset", first, None, "one a reset: not what is required"),
            ("pybullet's TinyRenderer", theirs, None, None),
        ):
            rows.append(
                Row(name, f"a picture, median, {who}", statistics.median(times), "ms", len(times),
                    (min(times), max(times)), bound, note=note)
            )  # fmt: skip
    return rows


def truth_rows(scenes: int) -> list[Row]:
    """Every pixel beside the ray that the physics casts through it."""
    equal, pixels, worst, far = 0, 0, 0.0, 0
    with World() as world:
        for seed in tqdm(range(FIRST_SEED, FIRST_SEED + scenes), "rays"):
            world.reset(random_layout(seed, 3 + seed % 5), seed)
            put_arm_away(world)
            frame = world.render()
            labels, depth = exact_ray_cast(world)
            same = frame.labels == labels
            equal, pixels = equal + int(same.sum()), pixels + same.size
            inner = same & (depth > 0.0) & ~edges(depth)
            error = np.abs(frame.depth - depth)[inner]
            worst, far = max(worst, float(error.max())), far + int((error > 2e-4).sum())
    name = "every pixel beside the physics' ray casts"
    return [
        Row(name, "labels equal", equal / pixels, "", pixels, required=">= 0.999",
            note=f"{scenes} scenes"),
        Row(name, "depth, greatest difference away from edges", 1000.0 * worst, "mm", pixels,
            required="<= 0.2", note="edges: inverse depth bends or jumps"),
    ]  # fmt: skip


def physics_rows(seconds: float) -> list[Row]:
    """Simulated seconds a second of the physics alone, and with a picture every 0.1 s."""
    rows = []
    with World() as world:
        world.reset(random_layout(FIRST_SEED, 6), FIRST_SEED)
        for name, pictured in (("physics alone", False), ("physics and 10 Hz camera", True)):
            begin, start = time.perf_counter(), world.time
            while time.perf_counter() < begin + seconds:
                for _ in range(24):
                    world.step()
                if pictured:
                    world.render()
            factor = (world.time - start) / (time.perf_counter() - begin)
            rows.append(Row(name, "real-time factor", factor, "", 1))
    return rows


def graph_rows(seconds: float) -> list[Row]:
    """The whole graph as fast as it goes, with an idle arm: its speed, and what each node costs."""
    import rclpy
    from tamp_runtime.node_process import prepare_process

    use_own_domain()
    prepare_process()
    rclpy.init()
    parameters = {"sim_node": {"real_time_factor": 0.0, "blocks": 6, "seed": FIRST_SEED}}
    try:
        with NodeProcesses(Path("runs") / "bench_sim", parameters) as processes:
            simulated_time()
            time.sleep(15.0)  # the other nodes start, and build their problems
            begin, start, before = time.monotonic(), simulated_time(), processes.cpu_seconds()
            time.sleep(seconds)
            simulated, used = simulated_time() - start, processes.cpu_seconds()
            wall = time.monotonic() - begin
    finally:
        rclpy.shutdown()
    name = "whole graph, 10 Hz camera, as fast as it goes"
    return [
        Row(name, "real-time factor", simulated / wall, "", 1, required=">= 8"),
        *(
            Row(name, f"{node}, CPU time a simulated second",
                1000.0 * (used[node] - before[node]) / simulated, "ms", 1)
            for node in used
        ),
    ]  # fmt: skip


def simulated_time() -> float:
    """The graph's time now [s]; nobody listens to it in between, which would cost as much."""
    import rclpy
    from rclpy.wait_for_message import wait_for_message
    from rosgraph_msgs.msg import Clock
    from tamp_runtime.messages.stamps import seconds
    from tamp_runtime.qos import SENSOR_DATA

    node = rclpy.create_node("bench_sim")
    try:
        heard, message = wait_for_message(
            Clock, node, "clock", qos_profile=SENSOR_DATA, time_to_wait=60.0
        )
    finally:
        node.destroy_node()
    if not heard:
        raise RuntimeError("nothing arrives on clock within 60 s; see runs/bench_sim/sim_node.log")
    return float(seconds(message.clock))


def main() -> None:
    argparse.ArgumentParser(description=__doc__).parse_args()
    scenes = 10 if quick() else 200
    begin = time.monotonic()
    rows = [
        *picture_rows(scenes),
        *truth_rows(scenes),
        *physics_rows(3.0 if quick() else 10.0),
        *graph_rows(10.0 if quick() else 30.0),
    ]
    print_rows(rows)
    path = write_result("sim", "make bench-sim", rows, time.monotonic() - begin)
    print(f"written to {path}")


if __name__ == "__main__":
    main()
