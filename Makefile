# make mms: set up .venv, run the study of the paper's Figure 1, print where the report is.   make test: all checks.
# make adapters: install public codes into .venv-adapters, and run their adapters.
PYTHON ?= python3
BIN = .venv/bin

.PHONY: mms test slow bench docs recorded adapters lock clean

mms: .venv/.installed
	$(BIN)/verify mms --method cpdi

test: .venv/.installed
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/pytest -n auto --dist loadscope

slow: .venv/.installed
	$(BIN)/pytest -m slow -n auto --dist loadscope

# The documentation as a site, results/site/index.html.
docs: .venv/.installed
	$(BIN)/mkdocs build --quiet

# Errors that later runs are held against; a change of a row is a change of the numbers.
recorded: .venv/.installed
	$(BIN)/python -m mpm_verify.cases.mms.recording

bench: .venv/.installed
	$(BIN)/pytest tests/benchmarks --benchmark-only -m "slow or not slow"

adapters: .venv/.installed .venv-adapters/.installed
	ADAPTERS_PYTHON=$(CURDIR)/.venv-adapters/bin/python $(BIN)/pytest tests/test_adapters.py tests/test_foreign_sources.py -m "slow or not slow"

.venv-adapters/.installed: examples/adapters/requirements.txt
	@echo "setting up .venv-adapters with the public codes of examples/adapters/requirements.txt ..."
	@$(PYTHON) -m venv .venv-adapters
	@.venv-adapters/bin/python -m pip install --quiet --disable-pip-version-check -r examples/adapters/requirements.txt
	@touch $@

.venv/.installed: requirements.lock pyproject.toml
	@$(PYTHON) -c "import sys; sys.exit(sys.version_info < (3, 11) and 'Python 3.11 or newer is needed: make PYTHON=python3.12')"
	@echo "setting up .venv with the packages of requirements.lock ..."
	@$(PYTHON) -m venv .venv
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements.lock
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation -e .
	@touch $@

lock: .venv/.installed
	$(BIN)/python -m pip install --quiet pip-tools
	$(BIN)/pip-compile --quiet --generate-hashes --allow-unsafe --strip-extras --extra dev --no-emit-index-url --no-emit-find-links --no-emit-trusted-host --output-file requirements.lock pyproject.toml

clean:
	rm -rf .venv .venv-adapters results
