# Two commands do everything on a fresh machine: `make demo` and `make test`. Both set up .venv first.
SHELL := /bin/bash
VENV ?= .venv
PY := $(VENV)/bin/python

# A tool that prints the path of a real Blender for a version (optional), or name one yourself: make test BLENDER=/path/to/blender
REAL_BLENDER ?= ../shared/tools/real-blender
BLENDER ?=
export BLENDER REAL_BLENDER

.PHONY: help setup demo test lint bench evaluate wheels extension clean
help:
	@echo "make setup      .venv with Blender as a Python module, the library, and what tests and training need"
	@echo "make demo       mesh a logo, an airfoil and a text in headless Blender: build/demo.blend, build/demo.png"
	@echo "make test       ruff, the library's tests, the add-on's on the bpy wheel and in a real Blender"
	@echo "make lint       ruff alone"
	@echo "make bench      speed and memory of the mesher, and its domains, beside Gmsh: benchmarks/results/, docs/results/"
	@echo "make evaluate   the shipped networks against Gmsh and the paper: docs/results/"
	@echo "make wheels     fetch the pinned onnxruntime wheels into wheels/"
	@echo "make extension  build/extension/*.zip, one for each platform"

# Each stamp is newer than its .venv only if everything in it was installed.
$(VENV)/.runtime: requirements/runtime.txt pyproject.toml scripts/make_venv.sh
	scripts/make_venv.sh $(VENV)
	$(PY) -m pip install --quiet -r requirements/runtime.txt
	$(PY) -m pip install --quiet -e .
	touch $@

$(VENV)/.develop: $(VENV)/.runtime requirements/develop.txt
	$(PY) -m pip install --quiet -r requirements/develop.txt
	touch $@

setup: $(VENV)/.develop

demo: $(VENV)/.runtime
	$(PY) -m examples.demo

lint: $(VENV)/.develop
	$(PY) -m ruff check .

test: lint wheels
	$(PY) -m pytest

bench: $(VENV)/.develop
	$(PY) -m benchmarks.speed
	$(PY) -m benchmarks.domains

evaluate: $(VENV)/.develop
	$(PY) -m training.evaluate

wheels: $(VENV)/.runtime
	$(PY) -m scripts.fetch_wheels

extension: wheels
	$(PY) -m scripts.build_extension

clean:
	rm -rf build wheels
