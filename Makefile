# Everything here sets itself up in a virtual environment (.venv) from nothing: Python 3.11 to 3.14 with pip will do.
#
#   make demo    install, run `aeroservo demo`, say which file to open
#   make test    lint, types, import contracts, then all tests with coverage
#   make lint    the checks that need no test run
#   make docs    the documentation site, into site/
#   make bench   benchmarks: our time against a peer's, measured in one run
#   make clean   remove the environment and everything generated
#
# VENV=DIR puts the environment elsewhere, PYTHON=PROGRAM picks the interpreter, WORKERS=N the test processes,
# ARGS="..." goes to pytest (make test) or to the benchmarks (make bench).

SHELL := /bin/bash
.SHELLFLAGS := -eu -o pipefail -c
.DEFAULT_GOAL := help

VENV ?= .venv
WORKERS ?= 2
ARGS ?=
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check --no-input
# One thread per process: tests run in WORKERS processes, and ratios are per core.
export OMP_NUM_THREADS ?= 1
export OPENBLAS_NUM_THREADS ?= 1

.PHONY: help demo test lint ruff types imports docs bench clean
help:
	@sed -n 's/^#   make/  make/p' Makefile

demo: $(VENV)/.installed
	@$(BIN)/aeroservo demo

# All checks run even if an early one fails, so that one run shows everything; any failure fails the target.
test: $(VENV)/.installed-test
	@status=0; \
	$(MAKE) --no-print-directory --keep-going lint || status=1; \
	$(BIN)/python -m pytest -n $(WORKERS) --cov --cov-report=term $(ARGS) || status=1; \
	exit $$status

lint: ruff types imports
ruff: $(VENV)/.installed-test
	$(BIN)/ruff check .
types: $(VENV)/.installed-test
	$(BIN)/mypy
imports: $(VENV)/.installed-test
	$(BIN)/lint-imports

docs: $(VENV)/.installed-test
	@NO_MKDOCS_2_WARNING=1 $(BIN)/python -m mkdocs build --quiet && echo "open site/index.html"

bench: $(VENV)/.installed-test
	$(BIN)/python -m benchmarks $(ARGS)

clean:
	rm -rf $(VENV) build dist site .pytest_cache .mypy_cache .ruff_cache .import_linter_cache .hypothesis .coverage .coverage.*
	find src tests benchmarks -name __pycache__ -type d -prune -exec rm -rf {} +

# The stamps: nothing is reinstalled until pyproject.toml changes. The install is editable, so code changes need none.
$(VENV)/.installed: pyproject.toml | $(BIN)/python
	$(PIP) install --quiet --editable .
	@touch $@

$(VENV)/.installed-test: pyproject.toml | $(BIN)/python
	$(PIP) install --quiet --editable '.[test]'
	@touch $(VENV)/.installed $@

# Debian ships Python without ensurepip unless python3-venv is installed; then pip itself fills the environment.
$(BIN)/python:
	@fits='import sys; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 14))'; python=; \
	for candidate in $(or $(PYTHON),python3 python3.11 python3.12 python3.13 python3.14); do \
	    if "$$candidate" -c "$$fits" >/dev/null 2>&1; then python=$$candidate; break; fi; \
	done; \
	if [ -z "$$python" ]; then \
	    echo "aeroservo needs Python 3.11 to 3.14; none of these is one: $(or $(PYTHON),python3 python3.11 python3.12 python3.13 python3.14)." >&2; \
	    echo "On Debian: apt install python3 python3-venv. Or name one: make PYTHON=/path/to/python3.12 ..." >&2; exit 1; \
	fi; \
	echo "Setting up $(VENV) with $$("$$python" --version) (once)"; \
	if "$$python" -c 'import venv, ensurepip' >/dev/null 2>&1; then \
	    "$$python" -m venv $(VENV); \
	elif "$$python" -c 'import venv, pip' >/dev/null 2>&1; then \
	    "$$python" -m venv --without-pip $(VENV) && "$$python" -m pip --python $(BIN)/python install --quiet pip \
	        || { rm -rf $(VENV); exit 1; }; \
	else \
	    echo "$$python can make no virtual environment: its modules venv and ensurepip are missing, and so is pip." >&2; \
	    echo "On Debian: apt install python3-venv." >&2; exit 1; \
	fi
