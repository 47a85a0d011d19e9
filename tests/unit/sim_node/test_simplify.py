# SPDX-License-Identifier: Apache-2.0
"""Fewer triangles describe the same surface: spheres stay round, borders and seams stay put."""

from __future__ import annotations

import multiprocessing
import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from sim_node.meshes import light_urdf as light_urdf_module
from sim_node.meshes.light_urdf import light_urdf
from sim_node.meshes.simplify import simplify
from sim_node.meshes.wavefront import Mesh, face_normals, read_obj, write_obj

RADIUS = 0.1


def sphere(count: int = 2000) -> Mesh:
    """Points on a spiral and their convex hull, counter-clockwise from outside."""
    index = np.arange(count) + 0.5
    polar, azimuth = np.arccos(1.0 - 2.0 * index / count), np.pi * (1.0 + 5.0**0.5) * index
    points = RADIUS * np.stack(
        [np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)], axis=1
    )
    faces = ConvexHull(points).simplices.astype(np.int64)
    inwards = (face_normals(points, faces) * points[faces[:, 0]]).sum(axis=1) < 0.0
    faces[inwards] = faces[inwards, ::-1]
    return Mesh(points, faces, np.zeros(len(faces), int), np.full((len(faces), 2), np.nan), "")


def square(size: int = 20) -> Mesh:
    """A flat unit square of many triangles; its left and right half are of two materials."""
    x, y = np.meshgrid(np.linspace(0.0, 1.0, size + 1), np.linspace(0.0, 1.0, size + 1))
    points = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
    corner = np.add.outer(np.arange(size) * (size + 1), np.arange(size)).ravel()
    right, above = corner + 1, corner + size + 1
    faces = np.concatenate(
        [np.stack([corner, right, above + 1], 1), np.stack([corner, above + 1, above], 1)]
    )
    parts = (points[faces][:, :, 0].mean(axis=1) > 0.5).astype(int)
    return Mesh(points, faces, parts, np.stack([parts, parts], axis=1) * 0.5, "colors.png")


def area(mesh: Mesh, part: int) -> float:
    normals = face_normals(mesh.vertices, mesh.faces[mesh.parts == part])
    return 0.5 * float(np.linalg.norm(normals, axis=1).sum())


def volume(mesh: Mesh) -> float:
    a, b, c = mesh.vertices[mesh.faces].transpose(1, 0, 2)
    return float((a * np.cross(b, c)).sum() / 6.0)


@pytest.mark.parametrize("tolerance", [0.0002, 0.0005, 0.002])
def test_a_sphere_stays_round_and_closed(tolerance: float) -> None:
    light = simplify(sphere(), tolerance)
    assert len(light.faces) < 0.6 * len(sphere().faces)
    assert np.abs(np.linalg.norm(light.vertices, axis=1) - RADIUS).max() < 2 * tolerance
    centres = light.vertices[light.faces].mean(axis=1)
    assert (np.linalg.norm(centres, axis=1) > RADIUS - 5 * tolerance).all()
    assert (face_normals(light.vertices, light.faces) * centres).sum(axis=1).min() > 0.0
    assert volume(light) == pytest.approx(
        volume(sphere()), abs=1.5 * tolerance * 4 * np.pi * RADIUS**2
    )


def test_a_greater_tolerance_leaves_fewer_triangles() -> None:
    counts = [len(simplify(sphere(), tolerance).faces) for tolerance in (1e-4, 5e-4, 2e-3)]
    assert counts == sorted(counts, reverse=True)
    assert counts[0] > 2 * counts[2]


def test_of_a_flat_square_its_border_and_its_seam_stay() -> None:
    light = simplify(square(), 1e-4)
    assert len(light.faces) < 20
    for part in (0, 1):
        assert area(light, part) == pytest.approx(0.5, abs=1e-3)
        x = light.vertices[light.faces[light.parts == part]][:, :, 0]
        assert (x.min(), x.max()) == pytest.approx((0.5 * part, 0.5 * (part + 1)), abs=1e-3)
    np.testing.assert_allclose(light.vertices[:, 2], 0.0, atol=1e-9)
    np.testing.assert_array_equal(light.texture[:, 0], 0.5 * light.parts)


def test_the_result_is_the_same_every_time() -> None:
    first, second = simplify(sphere(), 5e-4), simplify(sphere(), 5e-4)
    np.testing.assert_array_equal(first.vertices, second.vertices)
    np.testing.assert_array_equal(first.faces, second.faces)


