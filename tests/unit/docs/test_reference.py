# SPDX-License-Identifier: Apache-2.0
"""The reference in docs/ says what the sources declare."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType

import pytest
import write_reference
from rclpy.node import Node
from tamp_runtime.parameters import ParameterSpec


@pytest.fixture(scope="module")
def pages() -> dict[str, str]:
    return write_reference.pages()


@pytest.mark.parametrize("page", ["docs/parameters.md", "docs/interfaces.md"])
def test_committed_page_is_what_the_sources_declare(page: str, pages: dict[str, str]) -> None:
    assert (write_reference.ROOT / page).read_text() == pages[page], "run `make reference`"


def test_every_interface_file_is_quoted_whole(pages: dict[str, str]) -> None:
    files = [
        path
        for kind in ("msg", "srv", "action")
        for path in write_reference.INTERFACES_FOLDER.glob(f"{kind}/*.{kind}")
    ]
    assert files
    for path in files:
        assert path.read_text().rstrip() in pages["docs/interfaces.md"]


@pytest.mark.parametrize(
    ("default", "name"),
    [
        (True, "bool"),
        (3, "integer"),
        (3.0, "double"),
        ("red", "string"),
        ([0.5, 0.0], "double[]"),
        (("red", "blue"), "string[]"),
    ],
)
def test_type_is_that_of_the_default(default: object, name: str) -> None:
    assert write_reference.type_name(default) == name


def test_type_of_an_empty_array_is_told() -> None:
    spec = ParameterSpec("limits", [], "of the joints", element=float)
    *_, row = write_reference.parameter_table([spec])
    assert row.startswith("| `limits` | double[] | `[]` |")


def test_table_has_range_default_and_meaning() -> None:
    spec = ParameterSpec("blocks", 5, "blocks in the scene", 3, 7, read_only=True)
    *_, row = write_reference.parameter_table([spec])
    assert row == "| `blocks` | integer | `5` | 3 to 7 | yes | blocks in the scene |"


def test_table_survives_a_column_separator_in_a_meaning() -> None:
    spec = ParameterSpec("mode", "a", "a | b")
    *_, row = write_reference.parameter_table([spec])
    assert row.endswith("| a \\| b |")


def test_check_is_explained_by_its_docstring() -> None:
    def even(_value: object) -> str:
        """An even number."""
        return ""

    assert (
        write_reference.range_text(ParameterSpec("n", 2, "n", 0, 8, check=even))
        == "0 to 8; An even number"
    )


def test_module_without_parameters_is_refused_by_name() -> None:
    with pytest.raises(write_reference.DeclarationError, match="lonely_node"):
        write_reference.parameters_of(ModuleType("lonely_node"))


def test_node_class_is_the_one_defined_there_not_an_imported_one() -> None:
    module = ModuleType("some.node")

    class Own(Node):
        """Does something."""

    Own.__module__ = "some.node"
    module.Own, module.Node = Own, Node  # type: ignore[attr-defined]
    assert write_reference.node_class_of(module) is Own


def test_pages_name_no_folder_of_this_machine(pages: dict[str, str]) -> None:
    for content in pages.values():
        assert str(write_reference.ROOT) not in content
        assert str(Path.home()) + "/" not in content
