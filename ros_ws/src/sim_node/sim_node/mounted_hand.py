# SPDX-License-Identifier: Apache-2.0
"""An arm of one URDF with the hand of another one screwed to its flange."""

from __future__ import annotations

import hashlib
import os
import tempfile
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass
from pathlib import Path

from .meshes.light_urdf import cache_folder


@dataclass(frozen=True)
class MountedHand:
    """What is screwed to an arm, and the arm's own speeds.

    Attributes:
        urdf: has the hand somewhere in it.
        root: the hand's first link; all that it carries comes with it.
        flange: the arm's link that carries it.
        distance: of the hand's frame from the flange's, along z, without a turn [m].
        velocities: of the arm's joints, where its URDF has none that are true; by name [rad/s].
    """

    urdf: Path
    root: str
    flange: str
    distance: float
    velocities: tuple[tuple[str, float], ...] = ()


def with_hand(arm: Path, hand: MountedHand) -> Path:
    """Path of a URDF of both; meshes are named by their absolute paths.

    It is made when it is not in the cache, whole or not at all.

    Raises:
        OSError: if one of the two cannot be read, or the cache cannot be written.
    """
    text = _joined(arm, hand)
    digest = hashlib.sha256(text.encode()).hexdigest()[:16]
    result = cache_folder() / f"{arm.parent.name}-{digest}.urdf"
    if not result.is_file():
        handle, part = tempfile.mkstemp(dir=result.parent)
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            file.write(text)
        Path(part).replace(result)
    return result


def _joined(arm: Path, hand: MountedHand) -> str:
    root, other = _parsed(arm), _parsed(hand.urdf)
    speeds = dict(hand.velocities)
    for joint in root.iter("joint"):
        limit = joint.find("limit")
        if limit is not None and joint.get("name") in speeds:
            limit.set("velocity", str(speeds[joint.get("name", "")]))
    mount = ElementTree.SubElement(root, "joint", name=f"{hand.root}_mount", type="fixed")
    ElementTree.SubElement(mount, "origin", xyz=f"0 0 {hand.distance}", rpy="0 0 0")
    ElementTree.SubElement(mount, "parent", link=hand.flange)
    ElementTree.SubElement(mount, "child", link=hand.root)
    carried = {hand.root}
    joints = other.findall("joint")
    for _ in joints:  # as often as the longest chain can be long
        carried |= {_end(joint, "child") for joint in joints if _end(joint, "parent") in carried}
    root.extend(other.findall("material"))
    root.extend(link for link in other.findall("link") if link.get("name") in carried)
    root.extend(joint for joint in joints if _end(joint, "parent") in carried)
    # Bullet's anchors hold a block even between fingers that open with all their force, where
    # another arm than the hand's own carries them: in each of five towers of three.
    for contact in root.iter("contact"):
        for anchor in contact.findall("friction_anchor"):
            contact.remove(anchor)
    return ElementTree.tostring(root, encoding="unicode")


def _parsed(path: Path) -> ElementTree.Element:
    root = ElementTree.parse(path).getroot()
    for mesh in root.iter("mesh"):
        name = mesh.get("filename", "").removeprefix("package://")
        mesh.set("filename", str(path.parent / name))
    return root


def _end(joint: ElementTree.Element, tag: str) -> str:
    element = joint.find(tag)
    return "" if element is None else element.get("link", "")
