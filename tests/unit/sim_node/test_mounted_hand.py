# SPDX-License-Identifier: Apache-2.0
"""An arm of one URDF carries the hand of another, with the same shapes and masses."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

from sim_node.simulated_arms import KUKA_IIWA, PANDA

HAND = ("panda_hand", "panda_leftfinger", "panda_rightfinger", "panda_grasptarget")


def links(path: Path) -> dict[str, ElementTree.Element]:
    return {item.get("name", ""): item for item in ElementTree.parse(path).getroot().iter("link")}


def mass(link: ElementTree.Element) -> str:
    element = link.find("inertial/mass")
    return "" if element is None else element.get("value", "")


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return tmp_path


def test_all_links_of_both_are_there_and_weigh_the_same() -> None:
    both, arm, hand = (links(path) for path in (KUKA_IIWA.urdf, KUKA_IIWA.description, PANDA.urdf))
    assert set(both) == {*arm, *HAND}
    for name, link in both.items():
        assert mass(link) == mass((hand if name in HAND else arm)[name])


def test_every_mesh_is_a_file() -> None:
    root = ElementTree.parse(KUKA_IIWA.urdf).getroot()
    meshes = [mesh.get("filename", "") for mesh in root.iter("mesh")]
    assert len(meshes) == 2 * (8 + 3)
    assert all(Path(name).is_file() for name in meshes)


def test_every_link_but_the_root_hangs_on_one_joint() -> None:
    root = ElementTree.parse(KUKA_IIWA.urdf).getroot()
    children = [element.get("link", "") for element in root.iter("child")]
    assert sorted(children) == sorted(set(links(KUKA_IIWA.urdf)) - {"lbr_iiwa_link_0"})


def test_the_arm_gets_the_speeds_that_are_given() -> None:
    assert KUKA_IIWA.hand is not None
    root = ElementTree.parse(KUKA_IIWA.urdf).getroot()
    speeds = {joint.get("name"): joint.find("limit") for joint in root.iter("joint")}
    for name, speed in KUKA_IIWA.hand.velocities:
        limit = speeds[name]
        assert limit is not None
        assert float(limit.get("velocity", "")) == speed


def test_it_is_made_once(cache: Path) -> None:
    first = KUKA_IIWA.urdf
    assert first.is_relative_to(cache)
    made = first.stat().st_mtime_ns
    assert KUKA_IIWA.urdf == first
    assert first.stat().st_mtime_ns == made
    assert list(first.parent.iterdir()) == [first]
