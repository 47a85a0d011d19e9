# SPDX-License-Identifier: Apache-2.0
"""Sequential quadratic programming with the costs' own Hessian.

In C (``sqp.c``, ``quadratic.c``) where constraints are machine code, and else in Python, on the
active-set method DAQP: the same steps.
"""

from __future__ import annotations

import ctypes
from pathlib import Path
from typing import Final

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from tamp_runtime.machine_code import opened, written

from .buffered import Buffered
from .program import TOLERANCE, Instance, Program
from .solver import Found, Solver

Array = NDArray[np.float64]

#: Largest step of a joint at which it has converged [rad].
STEP_TOLERANCE = 2e-2
#: Steps it may take, and how far a joint may move in the first of them [rad].
MAX_STEPS = 20
TRUST = 0.5

_FILES: Final = tuple(Path(__file__).with_name(name) for name in ("sqp.c", "quadratic.c"))


def make_sqp(program: Program) -> Solver:
    """The quickest of both that there can be here."""
    steps, constraints = written(*_FILES), opened(program.library)
    if steps is None or constraints is None:
        return Sqp(program)
    return SqpInC(program, steps, constraints)


class _Problem(ctypes.Structure):
    """``Problem`` of ``sqp.c``."""

    _fields_ = (
        *((name, ctypes.c_int) for name in ("variables", "rows", "block")),
        *((name, ctypes.c_void_p) for name in ("hessian", "first", "begin", "column", "place")),
        ("constraints", ctypes.c_void_p),
        *((name, ctypes.c_int) for name in ("arguments", "results", "integers", "reals")),
        *((name, ctypes.c_int) for name in ("entries", "most")),
        *((name, ctypes.c_double) for name in ("tolerance", "step_tolerance", "trust")),
    )


class SqpInC:
    """See :class:`Sqp`. The lock of the interpreter is free meanwhile."""

    def __init__(self, program: Program, steps: ctypes.CDLL, constraints: ctypes.CDLL) -> None:
        block, size = program.block, len(program.hessian)
        blocks = size // block
        whole = program.hessian.reshape(blocks, block, blocks, block)
        hessian = np.ascontiguousarray(np.einsum("bkck->bck", whole))
        if np.count_nonzero(hessian) != np.count_nonzero(whole):
            raise ValueError("the cost of a joint depends on another joint")
        first = np.argmax((hessian != 0.0).any(axis=2), axis=1).astype(np.intc)
        self._rows = program.g.numel()
        # The Jacobian's entries come by columns; rows are needed.
        slopes = program.jacobian.sparsity_out(1)
        rows, columns = (np.array(own, dtype=np.intc) for own in slopes.get_triplet())
        order = np.lexsort((columns, rows)).astype(np.intc)
        begin = np.searchsorted(rows[order], np.arange(self._rows + 1)).astype(np.intc)
        self._kept = (hessian, first, begin, columns[order], order, steps, constraints)
        name = program.jacobian.name()
        room = [ctypes.c_longlong() for _ in range(4)]
        getattr(constraints, f"{name}_work")(*map(ctypes.byref, room))
        self._problem = _Problem(
            size,
            self._rows,
            block,
            *(array.ctypes.data for array in self._kept[:5]),
            ctypes.cast(getattr(constraints, name), ctypes.c_void_p).value,
            *(int(size.value) for size in room),
            len(order),
            MAX_STEPS,
            TOLERANCE,
            STEP_TOLERANCE,
            TRUST,
        )
        self._solve = steps.sqp
        self._solve.argtypes = [ctypes.c_void_p] * 7
        self._solve.restype = ctypes.c_int
        self._address = ctypes.addressof(self._problem)

    def solve(self, instance: Instance) -> Found:
        """Where it converged, or where it gave up.

        Raises:
            MemoryError: if there is none left.
        """
        z, values = instance.start.copy(), np.empty(self._rows)
        p, linear = instance.p, instance.linear
        lower = np.concatenate([instance.lower_g, instance.lower_z])
        upper = np.concatenate([instance.upper_g, instance.upper_z])
        given = (p, linear, lower, upper, z, values)
        steps = self._solve(self._address, *(array.ctypes.data for array in given))
        if steps < 0:
            raise MemoryError("no memory for sequential quadratic programming")
        return Found(z, values, "sqp", steps)


class Sqp:
    """Linearises the constraints, so each step is a small convex quadratic program.

    The constraints' curvature is left out (Gauss-Newton). From the starting points of this package
    it converges within some four steps in nearly all cases; it proves nothing where it does not.
    """

    def __init__(self, program: Program) -> None:
        self._program = program
        slopes = program.jacobian.sparsity_out(1)
        quadratic = ca.conic(
            "quadratic",
            "daqp",
            {"h": program.hessian_sparse.sparsity(), "a": slopes},
            {"error_on_fail": False},
        )
        self._jacobian, self._quadratic = Buffered(program.jacobian), Buffered(quadratic)
        self._hessian = np.array(program.hessian_sparse.nonzeros())
        # The same as a matrix, its columns one after another.
        self._slopes = np.zeros(slopes.size2() * slopes.size1())
        self._places = np.array(slopes.find(), dtype=int)

    def solve(self, instance: Instance) -> Found:
        """Where it converged, or where it gave up."""
        program = self._program
        z, step, trust = instance.start, np.inf, TRUST
        for iteration in range(MAX_STEPS + 1):
            g, jacobian = self._jacobian(z, instance.p)
            values = g.copy()
            holds = instance.excess(values).max(initial=0.0) < TOLERANCE / 2
            done = step < STEP_TOLERANCE and holds
            if done or iteration == MAX_STEPS or not np.isfinite(values).all():
                break
            delta = self._quadratic(
                self._hessian,
                program.hessian @ z + instance.linear,
                jacobian,
                instance.lower_g - values,
                instance.upper_g - values,
                np.maximum(instance.lower_z - z, -trust),
                np.minimum(instance.upper_z - z, trust),
            )[0]
            self._slopes[self._places] = jacobian
            # Where the linearised constraints contradict one another, it stops somewhere.
            if not instance.feasible(values + delta @ self._slopes.reshape(len(z), -1)):
                break
            # Without the constraints' curvature, steps can go to and fro; shorter ones settle. A
            # step that ends at a limit of half the one before has done its part: rounding must not
            # decide whether it is cut again.
            before, step = step, float(np.abs(delta).max())
            if step > before / 2 * (1 + 1e-9):
                trust = step / 2
            z = z + delta
        return Found(z, values, "sqp", iteration)
