# SPDX-License-Identifier: Apache-2.0
"""Parameters that are declared once with meaning and range, and checked when they are set."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ParameterDescriptor,
    SetParametersResult,
)
from rclpy.node import Node
from rclpy.parameter import Parameter

_ARRAYS = {
    float: Parameter.Type.DOUBLE_ARRAY,
    int: Parameter.Type.INTEGER_ARRAY,
    str: Parameter.Type.STRING_ARRAY,
}


@dataclass(frozen=True)
class ParameterSpec:
    """One parameter of a node.

    Attributes:
        name, default, description: the description names the unit.
        minimum, maximum: inclusive range of a number, or of every element of an array.
        read_only: can be given at start only.
        check: further test; returns what is wrong with a value, or an empty string.
        element: type of the elements of an array whose default, an empty one, does not tell it.
    """

    name: str
    default: Any
    description: str
    minimum: float | None = None
    maximum: float | None = None
    read_only: bool = False
    check: Callable[[Any], str] | None = None
    element: type | None = None

    def problem(self, value: Any) -> str:
        """What is wrong with a value, or an empty string."""
        values = value if isinstance(value, Sequence) and not isinstance(value, str) else [value]
        for item in values:
            if isinstance(item, bool) or not isinstance(item, int | float):
                continue
            # `not (a <= b)` refuses NaN as well.
            if self.minimum is not None and not (self.minimum <= item):
                return f"{self.name} = {item} is below its minimum {self.minimum}"
            if self.maximum is not None and not (item <= self.maximum):
                return f"{self.name} = {item} is above its maximum {self.maximum}"
        return self.check(value) if self.check else ""

    def descriptor(self) -> ParameterDescriptor:
        """What ROS tools show of the parameter: meaning, and the range if both ends are given."""
        descriptor = ParameterDescriptor(description=self.description, read_only=self.read_only)
        if self.minimum is None or self.maximum is None:
            return descriptor
        if isinstance(self.default, bool):
            return descriptor
        if isinstance(self.default, int):
            descriptor.integer_range = [
                IntegerRange(from_value=int(self.minimum), to_value=int(self.maximum), step=0)
            ]
        elif isinstance(self.default, float):
            descriptor.floating_point_range = [
                FloatingPointRange(
                    from_value=float(self.minimum), to_value=float(self.maximum), step=0.0
                )
            ]
        return descriptor


def _declare(node: Node, spec: ParameterSpec) -> Any:
    if spec.element is None:
        return node.declare_parameter(spec.name, spec.default, spec.descriptor()).value
    # rclpy takes an empty list for one of bytes. Declared by type, it is not set until given.
    declared = node.declare_parameter(spec.name, _ARRAYS[spec.element], spec.descriptor())
    return spec.default if declared.value is None else declared.value


def declare_parameters(
    node: Node,
    specs: Sequence[ParameterSpec],
    on_change: Callable[[dict[str, Any]], None] | None = None,
) -> dict[str, Any]:
    """Declares the parameters, installs the check for later changes, and returns the values.

    Args:
        on_change: called with the accepted new values by name, after each accepted change.

    Raises:
        ValueError: if a value given at start is out of range; the sentence names the range.
    """
    by_name = {spec.name: spec for spec in specs}
    values = {}
    for spec in specs:
        try:
            value = _declare(node, spec)
        except Exception as error:
            raise ValueError(f"parameter {spec.name}: {error}") from error
        if problem := spec.problem(value):
            raise ValueError(f"parameter {problem}")
        values[spec.name] = value

    def check(parameters: list[Parameter]) -> SetParametersResult:
        for parameter in parameters:
            spec = by_name.get(parameter.name)
            if spec and (problem := spec.problem(parameter.value)):
                return SetParametersResult(successful=False, reason=problem)
        return SetParametersResult(successful=True)

    def changed(parameters: list[Parameter]) -> None:
        if on_change:
            on_change({item.name: item.value for item in parameters if item.name in by_name})

    node.add_on_set_parameters_callback(check)
    node.add_post_set_parameters_callback(changed)
    return values
