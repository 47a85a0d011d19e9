# SPDX-License-Identifier: Apache-2.0
"""The grammar of goals, its words, and the chart parser that reads them."""
