# SPDX-License-Identifier: Apache-2.0
"""The graph under trial with its relays, and what a running trial is about."""

from __future__ import annotations

import time
from collections.abc import Collection
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

from faults.askers import Asker
from faults.eyes import Eyes
from faults.fault import Parameters, Phase
from faults.relay import Relays
from faults.topics import GROUND_TRUTH, remappings, topics_of
from planner_node.cli.client import PlannerClient
from scene_graph import Stacks
from sim_node.layouts import format_layout
from tamp_bringup.processes import NODES, NodeProcesses

#: How long a node may take until it is there [s].
START_SECONDS: Final = 60.0


@dataclass
class Setting:
    """What an injection can lay hands on.

    Attributes:
        others: what else was started on purpose, to be stopped when the fault ends.
        goal, initial, phase, seed, asker: of the running trial.
    """

    processes: NodeProcesses
    relays: Relays
    eyes: Eyes
    planner: PlannerClient
    folder: Path
    parameters: dict[str, dict[str, Any]]
    others: list[Any] = field(default_factory=list)
    goal: str = ""
    initial: Stacks = ()
    phase: Phase = Phase.PERCEIVE
    seed: int = 0
    asker: Asker | None = None

    def remember_layout(self, layout: Stacks) -> None:
        """A simulator that is started again, or a second one, shows the same blocks."""
        self.parameters["sim_node"]["layout"] = format_layout(layout)

    def wait_for_nodes(self, *names: str, count: int = 1) -> bool:
        """Whether so many nodes of each name are there in time."""
        return self.eyes.wait_for(
            lambda: all(self.eyes.nodes(name) >= count for name in names), START_SECONDS
        )

    def start_beside(self, *nodes: str) -> None:
        """Starts nodes a second time, and waits until they are seen and heard.

        The ground truth of a second simulator goes elsewhere: what is judged is the first one's.
        """
        second = NodeProcesses(
            self.folder / "logs_second",
            self.parameters,
            nodes,
            remappings={"sim_node": {GROUND_TRUTH: f"second/{GROUND_TRUTH}"}},
        )
        self.others.append(second)
        second.__enter__()
        self.wait_for_nodes(*nodes, count=2)
        time.sleep(2.0)  # for the signs of life of both to be heard

    def stop_others(self) -> None:
        """Stops what was started beside the graph."""
        while self.others:
            self.others.pop().__exit__(None, None, None)


class Graph:
    """Starts the four nodes with relays between them; leaving it stops all.

    Args:
        folder: receives the nodes' logs.
        groups: of relays, see :mod:`faults.topics`.
        parameters: of the nodes, besides the simulator's speed.
    """

    def __init__(
        self,
        folder: Path,
        groups: Collection[str],
        real_time_factor: float,
        parameters: Parameters = (),
    ) -> None:
        self._folder, self._topics = folder, topics_of(groups)
        self._parameters = parameters_by_node(
            (("sim_node", "real_time_factor", real_time_factor), *parameters)
        )
        self._stack = ExitStack()

    def __enter__(self) -> Setting:
        with ExitStack() as stack:
            relays = stack.enter_context(Relays(self._topics))
            processes = stack.enter_context(
                NodeProcesses(
                    self._folder / "logs",
                    self._parameters,
                    remappings=remappings(self._topics),
                )
            )
            eyes = stack.enter_context(Eyes())
            planner = stack.enter_context(PlannerClient())
            setting = Setting(processes, relays, eyes, planner, self._folder, self._parameters)
            stack.callback(setting.stop_others)
            setting.wait_for_nodes(*NODES)
            self._stack = stack.pop_all()
        return setting

    def __exit__(self, *error: Any) -> None:
        self._stack.__exit__(*error)


def parameters_by_node(parameters: Parameters) -> dict[str, dict[str, Any]]:
    """The same as :class:`NodeProcesses` takes them."""
    by_node: dict[str, dict[str, Any]] = {}
    for node, name, value in parameters:
        by_node.setdefault(node, {})[name] = value
    return by_node
