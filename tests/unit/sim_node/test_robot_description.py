# SPDX-License-Identifier: Apache-2.0
"""The published description is the arm's, whatever it says of meshes, and can be used elsewhere."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np
import pybullet
import pytest
from numpy.typing import NDArray

from sim_node.arm_shapes import boxes_around
from sim_node.simulated_arms import PANDA, SIMULATED_ARMS
from sim_node.urdf import BOXES, FILES, robot_description

Array = NDArray[np.float64]
SHAPES = ("visual", "collision")


def without_shapes(text: str) -> list[str]:
    root = ElementTree.fromstring(text)
    for link in root.iter("link"):
        for tag in SHAPES:
            for element in link.findall(tag):
                link.remove(element)
    return [f"{item.tag} {sorted(item.attrib.items())}" for item in root.iter()]


def vertices(path: Path) -> Array:
    lines = (line.split() for line in path.read_text().splitlines())
    return np.array([[float(x) for x in line[1:4]] for line in lines if line[:1] == ["v"]])


def numbers(element: ElementTree.Element, name: str) -> Array:
    return np.array([float(word) for word in element.attrib[name].split()])


@pytest.mark.parametrize("mesh_uris", [BOXES, FILES, "package://my_description"])
@pytest.mark.parametrize("name", sorted(SIMULATED_ARMS))
def test_only_the_shapes_differ_from_the_original(name: str, mesh_uris: str) -> None:
    arm = SIMULATED_ARMS[name]
    published = robot_description(arm, mesh_uris)
    assert without_shapes(published) == without_shapes(arm.urdf.read_text())


def test_fault_12_the_description_names_no_file_of_this_machine() -> None:
    text = robot_description()
    assert "mesh" not in text
    assert "://" not in text.replace('xmlns:xacro="http://www.ros.org/wiki/xacro"', "")
    root = ElementTree.fromstring(text)
    original = ElementTree.fromstring(PANDA.urdf.read_text())
    for tag in SHAPES:
        drawn = {link.get("name") for link in root.iter("link") if link.find(tag) is not None}
        assert drawn == {
            link.get("name") for link in original.iter("link") if link.find(tag) is not None
        }


def test_fault_12_boxes_cover_the_arm_s_collision_meshes() -> None:
    root = ElementTree.fromstring(robot_description())
    boxes = {link.get("name"): link.findall("collision") for link in root.iter("link")}
    checked = 0
    for link in ElementTree.fromstring(PANDA.urdf.read_text()).iter("link"):
        for collision in link.findall("collision"):
            origin, mesh = collision.find("origin"), collision.find("geometry/mesh")
            assert mesh is not None
            if origin is not None and np.any(numbers(origin, "rpy")):
                continue  # the turned finger: its boxes are those of the other one, turned
            shift = numbers(origin, "xyz") if origin is not None else np.zeros(3)
            path = PANDA.urdf.parent / mesh.attrib["filename"].removeprefix("package://")
            points = vertices(path) + shift
            covered = np.zeros(len(points), bool)
            for item in boxes[link.get("name")]:
                place, box = item.find("origin"), item.find("geometry/box")
                assert place is not None and box is not None
                away = np.abs(points - numbers(place, "xyz")) - 0.5 * numbers(box, "size")
                covered |= away.max(axis=1) < 2e-4
            assert covered.all(), link.get("name")
            checked += 1
    assert checked >= 9


def test_fault_12_physics_loads_it_without_any_file_and_moves_the_same_joints(
    tmp_path: Path,
) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(robot_description())
    client = pybullet.connect(pybullet.DIRECT)
    try:
        limits = []
        for urdf in (path, PANDA.urdf):
            body = pybullet.loadURDF(str(urdf), useFixedBase=True, physicsClientId=client)
            infos = [
                pybullet.getJointInfo(body, index, physicsClientId=client)
                for index in range(pybullet.getNumJoints(body, physicsClientId=client))
            ]
            limits.append([(info[1], info[2], *info[8:12]) for info in infos])
        assert limits[0] == limits[1]
    finally:
        pybullet.disconnect(client)


def test_a_prefix_goes_before_the_paths_in_the_arm_s_folder() -> None:
    text = robot_description(PANDA, "package://my_description/")
    assert 'filename="package://my_description/meshes/visual/link1.obj"' in text
    assert "file://" not in text


def test_files_are_there_on_this_machine() -> None:
    root = ElementTree.fromstring(robot_description(PANDA, FILES))
    names = [mesh.attrib["filename"] for mesh in root.iterfind(".//mesh")]
    assert names and all(Path(name.removeprefix("file://")).is_file() for name in names)


@pytest.mark.parametrize("nonsense", ["", "file", "meshes/", "package:// x"])
def test_anything_else_is_refused_with_what_is_possible(nonsense: str) -> None:
    with pytest.raises(ValueError, match="'boxes', 'files' nor the beginning of a URI"):
        robot_description(PANDA, nonsense)


def test_slices_of_a_slanted_bar_are_smaller_than_one_box_around_it() -> None:
    """A bar of 1 x 1 cm along the diagonal of the x-z plane, as two triangles a side."""
    across = np.array([[0.01, 0.0, -0.01], [0.0, 0.01, 0.0]])
    along = np.array([0.3, 0.0, 0.31])
    corners = np.array([i * across[0] + j * across[1] + k * along
                        for k in (0, 1) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))])  # fmt: skip
    sides = [(a, (a + 1) % 4, 4 + (a + 1) % 4, 4 + a) for a in range(4)]
    faces = np.array([face for a, b, c, d in sides for face in ((a, b, c), (a, c, d))])
    boxes = boxes_around(corners, faces, thickness=0.04)
    assert len(boxes) == 8
    whole = np.prod(corners.max(axis=0) - corners.min(axis=0))
    assert sum(np.prod(box.size) for box in boxes) < 0.3 * whole
    for share in np.linspace(0.0, 1.0, 50):  # the edges of the bar, point by point
        for corner in range(4):
            point = (1 - share) * corners[corner] + share * corners[4 + corner]
            assert any(np.all(np.abs(point - b.center) <= 0.5 * b.size + 1e-9) for b in boxes)
