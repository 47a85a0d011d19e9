# SPDX-License-Identifier: Apache-2.0
"""sim/disturb for programs: a façade that spins by itself and waits for nothing for ever."""

from __future__ import annotations

import uuid
from typing import Any

from rclpy.node import Node
from tamp_interfaces.srv import Disturb
from tamp_runtime.neighbour import Neighbour
from tamp_runtime.node_thread import NodeThread
from tamp_runtime.service_call import ask


class SimulatorUnavailableError(RuntimeError):
    """sim_node does not answer; the message says what to do about it."""


class DisturbClient:
    """Asks sim_node to let something go wrong; has its own node and thread.

    ``rclpy``, or the given context, must be initialised before and shut down after.
    """

    def __init__(self, **node_arguments: Any) -> None:
        """``node_arguments`` go to the node, for example ``namespace``."""
        self._node = Node(f"disturb_client_{uuid.uuid4().hex[:6]}", **node_arguments)
        self._simulator = Neighbour(self._node, "sim_node")
        self._client = self._node.create_client(Disturb, "sim/disturb")
        self._thread = NodeThread(self._node)

    def __enter__(self) -> DisturbClient:
        return self

    def __exit__(self, *_error: object) -> None:
        self._thread.stop()
        self._node.destroy_node()

    def disturb(self, request: Disturb.Request, timeout: float = 10.0) -> Disturb.Response:
        """The answer, which may be a refusal.

        Raises:
            SimulatorUnavailableError: there is none within ``timeout`` [s].
        """
        client = self._client
        try:
            response: Disturb.Response = ask(
                lambda: client.call_async(request),
                client.service_is_ready,
                client.wait_for_service,
                timeout,
                self._simulator,
                lambda: self._node.count_services(client.service_name),
            )
        except TimeoutError:
            raise SimulatorUnavailableError(
                f"sim_node does not answer (waited {timeout:g} s); start it with: "
                "ros2 run sim_node sim_node"
            ) from None
        return response
