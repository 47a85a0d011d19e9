# SPDX-License-Identifier: Apache-2.0
"""What a notebook imports from each package: documented, and imported only when asked for."""

from __future__ import annotations

import importlib
import inspect
import subprocess
import sys

import pytest

PACKAGES = ("scene_graph", "sim_node", "perception_node", "planner_node", "motion_node")
#: Their packages are imported by executables before these can listen to Ctrl-C.
NODES = PACKAGES[1:]

EXPORTED = [
    (package, name) for package in PACKAGES for name in importlib.import_module(package).__all__
]


@pytest.mark.parametrize(("package", "name"), EXPORTED)
def test_every_exported_class_and_function_says_what_it_is(package: str, name: str) -> None:
    item = getattr(importlib.import_module(package), name)
    assert not inspect.ismodule(item), "a module of that name hides it"
    if inspect.isclass(item) or inspect.isfunction(item):
        assert inspect.getdoc(item)


@pytest.mark.parametrize("package", PACKAGES)
def test_an_unknown_name_is_an_attribute_error(package: str) -> None:
    with pytest.raises(AttributeError, match="teapot"):
        _ = importlib.import_module(package).teapot


@pytest.mark.parametrize("package", NODES)
def test_the_package_itself_imports_nothing_heavy(package: str) -> None:
    heavy = {"numpy", "pybullet", "torch", "casadi", "cv2", "rclpy"}
    script = f"import sys, {package}; print({heavy} & set(sys.modules))"
    ended = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True, timeout=120
    )
    assert ended.stdout.split("\n")[-2] == "set()"
