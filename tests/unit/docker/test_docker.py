# SPDX-License-Identifier: Apache-2.0
"""The image and the compose file fit the workspace; neither can be built or run here."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from importlib.metadata import requires
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
import yaml
from packaging.requirements import Requirement
from tamp_runtime.executable import PIP_NAMES

from tamp_bringup.processes import NODES

ROOT = Path(__file__).parents[3]
DOCKER = ROOT / "docker"
#: Without the breaks inside of instructions.
DOCKERFILE = re.sub(r"\\\n", " ", (DOCKER / "Dockerfile").read_text())
PARAMETERS = "/opt/tamp/share/tamp_bringup/config/demo.yaml"

PACKAGES = sorted(path.parent for path in (ROOT / "ros_ws" / "src").glob("*/package.xml"))

#: Import name: the rosdep key. Those of pip stand for a package of requirements.lock in the image.
ROSDEP_KEYS = {
    "PIL": "python3-pil",
    "casadi": "casadi-pip",
    "cv2": "python3-opencv",
    "matplotlib": "python3-matplotlib",
    "numpy": "python3-numpy",
    "pybullet": "python3-pybullet-pip",
    "pybullet_data": "python3-pybullet-pip",
    "scipy": "python3-scipy",
    "torch": "python3-pytorch-pip",
    "torchvision": "python3-pytorch-pip",
    "tqdm": "python3-tqdm",
    "yaml": "python3-yaml",
}
#: rosdep has no key for these; the packages' manifests say so in a comment.
WITHOUT_KEY = {"safetensors", "vector_quantize_pytorch"}
#: Extras that nothing needs; the manifests say so as well.
EXTRAS = {"unified_planning"}


@pytest.fixture(scope="module")
def services() -> dict[str, Any]:
    return yaml.safe_load((DOCKER / "compose.yaml").read_text())["services"]


def instructions(name: str) -> Iterator[list[str]]:
    """The words of every instruction of one kind, without flags."""
    for line in DOCKERFILE.splitlines():
        words = line.split()
        if words and words[0] == name:
            yield [word for word in words[1:] if not word.startswith("--")]


def pinned_names() -> set[str]:
    """What the Dockerfile takes from requirements.lock."""
    calls = re.findall(r"\./pins (?:--no-hashes )?requirements\.lock ([^>]+)>", DOCKERFILE)
    return {name for call in calls for name in call.split()}


def run_pins(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [DOCKER / "pins", *arguments], capture_output=True, text=True, cwd=ROOT, check=False
    )


def imported_modules(package: Path) -> set[str]:
    """Top-level names that a package's own modules import."""
    names: set[str] = set()
    for path in (package / package.name).rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Import):
                names |= {alias.name.split(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
                names.add(node.module.split(".")[0])
    return names - set(sys.stdlib_module_names) - {package.name}


# Dockerfile


def test_everything_that_is_copied_exists_and_reaches_the_build() -> None:
    kept = {
        line[1:]
        for line in (DOCKER / "Dockerfile.dockerignore").read_text().splitlines()
        if line.startswith("!")
    }
    sources = {
        source
        for line in re.findall(r"^COPY (.*)", DOCKERFILE, re.M)
        if "--from" not in line
        for source in [word for word in line.split() if not word.startswith("--")][:-1]
    }
    assert sources == kept
    for source in sources:
        assert (ROOT / source).exists(), source


def test_image_does_not_run_as_root() -> None:
    assert [words for words in instructions("USER")][-1] not in (["root"], ["0"])


def test_image_starts_from_the_ros_distribution_of_the_workspace() -> None:
    stages = {words[2] for words in instructions("FROM") if len(words) == 3}
    bases = {words[0] for words in instructions("FROM")} - stages
    assert bases == {"ros:jazzy"}


# Compose file


def test_there_is_one_service_a_node_and_they_start_by_default(services: dict[str, Any]) -> None:
    assert {name for name, service in services.items() if not service.get("profiles")} == set(NODES)


@pytest.mark.parametrize("node", NODES)
def test_node_runs_its_own_executable_with_the_parameters_of_the_demo(
    node: str, services: dict[str, Any]
) -> None:
    command = services[node]["command"]
    assert command[0] == f"/opt/tamp/lib/{node}/{node}"
    assert command[command.index("--params-file") + 1] == PARAMETERS


@pytest.mark.parametrize("name", [*NODES, "client", "demo"])
def test_service_shares_network_and_memory_and_has_an_init(
    name: str, services: dict[str, Any]
) -> None:
    service = services[name]
    assert (service["network_mode"], service["ipc"], service["init"]) == ("host", "host", True)
    assert service["build"]["dockerfile"] == "docker/Dockerfile"


def test_clients_are_executables_of_their_packages(services: dict[str, Any]) -> None:
    for name in ("client", "demo"):
        prefix, lib, package, executable = services[name]["entrypoint"][1].rsplit("/", 3)
        assert (prefix, lib) == ("/opt/tamp", "lib")
        setup = (ROOT / "ros_ws" / "src" / package / "setup.py").read_text()
        assert f'"{executable} = {package}.' in setup


# Dependencies


def manifest(package: Path) -> tuple[set[str], str]:
    """The dependencies that a package declares for its run, and its package.xml."""
    text = (package / "package.xml").read_text()
    root = ElementTree.fromstring(text.encode())
    return {str(item.text) for tag in ("exec_depend", "depend") for item in root.iter(tag)}, text


@pytest.mark.parametrize("package", PACKAGES, ids=lambda path: path.name)
def test_fault_14_every_import_is_declared_for_rosdep(package: Path) -> None:
    declared, text = manifest(package)
    imported = imported_modules(package)
    missing = {name for name in imported if ROSDEP_KEYS.get(name, name) not in declared}
    unspoken = {name for name in missing if f"{name} has no rosdep key" not in text}
    assert not missing - WITHOUT_KEY - EXTRAS, f"{package.name}/package.xml lacks {sorted(missing)}"
    assert not unspoken


@pytest.mark.parametrize("package", PACKAGES, ids=lambda path: path.name)
def test_no_python_package_is_declared_that_nothing_imports(package: Path) -> None:
    used = {ROSDEP_KEYS.get(name, name) for name in imported_modules(package)}
    assert manifest(package)[0] & set(ROSDEP_KEYS.values()) <= used


def test_fault_14_what_comes_from_pypi_is_pinned_in_the_image_named_in_the_readme() -> None:
    by_pip = {name for name, key in ROSDEP_KEYS.items() if key.endswith("-pip")}
    assert by_pip | WITHOUT_KEY == set(PIP_NAMES)
    from_pypi = set(PIP_NAMES.values())
    assert from_pypi <= pinned_names()
    keys = {key for key in ROSDEP_KEYS.values() if key.endswith("-pip")}
    skipped = re.findall(r'PIP_KEYS="([^"]*)"', DOCKERFILE)
    assert [set(item.split()) for item in skipped] == [keys]
    assert DOCKERFILE.count("rosdep install") == DOCKERFILE.count('--skip-keys "$PIP_KEYS"')
    readme = (ROOT / "README.md").read_text()
    assert [set(item.split()) for item in re.findall(r'--skip-keys "([^"]*)"', readme)] == [keys]
    assert from_pypi <= set(" ".join(re.findall(r"pip install (.*)", readme)).split())


@pytest.mark.parametrize("name", sorted(set(PIP_NAMES.values())))
def test_dependencies_of_what_is_pinned_are_pinned_or_from_ubuntu(name: str) -> None:
    """pip runs without looking for dependencies, so the list must be complete."""
    nvidia = re.compile(r"cuda-|nvidia-|triton$")  # not wanted by the builds for CPUs
    needed = {
        requirement.name
        for requirement in map(Requirement, requires(name) or [])
        if (requirement.marker is None or requirement.marker.evaluate({"extra": ""}))
        and not nvidia.match(requirement.name)
    }
    assert needed <= pinned_names() | {"numpy", "pillow"}


# docker/pins


def test_pins_of_the_dockerfile_are_all_in_the_lock() -> None:
    result = run_pins("requirements.lock", *sorted(pinned_names()))
    assert result.returncode == 0, result.stderr
    found = {match for match in re.findall(r"^([\w-]+)==", result.stdout, re.M)}
    assert found == pinned_names()
    assert "platform_machine" not in result.stdout


def test_pins_keep_the_hashes_unless_told_otherwise() -> None:
    assert "--hash=sha256:" in run_pins("requirements.lock", "casadi").stdout
    plain = run_pins("--no-hashes", "requirements.lock", "casadi").stdout
    assert re.fullmatch(r"casadi==[\d.]+ ;[^\\]*\n", plain)


def test_unknown_pin_stops_the_build_with_its_name() -> None:
    result = run_pins("requirements.lock", "casadi", "nonsense")
    assert result.returncode != 0
    assert "does not pin nonsense" in result.stderr
