# The index of commands; `make help` prints it. Everything happens in .venv, which `setup` makes.

SHELL := /bin/bash
.SHELLFLAGS := -euo pipefail -c
.DEFAULT_GOAL := help
.PHONY: help setup demo reproduce embed soak sanitize bench measure test lint golden golden-check images constraints clean

VENV := .venv
BIN := $(VENV)/bin
ROBOTS = $(notdir $(patsubst %/,%,$(wildcard generated/*/)))
C_SOURCES = $(shell find runtime examples generated -regex '.*\.\(c\|h\|cpp\|hpp\)' -not -name 'kernels.*')

help:  ## this list
	@awk -F ':.*## ' '/^[a-z-]+:.*## / {printf "  make %-13s %s\n", $$1, $$2}' $(MAKEFILE_LIST)

# 3.11 comes first, as every dependency has a wheel for it; for later versions pybullet is compiled, which takes minutes.
# Looked for once, and only where it is needed.
PYTHON ?= $(eval PYTHON := $(shell for name in python3.11 python3.12 python3.13 python3.14 python3; do \
  $$name -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null && echo $$name && break; done))$(PYTHON)

setup: $(VENV)/.installed  ## install proxgen and all that it needs into .venv, in exact versions

$(VENV)/.installed: pyproject.toml constraints.txt
	@if [ -z "$(PYTHON)" ]; then \
	  echo "proxgen needs Python 3.11 or newer, and none of python3.11 to python3.14 and python3 is that." >&2; exit 1; fi
	@$(PYTHON) -c 'import os, sysconfig; os.stat(os.path.join(sysconfig.get_paths()["include"], "Python.h"))' 2>/dev/null || { \
	  echo "The headers of $(PYTHON) are missing; the compiled controller needs them (apt-get install python3-dev)." >&2; exit 1; }
	@command -v "$${CC:-cc}" >/dev/null || { \
	  echo "No C compiler; proxgen compiles the controllers that it generates (apt-get install gcc)." >&2; exit 1; }
	@command -v "$${CXX:-c++}" >/dev/null || { \
	  echo "No C++ compiler: only the DAQP back end will build; qpOASES, the default, needs one (apt-get install g++)." >&2; }
	@echo "setup: installing into $(VENV) with $$($(PYTHON) --version) ..."
	@$(PYTHON) -m venv $(VENV)
	@$(BIN)/python -m pip install --quiet --quiet --disable-pip-version-check -c constraints.txt -e '.[dev]'
	@$(BIN)/python -m proxgen.builder.fetch_daqp
	@touch $@

demo: setup  ## the paper's gap: generate, compile, run, compare with the reference, report in out/demo
	@$(BIN)/python examples/demo.py

reproduce: setup  ## the paper's experiments, figures and claims, in out/reproduce: 6 minutes on two cores
	@$(BIN)/proxgen reproduce

embed: setup  ## recorded runs on emulated aarch64 and Cortex-M7: the same commands? instructions, sizes
	@$(BIN)/python examples/embed/elsewhere/run.py

soak: setup  ## a million random cycles with each back end: compared, heap use counted, then with sanitizers
	@$(BIN)/python runtime/tests/soak.py

sanitize: setup  ## the runtime with clang: warnings, analyser, sanitizers; half a minute of fuzzing
	@$(BIN)/python runtime/fuzz/fuzz.py --check
	@CC=clang CXX=clang++ $(BIN)/python -m pytest -q -n 2 tests/runtime -k "clean or sanitizers or threads"
	@$(BIN)/python runtime/fuzz/fuzz.py 30

bench: setup  ## cycle times of both back ends on this machine, in out/bench.json and out/bench.png
	@mkdir -p out
	@$(BIN)/proxgen bench --json out/bench.json --plot out/bench.png

measure: setup  ## measure anew what README and docs/performance.md show; on a machine with nothing else to do
	@$(BIN)/python docs/measured/measure.py

test: lint golden-check  ## everything: lint, committed generated code, all tests
	@$(BIN)/python -m pytest -n 2

lint: setup  ## ruff, mypy --strict, clang-format
	@$(BIN)/ruff check .
	@$(BIN)/ruff format --check .
	@$(BIN)/mypy
	@$(BIN)/clang-format --dry-run -Werror $(C_SOURCES)

golden: setup  ## regenerate generated/ in place; git then shows what changed
	@for robot in $(ROBOTS); do $(BIN)/proxgen generate examples/$$robot/$$robot.yaml -o generated/$$robot; done

golden-check: setup  ## regenerate into a temporary folder; fail if generated/ differs
	@fresh=$$(mktemp -d); trap 'rm -rf "$$fresh"' EXIT; \
	for robot in $(ROBOTS); do \
	  $(BIN)/proxgen generate examples/$$robot/$$robot.yaml -o "$$fresh/$$robot"; \
	done; \
	diff -r generated "$$fresh" || { echo "generated/ is out of date: run make golden and commit" >&2; exit 1; }

images: setup  ## make the documentation's pictures and films anew, from runs (some minutes)
	@$(BIN)/python docs/images/make.py

constraints:  ## renew constraints.txt: resolve all dependencies anew in an empty environment
	@fresh=$$(mktemp -d); trap 'rm -rf "$$fresh"' EXIT; \
	$(PYTHON) -m venv "$$fresh"; \
	"$$fresh/bin/python" -m pip install --quiet --quiet --disable-pip-version-check -e '.[dev]'; \
	{ grep '^#' constraints.txt; "$$fresh/bin/python" -m pip freeze --all --exclude-editable --exclude pip; } > "$$fresh/new"; \
	cp "$$fresh/new" constraints.txt

clean:  ## remove what was built and measured (not .venv)
	rm -rf build out dist .pytest_cache .mypy_cache .ruff_cache .hypothesis
