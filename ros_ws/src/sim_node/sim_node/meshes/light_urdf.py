# SPDX-License-Identifier: Apache-2.0
"""An arm's URDF with lighter visual meshes, made once and kept in the user's cache folder."""

from __future__ import annotations

import hashlib
import os
import shutil
import tempfile
import xml.etree.ElementTree as ElementTree
from dataclasses import replace
from pathlib import Path
from typing import Final

from .simplify import simplify
from .wavefront import read_obj, write_obj

#: Root mean square distance that a light mesh may have from the original's faces [m]: a quarter
#: of a pixel of the camera.
TOLERANCE: Final = 0.0005
#: Meshes with at most as many bytes stay as they are.
_LIGHT_ENOUGH: Final = 40_000
_PACKAGE: Final = "package://"


def light_urdf(original: Path, tolerance: float = TOLERANCE) -> Path:
    """Path of a URDF that differs from the original in its visual meshes alone.

    It is made when it is not in the cache, whole or not at all, so several processes may ask at
    once. Its name holds a digest of all that it is made of.

    Args:
        original: a URDF; ``package://`` is relative to its folder, as in pybullet.
        tolerance: see :func:`~sim_node.meshes.simplify.simplify`.

    Raises:
        OSError: if the original or its meshes cannot be read.
    """
    tree = ElementTree.parse(original)
    for mesh in tree.iterfind(".//mesh"):
        name = mesh.get("filename", "").removeprefix(_PACKAGE)
        mesh.set("filename", str(original.parent / name))
    visuals = tree.findall(".//visual/geometry/mesh")
    heavy = {path: _scale(mesh) for mesh in visuals if _is_heavy(path := _path(mesh))}
    folder = cache_folder() / f"{original.stem}-{_digest([original, *sorted(heavy)], tolerance)}"
    result = folder / original.name
    if result.is_file():
        return result
    part = Path(tempfile.mkdtemp(prefix=f"{folder.name}.", dir=folder.parent))
    try:
        for path, scale in heavy.items():
            _write_light(path, part / _light_name(path), tolerance / scale)
        for mesh in visuals:
            if (path := _path(mesh)) in heavy:
                mesh.set("filename", str(folder / _light_name(path)))
        tree.write(part / original.name, encoding="utf-8", xml_declaration=True)
        part.rename(folder)
    except OSError:
        # Another process was quicker; what it has made is the same.
        if not result.is_file():
            raise
    finally:
        shutil.rmtree(part, ignore_errors=True)
    return result


def cache_folder() -> Path:
    """Where light meshes are kept: ``$XDG_CACHE_HOME/sim_node`` or ``~/.cache/sim_node``.

    Where that cannot be written, a folder of this user's under the one for temporary files.

    Raises:
        OSError: if that cannot be written either.
    """
    try:
        chosen = Path(os.environ.get("XDG_CACHE_HOME", ""))
        folder = (chosen if chosen.is_absolute() else Path.home() / ".cache") / "sim_node"
        folder.mkdir(parents=True, exist_ok=True)
        if os.access(folder, os.W_OK):
            return folder
    except (OSError, RuntimeError):  # a file in its way, or a user without a home
        pass
    folder = Path(tempfile.gettempdir()) / f"sim_node-{os.getuid()}"
    folder.mkdir(mode=0o700, exist_ok=True)
    return folder


def _path(mesh: ElementTree.Element) -> Path:
    return Path(mesh.get("filename", ""))


def _scale(mesh: ElementTree.Element) -> float:
    """Metres in the URDF for one unit in the mesh's file."""
    return max(abs(float(factor)) for factor in mesh.get("scale", "1").split())


def _is_heavy(path: Path) -> bool:
    return path.suffix == ".obj" and path.stat().st_size > _LIGHT_ENOUGH


def _digest(sources: list[Path], tolerance: float) -> str:
    """Of the sources, the tolerance, and the code that makes light meshes of them."""
    digest = hashlib.sha256(repr((str(sources[0].parent), tolerance)).encode())
    code = sorted(Path(__file__).parent.glob("*.py"))
    for path in [*code, *sources]:
        digest.update(hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()[:16]


def _light_name(path: Path) -> str:
    """File name in the light URDF's folder; two folders may each hold a file of this name."""
    return f"{hashlib.sha256(str(path.parent).encode()).hexdigest()[:8]}-{path.name}"


def _write_light(path: Path, target: Path, tolerance: float) -> None:
    """Writes the light copy of a mesh, with its texture beside it."""
    mesh = simplify(read_obj(path), tolerance)
    image = path.parent / mesh.image
    name = _light_name(image) if image.is_file() else ""
    if name:
        shutil.copyfile(image, target.parent / name)
    write_obj(replace(mesh, image=name), target)
