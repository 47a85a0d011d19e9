# SPDX-License-Identifier: Apache-2.0
# `make help` lists the targets. Every target sets up what it needs and is quick when nothing changed.
SHELL := /bin/bash
.DEFAULT_GOAL := help
PYTHON ?= python3
VENV := .venv
RUN := tools/in_workspace
SOURCES := $(shell find ros_ws/src -name '*.py' -o -name 'package.xml' -o -name 'setup.cfg' 2>/dev/null)

.PHONY: help setup demo test lint clean lock

help:  ## this list
	@grep -E '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):.*## */  \1\t/' | expand -t 20

setup:  ## virtual environment and workspace, built where something changed
	@tools/setup "$(PYTHON)"

lint: setup  ## ruff and mypy
	@$(VENV)/bin/ruff check .
	@$(VENV)/bin/ruff format --check .
	@$(RUN) mypy

test: setup  ## the whole test suite
	@$(RUN) pytest $(ARGS)

lock:  ## compile requirements.in to the hash-pinned requirements.lock
	@tools/lock

clean:  ## remove the environment and everything built; runs and data stay
	rm -rf $(VENV) ros_ws/build ros_ws/install ros_ws/log .mypy_cache .ruff_cache .hypothesis
