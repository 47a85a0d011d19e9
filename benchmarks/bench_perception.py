# SPDX-License-Identifier: Apache-2.0
"""``make bench-perception``: from a picture to its scene graph in the running graph.

The four nodes run as processes, in real time, and carry out tasks of 6 blocks (seeds from 1000).
Every picture of the camera counts, from the reset of a scene to the end of its task: when the
simulator published it, and when perception published the graph of this stamp, both by the time
that DDS writes beside a message. Each task leaves a file in ``runs/perception_graph``, so that a
run can be taken up again. Writes ``benchmarks/results/perception_graph.json``.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from contextlib import ExitStack
from statistics import median
from typing import Any, Final

import yaml
from frame_watch import FrameWatch
from kept_results import FIRST_SEED, RUNS, kept, options
from results_file import Row, print_rows, write_result
from tamp_runtime.node_process import prepare_process
from tasks.campaign import measure
from tasks.draw import draw_task
from tasks.family import family_of
from tasks.graph import Graph
from tqdm import tqdm

from scene_graph import GraphStatus

#: Width, height, required milliseconds.
SIZES: Final = ((256, 256, 30.0), (640, 480, 60.0))
BLOCKS: Final = 6
#: Of each size of pictures.
TASKS: Final = 6
#: Of the camera [Hz]; with the rounding of the time in which graphs are counted.
REQUIRED_RATE: Final = 9.9
FOLDER: Final = "perception_graph"


class Bench:
    """A running graph whose camera has pictures of one size; it starts with the first task."""

    def __init__(self, width: int, height: int) -> None:
        self.name = f"{width}x{height}"
        self._folder = RUNS / FOLDER / self.name
        self._size = {"width": width, "height": height}
        self._stack = ExitStack()
        self._graph: Graph | None = None
        self._watch: FrameWatch | None = None

    def __enter__(self) -> Bench:
        return self

    def __exit__(self, *error: Any) -> None:
        self._stack.__exit__(*error)

    def task(self, seed: int) -> dict[str, Any]:
        """Has a task done; every picture and its graph."""
        graph, watch = self._running()
        used = graph.processes.cpu_seconds()["perception_node"]
        watch.clear()
        result = measure(graph, draw_task(family_of(BLOCKS), seed))
        used = graph.processes.cpu_seconds()["perception_node"] - used
        return {
            "seed": seed,
            "success": result["success"],
            "failure": result["failure"],
            "wall_seconds": result["wall_seconds"],
            "real_time_factor": result["real_time_factor"],
            "cpu_seconds": round(used, 3),
            **watch.to_json(),
        }

    def _running(self) -> tuple[Graph, FrameWatch]:
        if self._graph is None or self._watch is None:
            self._folder.mkdir(parents=True, exist_ok=True)
            scene = (self._folder / "scene.yaml").resolve()
            scene.write_text(yaml.safe_dump({"cameras": [self._size]}))
            simulator = {"real_time_factor": 1.0, "scene": str(scene), "blocks": BLOCKS}
            logs = self._folder / "logs"
            self._graph = self._stack.enter_context(Graph(logs, {"sim_node": simulator}))
            self._watch = self._stack.enter_context(FrameWatch())
        return self._graph, self._watch


def rows_of(name: str, required: float, tasks: Sequence[dict[str, Any]]) -> list[Row]:
    """What tasks say of one size of pictures."""
    every = [frame for task in tasks for frame in task["frames"]]
    graphs = [frame for frame in every if frame["status"] is not None]
    moving = [frame for frame in every if frame["moving"]]
    answered = [frame for frame in moving if frame["status"] is not None]
    seconds = sum(task["moving_seconds"] for task in tasks)
    whole = [1e3 * frame["seconds"] for frame in graphs]
    own = [1e3 * frame["node_seconds"] for frame in graphs]
    used = sum(1e3 * task["cpu_seconds"] for task in tasks) / len(graphs)
    confident = sum(frame["status"] == GraphStatus.CONFIDENT for frame in graphs)
    where = f"{name}, {BLOCKS} blocks, four nodes, real time"
    return [
        Row(where, "picture published to graph published, median over all frames",
            median(whole), "ms", len(whole), (min(whole), max(whole)), f"<= {required:g}", 51.0,
            f"{confident} of them confident; the thesis' time is that of confident graphs"),
        Row(where, "picture published to graph published, 95th percentile",
            sorted(whole)[(95 * len(whole)) // 100], "ms", len(whole)),
        Row(where, "of it in perception_node, median", median(own), "ms", len(own),
            (min(own), max(own)), note="from the arrival of the first image of a frame"),
        Row(where, "graphs a second while the arm moves", len(answered) / seconds, "Hz",
            len(answered), required=f">= {REQUIRED_RATE:g}"),
        Row(where, "pictures that became a graph while the arm moves",
            len(answered) / len(moving), "", len(moving), required=">= 0.99"),
        Row(where, "perception_node, CPU time a graph", used, "ms", len(graphs),
            note="of the whole process, mean"),
        Row(where, "tasks that succeeded", sum(task["success"] for task in tasks) / len(tasks), "",
            len(tasks)),
    ]  # fmt: skip


def main() -> None:
    """Measures, prints and writes."""
    arguments = options(__doc__, TASKS, 1)
    prepare_process()
    start, rows = time.perf_counter(), []
    seeds = range(arguments.seed, arguments.seed + arguments.n)
    for width, height, required in SIZES:
        with Bench(width, height) as bench:
            tasks = [
                kept(f"{FOLDER}/{bench.name}", seed, arguments.resume, bench.task)
                for seed in tqdm(seeds, desc=bench.name, unit="task")
            ]
        rows += rows_of(bench.name, required, tasks)
    print_rows(rows)
    if arguments.seed != FIRST_SEED:
        return
    seconds = time.perf_counter() - start
    command = "make bench-perception" + (f" N={arguments.n}" if arguments.n != TASKS else "")
    path = write_result("perception_graph", command, rows, seconds)
    print(f"written to {path}")


if __name__ == "__main__":
    main()
