# SPDX-License-Identifier: Apache-2.0
"""Stands in for ``launch`` and ``launch_ros``, which PyPI does not have: it records what is asked.

The signatures are those of Jazzy as far as demo.launch.py uses them; what it does not know, it
refuses.
"""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from ament_index_python.packages import PackageNotFoundError

LAUNCH_FILE = Path(__file__).parents[3] / "ros_ws/src/tamp_bringup/launch/demo.launch.py"


@dataclass
class LaunchContext:
    launch_configurations: dict[str, str] = field(default_factory=dict)
    is_shutdown: bool = False


@dataclass
class LaunchConfiguration:
    variable_name: str

    def perform(self, context: LaunchContext) -> str:
        return context.launch_configurations[self.variable_name]


@dataclass
class LaunchDescription:
    entities: list[Any]


class DeclareLaunchArgument:
    def __init__(
        self,
        name: str,
        *,
        default_value: str | None = None,
        description: str | None = None,
        choices: list[str] | None = None,
    ) -> None:
        self.name, self.default_value = name, default_value
        self.description, self.choices = description, choices


@dataclass(kw_only=True)
class OpaqueFunction:
    function: Callable[[LaunchContext], list[Any]]


@dataclass(kw_only=True)
class LogInfo:
    msg: str


@dataclass
class RegisterEventHandler:
    event_handler: Any


@dataclass(kw_only=True)
class Shutdown:
    reason: str


@dataclass(kw_only=True)
class EmitEvent:
    event: Shutdown


@dataclass(kw_only=True)
class Node:
    executable: str
    package: str
    namespace: str | None = None
    parameters: list[Any] = field(default_factory=list)
    remappings: list[tuple[str, str]] = field(default_factory=list)
    arguments: list[str] = field(default_factory=list)
    output: str = "log"
    sigterm_timeout: str = "5"
    sigkill_timeout: str = "5"


@dataclass(kw_only=True)
class OnProcessExit:
    target_action: Node
    on_exit: Callable[[Any, LaunchContext], list[Any]]


@dataclass
class ProcessExited:
    returncode: int


MODULES: dict[str, tuple[type, ...]] = {
    "launch": (LaunchContext, LaunchDescription),
    "launch.actions": (
        *(DeclareLaunchArgument, EmitEvent, LogInfo, OpaqueFunction, RegisterEventHandler),
    ),
    "launch.event_handlers": (OnProcessExit,),
    "launch.events": (Shutdown,),
    "launch.substitutions": (LaunchConfiguration,),
    "launch_ros": (),
    "launch_ros.actions": (Node,),
}


class Launched:
    """What ``ros2 launch`` would do with the file and some arguments."""

    def __init__(
        self, monkeypatch: pytest.MonkeyPatch, installed: set[str], given: Mapping[str, str]
    ) -> None:
        for name, members in MODULES.items():
            module = ModuleType(name)
            for member in members:
                setattr(module, member.__name__, member)
            monkeypatch.setitem(sys.modules, name, module)
        spec = importlib.util.spec_from_file_location("demo_launch", LAUNCH_FILE)
        assert spec is not None and spec.loader is not None
        file = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(file)

        def prefix(package: str) -> str:
            if package not in installed:
                raise PackageNotFoundError(package)
            return "/opt"

        monkeypatch.setattr(file, "get_package_prefix", prefix)
        self.context = LaunchContext()
        self.arguments: dict[str, DeclareLaunchArgument] = {}
        entities = list(file.generate_launch_description().entities)
        self.entities: list[Any] = []
        while entities:
            entity = entities.pop(0)
            if isinstance(entity, DeclareLaunchArgument):
                self._declare(entity, given)
            elif isinstance(entity, OpaqueFunction):
                entities = [*entity.function(self.context), *entities]
            else:
                self.entities.append(entity)
        assert set(given) <= set(self.arguments)

    def _declare(self, argument: DeclareLaunchArgument, given: Mapping[str, str]) -> None:
        self.arguments[argument.name] = argument
        value = given.get(argument.name, argument.default_value)
        assert value is not None, f"{argument.name} has no default"
        if argument.choices and value not in argument.choices:
            raise RuntimeError(f"{argument.name}:={value} is not one of {argument.choices}")
        self.context.launch_configurations[argument.name] = value

    @property
    def nodes(self) -> dict[str, Node]:
        """The nodes by package, in the order of their start."""
        return {item.package: item for item in self.entities if isinstance(item, Node)}

    @property
    def said(self) -> list[str]:
        """What is logged."""
        return [item.msg for item in self.entities if isinstance(item, LogInfo)]

    def end(self, package: str, returncode: int) -> list[Any]:
        """What happens when a node's process ends."""
        node = self.nodes[package]
        handlers = [
            item.event_handler.on_exit
            for item in self.entities
            if isinstance(item, RegisterEventHandler) and item.event_handler.target_action is node
        ]
        return [
            action
            for handle in handlers
            for action in handle(ProcessExited(returncode), self.context)
        ]
