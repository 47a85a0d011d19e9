# SPDX-License-Identifier: Apache-2.0
"""The scene of a recording as a MuJoCo model (MJCF): one text, no files beside it.

Chosen for what is physically there, and the same for every task:

- Contacts are elliptic friction cones. The coefficients of each pair are those of pybullet, the
  product of the two bodies' (:func:`pair_friction`), so nobody sticks better here.
- Contacts are stiff: a time constant of four time steps. At MuJoCo's default of 20 ms a tower of
  six 80 g blocks sinks by millimetres into itself.
- MuJoCo's friction is soft: what is held slides out of a hand slowly. ``impratio`` makes it as
  stiff as the normal force, and the no-slip solver removes the rest, as no real block creeps.
- Flat things touch in more than one point (``multiccd``); with one point a tower would be a
  pile of balls.
- Arm links carry the masses and inertias that pybullet uses, and the inertia of the rotors
  behind their gears, which URDFs leave out.
- The arm touches table and blocks, and its fingers one another; other links of the arm do not
  touch each other.
"""

from __future__ import annotations

import itertools
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterable, Sequence
from typing import Final

import numpy as np

from .arm_links import Link
from .recording import BOX, CYLINDER, SPHERE, Body

#: Physics steps between two commands, and thus the time step: 1/960 s, as the real arm's 1 kHz.
SUBSTEPS: Final = 4
#: Time step of the controller, that of pybullet's world [s].
CONTROL_STEP: Final = 1.0 / 240.0
TIMESTEP: Final = CONTROL_STEP / SUBSTEPS
#: Rotors behind their gears, seen from the joint [kg m²].
ROTOR_INERTIA: Final = 0.1
#: The same for the fingers' drive, seen from a finger [kg].
FINGER_DRIVE: Final = 0.1
_CONTACT: Final = f"{4 * TIMESTEP:.6g} 1"
_IMPEDANCE: Final = "0.95 0.99 0.001"
NOSLIP_ITERATIONS: Final = 5


def pair_friction(
    first: tuple[float, float, float], second: tuple[float, float, float]
) -> tuple[float, float, float]:
    """Sliding [], spinning [m] and rolling [m] friction between two bodies, as in Bullet.

    μ = μ₁ μ₂; the other two are s₁ μ₂ + s₂ μ₁ (btManifoldResult).
    """
    (mu_a, spin_a, roll_a), (mu_b, spin_b, roll_b) = first, second
    return mu_a * mu_b, spin_a * mu_b + spin_b * mu_a, roll_a * mu_b + roll_b * mu_a


def mjcf(links: Sequence[Link], bodies: Sequence[Body], fingers: tuple[str, str]) -> str:
    """The model's text.

    Args:
        links: of the arm, parents first.
        bodies: blocks, which get a free joint each, and what does not move.
        fingers: names of the two joints that one motor drives.
    """
    root = ElementTree.Element("mujoco", model="replay")
    _add(root, "compiler", angle="radian", autolimits="true")
    option = _add(
        root,
        "option",
        timestep=repr(TIMESTEP),
        gravity="0 0 -9.81",
        cone="elliptic",
        impratio="10",
        noslip_iterations=str(NOSLIP_ITERATIONS),
        integrator="implicitfast",
    )
    _add(option, "flag", multiccd="enable")
    assets, world = _add(root, "asset"), _add(root, "worldbody")
    for link in links:
        if link.hull is not None:
            _add(assets, "mesh", name=link.name, vertex=_text(link.hull.ravel()))
    elements = {"": world}
    for link in links:
        elements[link.name] = _add_link(elements[link.parent], link)
    for body in bodies:
        _add_body(world, body)
    _add_pairs(_add(root, "contact"), links, bodies, fingers)
    left, right = fingers
    equality = _add(root, "equality")
    _add(equality, "joint", joint1=left, joint2=right, polycoef="0 1 0 0 0", solref=_CONTACT)
    motors = _add(root, "actuator")
    for link in links:
        if link.joint:
            limits = _text([-link.effort, link.effort])
            _add(motors, "motor", name=link.joint, joint=link.joint, ctrlrange=limits)
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode")


def _add_link(parent: ElementTree.Element, link: Link) -> ElementTree.Element:
    body = _add(
        parent,
        "body",
        name=f"link:{link.name}",
        pos=_text(link.position),
        quat=_quaternion(link.quaternion),
    )
    if link.joint:
        drive = FINGER_DRIVE if link.kind == "slide" else ROTOR_INERTIA
        _add(
            body,
            "joint",
            name=link.joint,
            type=link.kind,
            axis=_text(link.axis),
            range=_text([link.lower, link.upper]),
            armature=repr(drive),
        )
    if link.mass > 0.0:
        _add(
            body,
            "inertial",
            pos=_text(link.center),
            mass=repr(link.mass),
            diaginertia=_text(link.inertia),
        )
    if link.hull is not None:
        _add(body, "geom", name=f"link:{link.name}", type="mesh", mesh=link.name, **_UNTOUCHED)
    return body


def _add_body(world: ElementTree.Element, body: Body) -> None:
    x, y, z = (0.5 * extent for extent in body.size)
    sizes = {BOX: [x, y, z], CYLINDER: [x, z], SPHERE: [x]}
    element = _add(
        world,
        "body",
        name=f"body:{body.name}",
        pos=_text(body.position),
        quat=_quaternion(np.array(body.quaternion)),
    )
    if body.mass > 0.0:
        _add(element, "freejoint", name=f"body:{body.name}")
    _add(
        element,
        "geom",
        name=f"body:{body.name}",
        type=body.shape,
        size=_text(sizes[body.shape]),
        mass=repr(body.mass),
        **_UNTOUCHED,
    )


#: What touches what is said by pairs alone, since friction belongs to a pair.
_UNTOUCHED: Final = {"contype": "0", "conaffinity": "0"}


def _add_pairs(
    contact: ElementTree.Element,
    links: Sequence[Link],
    bodies: Sequence[Body],
    fingers: tuple[str, str],
) -> None:
    moved = [body for body in bodies if body.mass > 0.0]
    fixed = [body for body in bodies if body.mass == 0.0]
    touching = [link for link in links if link.hull is not None]
    pads = [link for link in touching if link.joint in fingers]
    moving = [link for link in touching if link.parent]
    things: Iterable[tuple[Body | Link, Body | Link]] = itertools.chain(
        itertools.combinations(moved, 2),
        itertools.product(moved, fixed),
        itertools.product(moved, touching),
        itertools.product(moving, fixed),
        itertools.combinations(pads, 2),
    )
    for first, second in things:
        sliding, spinning, rolling = pair_friction(first.friction, second.friction)
        _add(
            contact,
            "pair",
            geom1=_geom(first),
            geom2=_geom(second),
            condim="6" if rolling > 0.0 else "4",
            friction=_text([sliding, sliding, spinning, rolling, rolling]),
            solref=_CONTACT,
            solimp=_IMPEDANCE,
        )


def _geom(thing: Body | Link) -> str:
    return f"link:{thing.name}" if isinstance(thing, Link) else f"body:{thing.name}"


def _add(parent: ElementTree.Element, tag: str, **attributes: str) -> ElementTree.Element:
    return ElementTree.SubElement(parent, tag, attributes)


def _text(values: Iterable[float]) -> str:
    return " ".join(f"{value:.10g}" for value in values)


def _quaternion(xyzw: np.ndarray) -> str:
    """MuJoCo has the real part first."""
    return _text([xyzw[3], *xyzw[:3]])
