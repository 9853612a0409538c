# A fresh machine needs Python 3.11 or newer and make; every target sets up what it uses.
# Overridable: PYTHON (interpreter for .venv), WORKERS (test processes), TESTS (what `make test` runs), RECOVERY
# (options of the recovery suite, such as RECOVERY=--half; --help lists them), FUZZ (those of the fuzzing).

VENV := .venv
BIN := $(VENV)/bin
WORKERS ?= 2
TESTS ?= tests
RECOVERY ?=
FLEET ?= --seeds 100000:100599 --encoder-nulls 500:509
FUZZ ?= --cases 2000 --seed 1

# The first interpreter that is new enough; asked only when .venv has to be made.
PYTHON ?= $(shell for name in python3.11 python3 python3.12 python3.13 python; do \
	if $$name -c 'import sys; sys.exit(sys.version_info < (3, 11))' >/dev/null 2>&1; then echo $$name; break; fi; done)

# Each test process has one core: threaded linear algebra would only make them wait for each other.
ONE_THREAD := OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1 MKL_NUM_THREADS=1
PYTEST := $(ONE_THREAD) $(BIN)/python -m pytest -n $(WORKERS) --dist worksteal
PIP_INSTALL := $(BIN)/python -m pip install --quiet --disable-pip-version-check

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
.PHONY: help demo test test-slow check recovery recovery-fleet recovery-rivals recovery-parts recovery-smoke fuzz bench lint types format docs develop clean

help: ## show this list
	@echo "make TARGET, where TARGET is"
	@sed -n 's/^\([a-z-]*\):.*## \(.*\)/  \1	\2/p' $(MAKEFILE_LIST) | expand -t 18

demo: $(VENV)/.installed ## install, then diagnose a shipped machine; ends with the path of the report
	$(BIN)/feeddrive demo

test: $(VENV)/.developing ## the tests, without the slow ones
	$(PYTEST) -m 'not slow' $(TESTS)

test-slow: $(VENV)/.developing ## the slow tests alone
	$(PYTEST) -m slow $(TESTS)

check: $(VENV)/.developing ## every claim beside its bound and what is measured; goes on where it was stopped
	$(ONE_THREAD) $(BIN)/python -m tests.claims --workers $(WORKERS)

recovery: $(VENV)/.recovery ## plant every effect, diagnose it, write docs/recovery.md; goes on where it was stopped
	$(ONE_THREAD) $(BIN)/python -m tests.recovery.suite --workers $(WORKERS) $(RECOVERY)

recovery-fleet: $(VENV)/.developing ## machines drawn at random, diagnosed; goes on where it was stopped
	$(ONE_THREAD) $(BIN)/python -m tests.recovery.fleet $(FLEET) --out build/fleet --resume --workers $(WORKERS) --page docs/recovery.md

recovery-rivals: $(VENV)/.recovery ## sparse regression and a black box on the cases of the fleet; goes on where it was stopped
	$(ONE_THREAD) $(BIN)/python -m tests.recovery.fleet_rivals --out build/fleet --page docs/recovery.md

recovery-parts: $(VENV)/.developing ## machines described by their parts, recorded by finite elements; goes on where it was stopped
	$(ONE_THREAD) $(BIN)/python -m tests.recovery.parts --out build/parts --resume --page docs/recovery.md

recovery-smoke: $(VENV)/.developing ## one planted case for every effect
	$(PYTEST) tests/recovery/test_suite_smoke.py

fuzz: $(VENV)/.developing ## broken files and options of every kind: each is run or refused in one line
	$(ONE_THREAD) $(BIN)/python -m tests.fuzz $(FUZZ)

bench: $(VENV)/.developing ## timings beside those of other programs
	@for script in benchmarks/[!_]*.py; do echo "== $$script"; $(ONE_THREAD) $(BIN)/python "$$script" || exit 1; done

lint: $(VENV)/.developing ## style and layout of the code
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: $(VENV)/.developing ## strict type check of the package
	$(BIN)/mypy

format: $(VENV)/.developing ## mend style and layout
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

docs: $(VENV)/.documenting ## the documentation site, docs/_build/html; warnings are errors
	$(ONE_THREAD) $(BIN)/python -m sphinx -W --keep-going -n -E -q docs docs/_build/html
	@echo "docs/_build/html/index.html"

develop: $(VENV)/.developing ## set up .venv for working on feeddrive

clean: ## remove .venv, builds and caches
	rm -rf $(VENV) build dist docs/_build docs/generated .hypothesis .mypy_cache .pytest_cache .ruff_cache
	find . -path ./.git -prune -o -name __pycache__ -type d -prune -exec rm -rf {} +

# A stamp is touched only after its step has succeeded, so that a broken set-up is begun again.
$(VENV)/.created:
	@test -n "$(PYTHON)" || { echo "error: no Python 3.11 or newer found; name one: make PYTHON=/path/to/python" >&2; exit 1; }
	$(PYTHON) -m venv --clear $(VENV)
	@touch $@

$(VENV)/.installed: $(VENV)/.created pyproject.toml
	$(PIP_INSTALL) -e .
	@touch $@

$(VENV)/.developing: $(VENV)/.created pyproject.toml
	$(PIP_INSTALL) -e '.[dev]'
	@touch $(VENV)/.installed $@

$(VENV)/.recovery: $(VENV)/.developing
	$(PIP_INSTALL) -e '.[dev,recovery]'
	@touch $@

$(VENV)/.documenting: $(VENV)/.developing
	$(PIP_INSTALL) -e '.[dev,docs]'
	@touch $@
