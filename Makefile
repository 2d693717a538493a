# `make demo` and `make test` do everything on a machine with Rust, Python, make and a C compiler.
#
# make build         makes .venv with the development tools and an importable release build
# make demo          drives a robot through a generated floor plan; the recording and a picture are in demo/
# make speed         measures the speed of scans on generated maps, for each kernel
# make check         lints and the fast tests, with a development build: within a minute when little has changed
# make test          lints, documentation and all tests
# make fuzz          runs the long random tests, for some minutes
# make docs          builds the documentation into site/, offline; a broken link or an undocumented name fails
# make test-ray      tests data sets on a real Ray cluster of this machine; installs Ray (from PyPI) on the first run
# make test-torch    tests learning and data sets with PyTorch, Stable-Baselines3 and LeRobot; installs them (from PyPI) on the first run
# make test-ros      tests the nodes on the real ROS 1 (from Debian, as root or with sudo) and ROS 2 (from PyPI)
# make test-live     tests the live view in Chromium (from Debian, as root or with sudo)
# make wheel         builds one wheel in dist/, for CPython 3.10 and later on any Linux since 2014
# make lock          updates requirements-dev.txt to the newest versions
# make clean         removes everything that the other targets make
#
# PYTHON=python3.12 make build        chooses the interpreter of a new .venv
# PYTEST_ARGS='-k laser -x' make test-python        passes arguments to pytest

PYTHON ?= python3
BIN := .venv/bin
CORE := python/mobile_robot_simulator/_core.abi3.so
CORE_SOURCES := pyproject.toml Cargo.toml Cargo.lock $(shell find src -name '*.rs')
PYTHON_SOURCES := $(shell find python -name '*.py')

export VIRTUAL_ENV := $(CURDIR)/.venv
export PIP_DISABLE_PIP_VERSION_CHECK := 1
export NO_MKDOCS_2_WARNING := 1
unexport CONDA_PREFIX PYTHONHOME PYTHONPATH

.DELETE_ON_ERROR:
.PHONY: build demo speed check test lint lint-rust lint-python lint-workflows test-rust test-python fuzz docs test-ray test-torch test-ros test-live wheel lock clean

build: .venv/release .venv/compiled

.venv/tools: requirements-dev.txt
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 10) and "CPython 3.10 or later is needed, $(PYTHON) is " + sys.version)'
	test -x $(BIN)/pip || $(PYTHON) -m venv --clear .venv
	$(BIN)/python -m pip install --quiet --requirement requirements-dev.txt
	@touch $@

# The package has one extension module: .venv/release or .venv/development marks which build it is.
.venv/release: .venv/tools $(CORE_SOURCES)
	PIP_QUIET=1 $(BIN)/maturin develop --release --locked
	@rm -f .venv/development
	@touch $@

.venv/development: .venv/tools $(CORE_SOURCES)
	PIP_QUIET=1 $(BIN)/maturin develop --profile quick --locked
	@rm -f .venv/release
	@touch $@

# pip compiles the Python files of a wheel. Those of an editable package are compiled here, so that the first command is fast too.
.venv/compiled: .venv/tools $(PYTHON_SOURCES)
	$(BIN)/python -m compileall -q python
	@touch $@

demo: build
	mkdir -p demo
	$(BIN)/mobile-robot-simulator floor-plan demo/office.yaml --seed 1
	$(BIN)/mobile-robot-simulator run demo/office.yaml --duration 120 --seed 1 --out demo --overwrite

SPEED := target/speed
speed: build
	mkdir -p $(SPEED)
	$(BIN)/mobile-robot-simulator floor-plan $(SPEED)/office.yaml --seed 1 --size 60 40
	$(BIN)/mobile-robot-simulator floor-plan $(SPEED)/corridor.yaml --seed 1 --kind corridor --size 120 60
	$(BIN)/mobile-robot-simulator floor-plan $(SPEED)/warehouse.yaml --seed 1 --kind warehouse --size 80 50
	cargo bench --quiet --locked --bench ratios -- $(foreach plan,office corridor warehouse,$(SPEED)/$(plan).pgm) empty

check: .venv/development lint-rust lint-python
	cargo test --quiet --locked --profile quick --lib
	$(BIN)/pytest --quiet --numprocesses auto -m "not slow" $(PYTEST_ARGS)

test: build lint docs test-rust test-python

lint: build lint-rust lint-python lint-workflows

lint-rust:
	cargo fmt --check
	cargo clippy --quiet --locked --all-targets -- --deny warnings
	cargo clippy --quiet --locked --all-targets --features python -- --deny warnings
	RUSTDOCFLAGS='--deny warnings' cargo doc --quiet --locked --no-deps

lint-python: .venv/tools
	$(BIN)/ruff check --quiet
	$(BIN)/ruff format --check --quiet
	$(BIN)/mypy
	$(BIN)/python -m mypy.stubtest mobile_robot_simulator._core

lint-workflows: .venv/tools
	$(BIN)/check-jsonschema --builtin-schema vendor.github-workflows .github/workflows/*.yml
	$(BIN)/zizmor --offline --quiet .github/workflows

test-rust:
	cargo test --locked
	cargo test --locked --release --test exact

fuzz:
	cargo test --locked --release --test contact -- --ignored --nocapture

test-python: build
	$(BIN)/pytest --numprocesses auto $(PYTEST_ARGS)

docs: build
	$(BIN)/python docs/tools/generate_pages.py
	$(BIN)/python docs/tools/stub_docstrings.py
	$(BIN)/mkdocs build --quiet --strict
	$(BIN)/python docs/tools/check_reference.py

test-ray: wheel
	tests/ray/run dist/*.whl

test-torch: wheel
	tests/torch/run dist/*.whl

test-ros: wheel
	tests/ros/run dist/*.whl

test-live: wheel
	tests/browser/run dist/*.whl

# Linked by zig against an old C library. No flag of the builder's own enters, such as for its own processor.
wheel: .venv/tools
	rm -rf dist
	PATH="$(VIRTUAL_ENV)/bin:$$PATH" CARGO_ENCODED_RUSTFLAGS= $(BIN)/maturin build --release --locked --zig --compatibility manylinux_2_17 --out dist

lock: .venv/tools
	$(BIN)/python -m pip install --quiet uv
	$(BIN)/uv pip compile --quiet --upgrade --universal --python-version 3.10 --extra all --group dev pyproject.toml \
		--no-emit-package mobile-robot-simulator --no-annotate --custom-compile-command 'make lock' --output-file requirements-dev.txt

clean:
	rm -rf .venv .venv-browser .venv-ray .venv-ros1 .venv-ros2 .venv-torch target dist demo site $(CORE)
