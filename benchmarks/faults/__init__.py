# SPDX-License-Identifier: Apache-2.0
"""The fault campaign: what can go wrong between the nodes, declared, injected and judged."""
