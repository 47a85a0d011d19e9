# SPDX-License-Identifier: Apache-2.0
"""Groups of linked things, beside scipy's."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from perception_node.components import components


@given(st.integers(1, 12), st.data())
def test_groups_are_scipys(count: int, data: st.DataObject) -> None:
    thing = st.integers(0, count - 1)
    pairs = data.draw(st.lists(st.tuples(thing, thing), max_size=15))
    rows, columns = np.array(pairs, int).reshape(-1, 2).T
    links = coo_array((np.ones(len(rows)), (rows, columns)), shape=(count, count))
    wanted, groups = connected_components(links, directed=False)
    found, mine = components(count, pairs)
    assert found == wanted and (mine == groups).all()
