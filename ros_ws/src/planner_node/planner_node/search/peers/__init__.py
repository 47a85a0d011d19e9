# SPDX-License-Identifier: Apache-2.0
"""Others' planners: problems out as PDDL, their plans in, their engines in place of the search."""
