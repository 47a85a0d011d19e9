# SPDX-License-Identifier: Apache-2.0
"""The non-linear program of equation 3.4, and the solvers for it behind one interface.

A new solver is a class with ``solve``, made from a :class:`Program`, in a file of its own and an
entry in :data:`SOLVERS`.
"""

from typing import Final

from .ipopt import Ipopt
from .problem import Attached, DifferenceCost, KOrderProblem, Solution
from .program import TOLERANCE, Instance, Program
from .rows import Demand, JoinedRows, Rows
from .solver import Found, Solver, SolverFactory, chain
from .sqp import make_sqp

#: Name -> solver. Of the default, SQP is quick and only IPOPT's verdict counts as infeasible.
SOLVERS: Final[dict[str, SolverFactory]] = {
    "sqp_then_ipopt": chain(make_sqp, Ipopt),
    "sqp": make_sqp,
    "ipopt": Ipopt,
}
DEFAULT_SOLVER: Final = "sqp_then_ipopt"

__all__ = [
    "DEFAULT_SOLVER",
    "SOLVERS",
    "TOLERANCE",
    "Attached",
    "Demand",
    "DifferenceCost",
    "Found",
    "Instance",
    "JoinedRows",
    "KOrderProblem",
    "Program",
    "Rows",
    "Solution",
    "Solver",
    "SolverFactory",
    "chain",
]
