# SPDX-License-Identifier: Apache-2.0
"""Tests of perception run on shared processors: nothing here depends on how long it takes."""

from collections.abc import Iterator

import pytest
import torch

from sim_node.world import World

# Several threads on processors that others use wait for one another most of the time.
torch.set_num_threads(1)


@pytest.fixture(scope="module")
def world() -> Iterator[World]:
    with World() as world:
        yield world
