# SPDX-License-Identifier: Apache-2.0
"""Why a motion cannot be, turned round: the smallest change with which it can."""

from .search import Suggestion, Suggestions

__all__ = ["Suggestion", "Suggestions"]
