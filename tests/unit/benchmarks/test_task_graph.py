# SPDX-License-Identifier: Apache-2.0
"""A graph that is not alone in its domain is started anew in another, before anybody asks."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import tasks.graph
from tasks.graph import DomainTakenError, Graph

from tamp_bringup.processes import NODES


class Nothing:
    """Stands for what has a beginning and an end."""

    def __init__(self, *_: Any, **__: Any) -> None:
        pass

    def __enter__(self) -> Any:
        return self

    def __exit__(self, *_error: object) -> None:
        pass


class Processes(Nothing):
    running = 0

    def __enter__(self) -> Processes:
        Processes.running += 1
        return self

    def __exit__(self, *_error: object) -> None:
        Processes.running -= 1

    def check(self) -> None:
        pass


def observer_of(strangers: Callable[[], list[str]]) -> type:
    class Observer(Nothing):
        def __init__(self) -> None:
            super().__init__()
            self.node_names = [*NODES, "scene_observer", *strangers()]

        def wait_for_nodes(self, _names: Any, timeout: float) -> None:
            del timeout

        def any_graph(self, timeout: float) -> None:
            del timeout

    return Observer


@pytest.fixture
def fakes(monkeypatch: pytest.MonkeyPatch) -> pytest.MonkeyPatch:
    monkeypatch.setattr(tasks.graph, "NodeProcesses", Processes)
    monkeypatch.setattr(tasks.graph, "PlannerClient", Nothing)
    monkeypatch.setattr(tasks.graph.rclpy, "init", lambda **_: None)
    monkeypatch.setattr(tasks.graph.rclpy, "try_shutdown", lambda: None)
    monkeypatch.delenv("ROS_DOMAIN_ID")
    return monkeypatch


def test_it_goes_on_to_a_domain_where_it_is_alone(
    fakes: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    domains: list[str] = []

    def strangers() -> list[str]:
        domains.append(os.environ["ROS_DOMAIN_ID"])
        return ["planner_node"] if len(domains) < 3 else []

    fakes.setattr(tasks.graph, "SceneObserver", observer_of(strangers))
    with Graph(tmp_path, {}):
        assert len(set(domains)) == 3
        assert Processes.running == 1
    assert Processes.running == 0
    assert "ROS_DOMAIN_ID" not in os.environ


def test_it_gives_up_with_a_sentence(fakes: pytest.MonkeyPatch, tmp_path: Path) -> None:
    fakes.setattr(tasks.graph, "SceneObserver", observer_of(lambda: ["motion_node"]))
    with pytest.raises(DomainTakenError, match="another motion_node"), Graph(tmp_path, {}):
        pass
    assert Processes.running == 0


def test_a_domain_that_was_asked_for_is_kept(fakes: pytest.MonkeyPatch, tmp_path: Path) -> None:
    fakes.setenv("ROS_DOMAIN_ID", "77")
    fakes.setattr(tasks.graph, "SceneObserver", observer_of(lambda: ["sim_node"]))
    with pytest.raises(DomainTakenError, match="domain 77"), Graph(tmp_path, {}):
        pass
    assert os.environ["ROS_DOMAIN_ID"] == "77"
