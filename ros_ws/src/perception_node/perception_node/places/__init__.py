# SPDX-License-Identifier: Apache-2.0
"""Places: which stack stands where, and what hides them.

:mod:`.row` holds everything that is assumed of places in a row, :mod:`.two_rows` what is different
where one row is behind another, :mod:`.from_anywhere` places that one of several cameras sees from
any side; another arrangement is another :class:`Places`, given to a
perception by ``Perception(locator, places=…)``.
"""

from .from_anywhere import FromAnywhere
from .row import RowOfPlaces
from .standing import Places, Points, Standing
from .two_rows import TwoRows

__all__ = ["FromAnywhere", "Places", "Points", "RowOfPlaces", "Standing", "TwoRows"]
