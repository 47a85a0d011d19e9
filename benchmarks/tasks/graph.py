# SPDX-License-Identifier: Apache-2.0
"""A running graph in a DDS domain of its own, and the logs of its nodes."""

from __future__ import annotations

import os
import time
from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Any, Final

import rclpy
from rclpy.signals import SignalHandlerOptions
from tamp_runtime.domain import release_domain, reserve_domain

from planner_node.cli.client import PlannerClient
from tamp_bringup.processes import NODES, NodeProcesses
from tamp_bringup.scene_observer import SceneObserver, SimulationError

#: How long a node may take until it is there, on a busy machine [s].
START_SECONDS: Final = 60.0
_DOMAINS_TRIED: Final = 5
_LOOK_SECONDS: Final = 1.0
_DOMAIN: Final = "ROS_DOMAIN_ID"


class DomainTakenError(SimulationError):
    """Another graph is in the domain; it may be what is left of one that was killed."""


class Graph:
    """The four nodes, what watches them and who asks; leaving it stops all.

    Each has a domain that no other process of this host has, unless the environment names one.
    Where nodes of another graph are found in it, the graph is started anew in another domain:
    nobody has asked it for anything yet.

    Args:
        logs: folder of the nodes' logs.
        parameters: by node.

    Attributes:
        processes, observer, planner: while it runs.
    """

    processes: NodeProcesses
    observer: SceneObserver
    planner: PlannerClient

    def __init__(self, logs: Path, parameters: Mapping[str, Mapping[str, Any]]) -> None:
        self.logs = logs
        self._parameters = parameters
        self._stack = ExitStack()

    def __enter__(self) -> Graph:
        """Returns when all nodes have started and perception says something.

        Raises:
            NodeDiedError: a node cannot start.
            SimulationError: some node is not there in time, or another graph is in the domain.
        """
        for attempt in range(_DOMAINS_TRIED):
            try:
                self._start()
                break
            except DomainTakenError:
                if _DOMAIN in os.environ or attempt == _DOMAINS_TRIED - 1:
                    raise
        return self

    def _start(self) -> None:
        with ExitStack() as stack:
            if _DOMAIN not in os.environ:
                domain = reserve_domain()
                os.environ[_DOMAIN] = str(domain)
                stack.callback(release_domain, domain)
                stack.callback(os.environ.pop, _DOMAIN)
            rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
            stack.callback(rclpy.try_shutdown)
            self.processes = stack.enter_context(NodeProcesses(self.logs, self._parameters))
            self.observer = stack.enter_context(SceneObserver())
            self.planner = stack.enter_context(PlannerClient())
            self._wait_until_ready()
            names = self.observer.node_names
            if several := [node for node in NODES if names.count(node) > 1]:
                domain_id = os.environ[_DOMAIN]
                raise DomainTakenError(
                    f"there is another {several[0]} in the domain {domain_id}; stop that graph"
                )
            self._stack = stack.pop_all()

    def __exit__(self, *error: Any) -> None:
        self._stack.__exit__(*error)

    def _wait_until_ready(self) -> None:
        """A node that cannot start is told at once, not when the time is over."""
        deadline = time.monotonic() + START_SECONDS
        while True:
            self.processes.check()
            try:
                self.observer.wait_for_nodes(NODES, timeout=_LOOK_SECONDS)
                self.observer.any_graph(timeout=_LOOK_SECONDS)
            except SimulationError:
                if time.monotonic() > deadline:
                    raise
            else:
                return

    def log_sizes(self) -> dict[str, int]:
        """How long each log is now; for :meth:`keep_logs`."""
        return {log.name: log.stat().st_size for log in self.logs.glob("*.log")}

    def keep_logs(self, folder: Path, since: Mapping[str, int]) -> None:
        """Copies what the nodes have logged since then."""
        folder.mkdir(parents=True, exist_ok=True)
        for log in self.logs.glob("*.log"):
            (folder / log.name).write_bytes(log.read_bytes()[since.get(log.name, 0) :])
