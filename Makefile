# What people do daily. Every target makes what it needs; the second time is quick.
PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
# Tests wait for processes, pages and streams a quarter of their time: three workers keep two cores
# busy. Each begins with a third, so that what a file's tests share is mostly made once; who is
# through first takes from the others.
SHARED := -n 3 --dist worksteal
READY  := $(VENV)/.ready
# Distributions beside surae's own.
OTHERS := $(sort $(wildcard [a-z]*/pyproject.toml))
# Compiled files are kept: else every worker, and every process that a test starts, compiles anew.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: demo test test-long test-slow test-all check bench messages docs release wheel lock browser clean

demo: $(READY)          ## fit the embedded virtual subject, write demo/report.html
	@$(BIN)/surae demo --output demo

test: $(READY) browser  ## the fast suite
	$(BIN)/pytest $(SHARED)

test-long: $(READY) browser  ## what the fast suite leaves to CI: longer tests, and the pages in a browser
	$(BIN)/pytest $(SHARED) -m "long and not slow"

test-slow: $(READY) browser  ## of the slow suite what has its turn by tests/slow.toml
	$(BIN)/python .ci/slow $(SHARED)

test-all: $(READY) browser  ## everything, recovery and statistics too
	$(BIN)/pytest $(SHARED) -m ""

check: $(READY)         ## style and types
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

bench: $(READY)         ## speed against the plain SciPy baseline
	$(BIN)/pytest benchmarks --benchmark-columns=median,iqr,rounds --benchmark-sort=name

messages: $(READY)      ## bring the catalogues of the leg's page up to the source
	@for each in nl de fr; do $(BIN)/pybabel -q extract --no-location --no-wrap --sort-output -k N_ -k self -k many:1,2 \
	  -F .ci/babel.cfg -o .messages.pot . && \
	  sed -n 's/^msgid "..*"$$/&\nmsgstr ""\n/p' src/surae/report/locale/en/LC_MESSAGES/surae.po >> .messages.pot && \
	  $(BIN)/pybabel -q update --no-fuzzy-matching --ignore-obsolete --no-wrap --ignore-pot-creation-date \
	  -i .messages.pot -d src/surae/report/locale -D surae -l $$each; done; rm -f .messages.pot

docs: $(READY)          ## the documentation site, its examples executed, in docs/_build/html
	@rm -rf docs/api/generated
	$(BIN)/python -m sphinx -E -W --keep-going -q -b html docs docs/_build/html
	@echo "The site is docs/_build/html/index.html"

release: $(READY)      ## all that a release must pass; wheels and source archives in dist
	@$(BIN)/python .ci/release

wheel: $(READY)         ## wheels and source archives on the oldest and the newest Python and dependencies
	@.ci/wheel

lock: $(READY)          ## renew requirements.lock from pyproject.toml
	$(BIN)/python -m pip install --quiet uv
	$(BIN)/uv pip compile pyproject.toml --extra dev --universal --generate-hashes \
	    --no-header --no-annotate --quiet --upgrade --output-file requirements.lock

browser:                ## what the workbench's tests drive, and a compiler; installed in CI, else only looked for
	@.ci/browser
	@.ci/compiler

clean:                  ## remove what the other targets made
	rm -rf $(VENV) demo dist docs/_build docs/gallery docs/api/generated .pytest_cache .mypy_cache .ruff_cache .hypothesis .benchmarks

$(READY): requirements.lock pyproject.toml $(OTHERS)
	@$(PYTHON) -c 'import sys; sys.exit("surae needs Python 3.11 or newer: make PYTHON=python3.11" if sys.version_info < (3, 11) else 0)'
	@echo "Setting up $(VENV), once …"
	@$(PYTHON) -m venv --clear $(VENV)
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements.lock
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation $(addprefix --editable ,. $(dir $(OTHERS)))
	@touch $@
