# SPDX-License-Identifier: Apache-2.0
"""An arm's URDF with lighter visual meshes, made once and kept in the user's cache folder."""

from __future__ import annotations

import hashlib
import os
import shutil
import tempfile
import xml.etree.ElementTree as ElementTree
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
        mesh.set("filename", str(_absolute(mesh.get("filename", ""), original.parent)))
    heavy = sorted(
        {
            Path(mesh.get("filename", ""))
            for mesh in tree.iterfind(".//visual/geometry/mesh")
            if _is_heavy(Path(mesh.get("filename", "")))
        }
    )
    folder = cache_folder() / f"{original.stem}-{_digest([original, *heavy], tolerance)}"
    result = folder / original.name
    if result.is_file():
        return result
    part = Path(tempfile.mkdtemp(prefix=f"{folder.name}.", dir=folder.parent))
    try:
        light = {path: _write_light(path, part, tolerance) for path in heavy}
        for mesh in tree.iterfind(".//visual/geometry/mesh"):
            path = Path(mesh.get("filename", ""))
            if path in light:
                mesh.set("filename", str(folder / light[path]))
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
    chosen = Path(os.environ.get("XDG_CACHE_HOME", ""))
    folder = (chosen if chosen.is_absolute() else Path("~/.cache").expanduser()) / "sim_node"
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        writable = False
    else:
        writable = os.access(folder, os.W_OK)
    if not writable:
        folder = Path(tempfile.gettempdir()) / f"sim_node-{os.getuid()}"
        folder.mkdir(mode=0o700, exist_ok=True)
    return folder


def _absolute(name: str, folder: Path) -> Path:
    return folder / name.removeprefix(_PACKAGE)


def _is_heavy(path: Path) -> bool:
    return path.suffix == ".obj" and path.stat().st_size > _LIGHT_ENOUGH


def _digest(sources: list[Path], tolerance: float) -> str:
    """Of the sources, the tolerance, and the code that makes light meshes of them."""
    digest = hashlib.sha256(repr((str(sources[0].parent), tolerance)).encode())
    code = sorted(Path(__file__).parent.glob("*.py"))
    for path in [*code, *sources]:
        digest.update(hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()[:16]


def _write_light(path: Path, folder: Path, tolerance: float) -> str:
    """Writes a light mesh with its texture into the folder; returns its file name."""
    mesh = simplify(read_obj(path), tolerance)
    # Two folders may each hold a mesh of this name.
    name = f"{hashlib.sha256(str(path).encode()).hexdigest()[:8]}-{path.name}"
    write_obj(mesh, folder / name)
    if mesh.image:
        shutil.copyfile(path.parent / mesh.image, folder / mesh.image)
    return name