def test_what_is_written_is_read_again(tmp_path: Path) -> None:
    mesh = square(4)
    write_obj(mesh, tmp_path / "square.obj")
    again = read_obj(tmp_path / "square.obj")
    np.testing.assert_allclose(again.vertices[again.faces], mesh.vertices[mesh.faces], atol=1e-6)
    np.testing.assert_allclose(again.texture, mesh.texture, atol=1e-6)
    assert again.image == "colors.png"


def test_polygons_backward_indices_and_doubled_points_are_understood(tmp_path: Path) -> None:
    path = tmp_path / "square.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 0\nf -1 2 3 4\n")
    mesh = read_obj(path)
    assert len(mesh.vertices) == 4
    assert 0.5 * face_normals(mesh.vertices, mesh.faces).sum(axis=0) == pytest.approx([0, 0, 1])
    assert np.isnan(mesh.texture).all()


def test_a_file_without_faces_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "points.obj"
    path.write_text("v 0 0 0\n")
    with pytest.raises(ValueError, match=r"points\.obj holds no faces"):
        read_obj(path)


@pytest.fixture
def ball(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A URDF of one link with a heavy mesh to see and to touch; the cache is empty."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    folder = tmp_path / "robot"
    (folder / "meshes").mkdir(parents=True)
    write_obj(sphere(), folder / "meshes" / "ball.obj")
    mesh = '<geometry><mesh filename="package://meshes/ball.obj"/></geometry>'
    urdf = folder / "ball.urdf"
    urdf.write_text(
        f'<robot name="ball"><link name="ball"><visual>{mesh}</visual>'
        f"<collision>{mesh}</collision></link></robot>"
    )
    return urdf


def meshes(urdf: Path) -> list[Path]:
    return [Path(part.split('"')[0]) for part in urdf.read_text().split('filename="')[1:]]


def test_only_what_is_seen_becomes_lighter(ball: Path) -> None:
    seen, touched = meshes(light_urdf(ball))
    assert touched == ball.parent / "meshes" / "ball.obj"
    assert len(read_obj(seen).faces) < 0.5 * len(read_obj(touched).faces)


def test_it_is_made_once_and_again_when_the_original_changes(ball: Path) -> None:
    first = light_urdf(ball)
    written = first.stat().st_mtime_ns
    assert light_urdf(ball) == first
    assert first.stat().st_mtime_ns == written
    write_obj(sphere(2500), ball.parent / "meshes" / "ball.obj")
    assert light_urdf(ball) != first


def test_processes_that_ask_at_once_get_the_same_whole_folder(ball: Path) -> None:
    with multiprocessing.get_context("spawn").Pool(3) as pool:
        paths = pool.map(light_urdf, [ball] * 6, chunksize=1)
    assert len(set(paths)) == 1
    assert all(path.is_file() for path in meshes(paths[0]))
    assert list(paths[0].parent.parent.iterdir()) == [paths[0].parent]


def test_one_that_was_slower_takes_what_the_other_has_made(
    ball: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    expected = light_urdf(ball)
    content = expected.read_bytes()
    moved = expected.parent.rename(expected.parent.with_name("aside"))

    def overtaken(mesh: Mesh, tolerance: float) -> Mesh:
        moved.rename(expected.parent)
        return simplify(mesh, tolerance)

    monkeypatch.setattr(light_urdf_module, "simplify", overtaken)
    assert light_urdf(ball) == expected
    assert expected.read_bytes() == content
    assert list(expected.parent.parent.iterdir()) == [expected.parent]


def test_without_a_cache_folder_the_temporary_one_serves(
    ball: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").write_text("no folder")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    assert light_urdf(ball).is_relative_to(tmp_path / f"sim_node-{os.getuid()}")


def test_the_texture_comes_along(ball: Path) -> None:
    folder = ball.parent / "meshes"
    texture = np.full((len(sphere().faces), 2), 0.25)
    write_obj(replace(sphere(), texture=texture, image="c.png"), folder / "ball.obj")
    (folder / "c.png").write_bytes(b"a picture")
    light = meshes(light_urdf(ball))[0]
    assert (light.parent / read_obj(light).image).read_bytes() == b"a picture"
    np.testing.assert_array_equal(read_obj(light).texture, 0.25)


def test_the_tolerance_is_in_metres_whatever_the_unit_of_the_file(ball: Path) -> None:
    in_metres = len(read_obj(meshes(light_urdf(ball))[0]).faces)
    in_millimetres = replace(sphere(), vertices=1000.0 * sphere().vertices)
    write_obj(in_millimetres, ball.parent / "meshes" / "ball.obj")
    ball.write_text(ball.read_text().replace(".obj", '.obj" scale="0.001 0.001 0.001'))
    scaled = len(read_obj(meshes(light_urdf(ball))[0]).faces)
    assert scaled == pytest.approx(in_metres, rel=0.1)
