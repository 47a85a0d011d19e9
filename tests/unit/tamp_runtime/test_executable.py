# SPDX-License-Identifier: Apache-2.0
"""What is common to all executables: they can be stopped from their first moment on."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from importlib.metadata import distribution
from pathlib import Path

import pytest

PACKAGES = [path.parent.name for path in Path(__file__).parents[3].glob("ros_ws/src/*/setup.py")]
#: What takes long to import.
HEAVY = ("rclpy", "numpy", "torch", "casadi", "pybullet", "matplotlib")
#: As some libraries do, it survives what is raised while it is imported.
SLOW_PROGRAM = """
import time
print("importing", flush=True)
try:
    time.sleep(1000.0)
except KeyboardInterrupt:
    pass

def run():
    return 3
"""


def scripts(package: str) -> dict[str, str]:
    """The modules of a package's executables, by executable."""
    points = distribution(package.replace("_", "-")).entry_points
    return {item.name: item.module for item in points if item.group == "console_scripts"}


def test_the_workspace_has_executables() -> None:
    names = {name for package in PACKAGES for name in scripts(package)}
    assert {"sim_node", "demo", "achieve_goal", "train_visual"} <= names


@pytest.mark.parametrize("package", PACKAGES)
def test_every_executable_starts_in_a_module_that_is_there_at_once(package: str) -> None:
    if not (modules := scripts(package)):
        return
    assert set(modules.values()) == {f"{package}.executable"}
    code = f"import sys, {package}.executable; print([m for m in {HEAVY} if m in sys.modules])"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=120.0, check=True
    )
    assert done.stdout == "[]\n"


@pytest.mark.parametrize("ignored", [False, True], ids=["heard", "ignored"])
def test_sigint_while_the_program_is_imported_ends_it_with_the_code_for_that(
    tmp_path: Path, ignored: bool
) -> None:
    (tmp_path / "slow_program.py").write_text(SLOW_PROGRAM)
    action = signal.SIG_IGN if ignored else signal.SIG_DFL
    process = subprocess.Popen(
        [
            sys.executable,
            "-c",
            "import sys; from tamp_runtime.executable import run_module; "
            "sys.exit(run_module('slow_program', stopped=130))",
        ],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": f"{tmp_path}:{os.environ['PYTHONPATH']}"},
        preexec_fn=lambda: signal.signal(signal.SIGINT, action),
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "importing\n"
    process.send_signal(signal.SIGINT)
    _, stderr = process.communicate(timeout=120.0)
    assert (process.returncode, stderr) == (130, "")


def run_program(tmp_path: Path, program: str) -> subprocess.CompletedProcess[str]:
    """What becomes of an executable whose module has this text."""
    (tmp_path / "program.py").write_text(program)
    code = "import sys; from tamp_runtime.executable import run_module as r; sys.exit(r('program'))"
    return subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        timeout=120.0,
        check=False,
        env={**os.environ, "PYTHONPATH": f"{tmp_path}:{os.environ['PYTHONPATH']}"},
    )


@pytest.mark.parametrize(
    ("module", "advice"),
    [
        ("casadi", "-m pip install casadi'"),
        ("pybullet_data", "-m pip install pybullet'"),
        ("torch", "-m pip install torch'"),
        ("tamp_interfaces", "source the workspace's setup"),
        ("cv2", "rosdep install --from-paths ros_ws/src --ignore-src"),
    ],
)
@pytest.mark.parametrize("late", [False, True], ids=["at once", "when run"])
def test_fault_14_a_missing_module_is_one_sentence_that_says_how_to_get_it(
    tmp_path: Path, module: str, advice: str, late: bool
) -> None:
    hide = f"import sys\nsys.modules[{module!r}] = None\n"
    program = "def run():\n    import {0}.part\n" if late else "import {0}\n"
    done = run_program(tmp_path, hide + program.format(module))
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith("cannot start: ") and done.stderr.count("\n") == 1
    assert f"has no Python module {module};" in done.stderr
    assert advice in done.stderr


ENDING = """
import atexit, sys
from tamp_runtime.executable import end_process
atexit.register(lambda: print("taken apart"))
print("said", end="")
print("warned", end="", file=sys.stderr)
end_process(7)
"""


def test_fault_11_a_process_is_ended_with_all_that_it_said_and_without_being_taken_apart() -> None:
    ended = subprocess.run([sys.executable, "-c", ENDING], capture_output=True, text=True)
    assert (ended.returncode, ended.stdout, ended.stderr) == (7, "said", "warned")
