# SPDX-License-Identifier: Apache-2.0
"""Starts the nodes of the graph as processes of their own, as a person would, and stops them."""

from __future__ import annotations

import contextlib
import ctypes
import os
import signal
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from signal import Signals
from typing import Any, Final

from ament_index_python.packages import get_package_share_path
from tamp_runtime.domain import reserve_domain
from tamp_runtime.node_process import EXIT_HELD, EXIT_STUCK

#: The four nodes of the graph; each package's node has the package's name.
NODES: Final = ("sim_node", "perception_node", "planner_node", "motion_node")

#: What nodes name absolutely, by ROS's own custom; in a namespace it is that of the graph there.
NAMESPACED: Final = {"/clock": "clock", "/tf": "tf", "/tf_static": "tf_static"}

#: Exit codes of nodes that hung when they were stopped: they ended themselves, or were ended.
HUNG: Final = (EXIT_STUCK, EXIT_HELD, -signal.SIGABRT, -signal.SIGKILL)

#: A node ends itself before (``STOP_SECONDS``), unless the whole machine stands still [s].
_STOP_TIMEOUT: Final = 30.0
_PR_SET_PDEATHSIG: Final = 1


class NodeDiedError(RuntimeError):
    """A node's process ended although nobody stopped it; ``node`` names it."""

    def __init__(self, node: str, code: int, log: Path) -> None:
        tail = "\n".join(log.read_text(errors="replace").splitlines()[-8:])
        super().__init__(f"{node} ended with exit code {code}; its log {log} ends with:\n{tail}")
        self.node = node


class NodeProcesses:
    """The graph's processes, as a context manager; each node logs into a file of its own.

    Leaving it stops the nodes; one that hangs then is named on stderr.

    Args:
        log_folder: receives ``NODE.log``.
        parameters: parameters by node, added to those of ``config/demo.yaml``.
        nodes: which nodes to start.
        namespace: that of every node, such as ``/left``; the clock and the frames are in it, too.
        remappings: names by node, from → to, such as those of a relay between two nodes.
    """

    def __init__(
        self,
        log_folder: Path,
        parameters: Mapping[str, Mapping[str, Any]] | None = None,
        nodes: tuple[str, ...] = NODES,
        namespace: str = "",
        remappings: Mapping[str, Mapping[str, str]] | None = None,
    ) -> None:
        self._logs = log_folder
        self._parameters = parameters or {}
        self._nodes = nodes
        self._namespace = f"/{namespace.strip('/')}" if namespace.strip("/") else ""
        self._remappings = remappings or {}
        self._processes: dict[str, subprocess.Popen[bytes]] = {}

    def __enter__(self) -> NodeProcesses:
        self._logs.mkdir(parents=True, exist_ok=True)
        for node in self._nodes:
            (self._logs / f"{node}.log").unlink(missing_ok=True)
        try:
            for node in self._nodes:
                self.start(node)
        except BaseException:
            self.stop_all()
            raise
        return self

    def __exit__(self, *_error: object) -> None:
        for node, code in self.stop_all().items():
            if code in HUNG:
                log = self._logs / f"{node}.log"
                print(f"{node} hung when it was stopped (exit code {code}): {log}", file=sys.stderr)

    def start(self, node: str) -> None:
        """Starts one node by ``ros2 run``."""
        command = self.command(node)
        with (self._logs / f"{node}.log").open("ab") as log:
            # A session of its own: Ctrl-C in the terminal must reach the client first, which stops
            # the arm before the nodes go away.
            self._processes[node] = subprocess.Popen(
                command,
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=subprocess.STDOUT,
                start_new_session=True,
                preexec_fn=_set_up_child,
            )

    def command(self, node: str) -> list[str]:
        """What starts a node, for a person who wants to do the same by hand."""
        defaults = get_package_share_path("tamp_bringup") / "config" / "demo.yaml"
        command = ["ros2", "run", node, node, "--ros-args", "--params-file", str(defaults)]
        for name, value in self._parameters.get(node, {}).items():
            command += ["-p", f"{name}:={value}"]
        names = dict(self._remappings.get(node, {}))
        if self._namespace:
            # The first rule that fits counts.
            names = {**names, **{name: to for name, to in NAMESPACED.items() if name not in names}}
            names["__ns"] = self._namespace
        for name, to in names.items():
            command += ["-r", f"{name}:={to}"]
        return command

    def signal(self, node: str, number: Signals) -> None:
        """Sends a signal to a node that runs, such as SIGSTOP and SIGCONT."""
        self._signal(self._processes[node], number)

    def kill(self, node: str) -> None:
        """Ends a node by force, as a crash would; it may be started again."""
        process = self._processes.pop(node)
        self._signal(process, signal.SIGKILL)
        process.wait(_STOP_TIMEOUT)

    def restart(self, node: str) -> None:
        """Starts a node anew; one that still runs is stopped before."""
        if node in self._processes:
            self.stop(node)
        self.start(node)

    def stop(self, node: str) -> int:
        """Stops one node with SIGINT, and by force if it takes too long; returns its exit code.

        One of ``HUNG`` is that of a node that hung.
        """
        self._interrupt(self._processes[node])
        return self._wait(node)

    def stop_all(self) -> dict[str, int]:
        """Stops every node that runs, all at once; returns exit codes by node, as :meth:`stop`."""
        for process in self._processes.values():
            self._interrupt(process)
        return {node: self._wait(node) for node in list(self._processes)}

    def check(self) -> None:
        """Raises NodeDiedError if a node has ended by itself."""
        for node, process in self._processes.items():
            if (code := process.poll()) is not None:
                raise NodeDiedError(node, code, self._logs / f"{node}.log")

    def cpu_seconds(self) -> dict[str, float]:
        """CPU time that each node's process has used so far, by node [s] (Linux)."""
        ticks = os.sysconf("SC_CLK_TCK")
        used = {}
        for node, process in self._processes.items():
            # Behind the name in brackets, which may contain anything: proc(5), fields 14 and 15.
            fields = Path(f"/proc/{process.pid}/stat").read_text().rpartition(")")[2].split()
            used[node] = (int(fields[11]) + int(fields[12])) / ticks
        return used

    def _wait(self, node: str) -> int:
        process = self._processes.pop(node)
        # SIGABRT leaves in the log where each thread was.
        for force in (signal.SIGABRT, signal.SIGKILL):
            try:
                return process.wait(_STOP_TIMEOUT)
            except subprocess.TimeoutExpired:
                self._signal(process, force)
        return process.wait(_STOP_TIMEOUT)

    @classmethod
    def _interrupt(cls, process: subprocess.Popen[bytes]) -> None:
        cls._signal(process, signal.SIGINT)
        cls._signal(process, signal.SIGCONT)  # one that stands still hears nothing

    @staticmethod
    def _signal(process: subprocess.Popen[bytes], number: Signals) -> None:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, number)


def use_own_domain() -> int:
    """Takes a DDS domain that no other graph on this host takes, unless the environment has one.

    Returns:
        The domain id, also put into ``ROS_DOMAIN_ID`` for this process and its children.

    Raises:
        NoFreeDomainError: more graphs run at once than there are domains.
    """
    if "ROS_DOMAIN_ID" not in os.environ:
        os.environ["ROS_DOMAIN_ID"] = str(reserve_domain())
    return int(os.environ["ROS_DOMAIN_ID"])


def _set_up_child() -> None:
    """The child heeds SIGINT from its start, and gets SIGTERM if this process dies (Linux)."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGTERM)
