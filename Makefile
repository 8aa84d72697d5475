# Each target does all its set-up on a fresh machine (plain Python >= 3.11 and make) in an environment of its own.
PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
JOBS   ?= 2

.PHONY: help validate test test-all check gate bench prove docs format clean

help:            ## this list
	@grep -hE '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed 's/:.*##/\t/'

$(VENV)/.run: pyproject.toml constraints.txt
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable '.[engines,parquet,robots]'
	@touch $@

$(VENV)/.dev: $(VENV)/.run
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable '.[engines,parquet,robots,cluster,peers,dev]'
	@touch $@

validate: $(VENV)/.run   ## the main job: the built-in suite over all engines, report in results/
	$(BIN)/denoc validate --out results

# One thread of linear algebra for each of the jobs: several of them with several threads each wait for one another.
test: $(VENV)/.dev check ## formatter, linter, types, direction of dependency, then the tests that are not slow
	OPENBLAS_NUM_THREADS=1 $(BIN)/python -m pytest -n $(JOBS) --dist worksteal -m "not slow"

test-all: $(VENV)/.dev check ## the same with every test, slow ones too
	OPENBLAS_NUM_THREADS=1 $(BIN)/python -m pytest -n $(JOBS) --dist worksteal

check: $(VENV)/.dev      ## formatter, linter, types, direction of dependency
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports

gate: $(VENV)/.run       ## hold the suite against the accepted figures in reference/
	$(BIN)/denoc gate

bench: $(VENV)/.dev      ## time and memory against the peers
	$(BIN)/denoc bench

prove: $(VENV)/.dev      ## the blind proof, quick form
	$(BIN)/denoc prove --quick

docs: $(VENV)/.dev       ## the documentation as a site, to be read from disk: site/index.html
	$(BIN)/mkdocs build --strict --quiet

format: $(VENV)/.dev     ## format and mend what can be mended by tool
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

clean:           ## remove what make made
	rm -rf $(VENV) results site
