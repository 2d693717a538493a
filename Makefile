# `make demo` and `make test` do everything on a machine with Rust, Python, make and a C compiler.
#
# make build         .venv with an importable release build and the tools of development
# make demo          a robot driving through a generated floor plan: the recording and a picture in demo/
# make test          all of: lint, test-rust, test-python
# make test-ros      the nodes on the real ROS 1 (from Debian, as root or with sudo) and ROS 2 (from PyPI)
# make wheel         one wheel in dist/, for CPython 3.10 and later on any Linux since 2014
# make lock          newest versions of what requirements-dev.txt pins
# make clean         none of the above
#
# PYTHON=python3.12 make build        the interpreter for a new .venv

PYTHON ?= python3
BIN := .venv/bin
CORE := python/mobile_robot_simulator/_core.abi3.so

export VIRTUAL_ENV := $(CURDIR)/.venv
export PIP_DISABLE_PIP_VERSION_CHECK := 1
unexport CONDA_PREFIX PYTHONHOME PYTHONPATH

.DELETE_ON_ERROR:
.PHONY: build demo test lint test-rust test-python test-ros wheel lock clean

build: $(CORE)

.venv/tools: requirements-dev.txt
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 10) and "CPython 3.10 or later is needed, $(PYTHON) is " + sys.version)'
	test -x $(BIN)/pip || $(PYTHON) -m venv --clear .venv
	$(BIN)/python -m pip install --quiet --requirement requirements-dev.txt
	@touch $@

$(CORE): .venv/tools pyproject.toml Cargo.toml Cargo.lock $(shell find src -name '*.rs')
	PIP_QUIET=1 $(BIN)/maturin develop --release --locked
	@touch $@

demo: build
	$(BIN)/mobile-robot-simulator floor-plan demo/office.yaml --seed 1
	$(BIN)/mobile-robot-simulator run demo/office.yaml --duration 120 --seed 1 --out demo --overwrite

test: lint test-rust test-python

lint: build
	cargo fmt --check
	cargo clippy --locked --all-targets -- --deny warnings
	cargo clippy --locked --all-targets --features python -- --deny warnings
	RUSTDOCFLAGS='--deny warnings' cargo doc --locked --no-deps
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy
	$(BIN)/python -m mypy.stubtest mobile_robot_simulator._core

test-rust:
	cargo test --locked
	cargo test --locked --release --test exact

test-python: build
	$(BIN)/pytest

test-ros: wheel
	tests/ros/run dist/*.whl

# Linked by zig against an old C library. No flag of the builder's own enters, such as for its own processor.
wheel: .venv/tools
	rm -rf dist
	PATH="$(VIRTUAL_ENV)/bin:$$PATH" CARGO_ENCODED_RUSTFLAGS= $(BIN)/maturin build --release --locked --zig --compatibility manylinux_2_17 --out dist

lock: .venv/tools
	$(BIN)/python -m pip install --quiet uv
	$(BIN)/uv pip compile --quiet --upgrade --universal --python-version 3.10 --all-extras --group dev pyproject.toml \
		--no-emit-package mobile-robot-simulator --no-annotate --custom-compile-command 'make lock' --output-file requirements-dev.txt

clean:
	rm -rf .venv .venv-ros1 .venv-ros2 target dist demo $(CORE)
