# motionedit: everything a user or a builder does, in one word each. `make` alone lists the targets.

# Where Python is installed on Windows, `python3` may be another one.
PYTHON ?= $(if $(filter Windows_NT,$(OS)),python,python3)
VENV ?= .venv
ifeq ($(OS),Windows_NT)
BIN := $(VENV)/Scripts
else
BIN := $(VENV)/bin
endif
STAMP := $(VENV)/.installed
OUT ?= out
CSRC := $(wildcard motionedit/core/csrc/*.[ch] motionedit/core/*/csrc/*.[ch] motionedit/core/*/*/csrc/*.[ch])
JOBS ?= 2

# One BLAS thread: the results do not depend on the machine's cores, and small solves are faster.
export OPENBLAS_NUM_THREADS ?= 1
export OMP_NUM_THREADS ?= 1

.DEFAULT_GOAL := help
.PHONY: help install demo test test-numpy test-lowest sanitize fuzz mutants test-all changelog release-check lint types docs docs-check golden bench bench-peers bench-scale figures pictures trials paper data clean

help:  ## list the targets
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 14

install: $(STAMP)  ## set up a virtual environment in .venv with everything that the other targets need

$(STAMP): pyproject.toml $(CSRC)
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --upgrade pip
	$(BIN)/python -m pip install --quiet --editable '.[plot,cluster,dev]'
	@$(BIN)/motionedit --version
	@touch $@

demo: $(STAMP)  ## normalize ten golf swings, fit the motion PCA, move the ball, and say what to open
	$(BIN)/motionedit normalize data/golf -s configs/golf-normalize.yaml -o $(OUT)/golf-normalized
	$(BIN)/motionedit fit-pca $(OUT)/golf-normalized -s configs/golf-fit.yaml -o $(OUT)/golf.npz
	$(BIN)/motionedit edit-pc data/golf/swing04.bvh -m $(OUT)/golf.npz -s configs/golf-edit.yaml -o $(OUT)/swing04-edited.bvh --preview
	@echo
	@echo "The edited swing is $(OUT)/swing04-edited.bvh, a file for any BVH viewer."
	@echo "Open $(OUT)/swing04-edited.html in a browser: the input and the edited swing, overlaid, and the goal."

test: $(STAMP)  ## run the tests, without those that take long, and the linters
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/clang-format --dry-run -Werror $(CSRC)
	$(BIN)/mypy
	$(BIN)/python -m pytest -n $(JOBS) -m 'not slow'
	$(BIN)/python .ci/changelog.py

# No solver has a part in these.
UNSOLVED := architecture browser docs habits spec

test-numpy: $(STAMP)  ## run those that solve without the compiled solver, as where there is no C compiler
	MOTIONEDIT_SOLVER=numpy $(BIN)/python -m pytest -n $(JOBS) -m 'not slow and not compiled' $(UNSOLVED:%=--ignore=tests/%)

# The oldest releases have wheels for the oldest Python. Beside newer ones of what they use themselves they warn.
LOWEST := .venv-lowest
LOWEST_PYTHON ?= python3.11
$(LOWEST)/.installed: pyproject.toml .ci/lowest.py $(CSRC)
	$(LOWEST_PYTHON) -m venv $(LOWEST)
	$(LOWEST)/bin/python .ci/lowest.py > $(LOWEST)/constraints.txt
	$(LOWEST)/bin/python -m pip install --quiet --editable '.[plot,dev]' --constraint $(LOWEST)/constraints.txt
	@touch $@

test-lowest: $(LOWEST)/.installed  ## run the tests of parts and commands with the oldest releases that pyproject.toml names
	$(LOWEST)/bin/python -m pytest -n $(JOBS) -m 'not slow' -W ignore::DeprecationWarning tests/cli tests/library tests/spec tests/unit

sanitize: $(STAMP)  ## run the compiled part's tests under the address and undefined-behaviour sanitizers (gcc)
	JOBS=$(JOBS) bash tests/sanitize.sh $(abspath $(BIN)/python)

EXAMPLES ?= 300
fuzz: $(STAMP)  ## give the commands damaged files of every kind that they read; EXAMPLES=10000: so many of each kind
	MOTIONEDIT_FUZZ=$(EXAMPLES) $(BIN)/python -m pytest -n $(JOBS) tests/fuzz

MOST ?= 60
mutants: $(STAMP)  ## report which small faults in FILE=motionedit/... no test notices; MOST=100: so many are tried
	$(BIN)/python .ci/mutants.py $(FILE) --most $(MOST) --jobs $(JOBS)

test-all: $(STAMP)  ## run every test, with branch coverage
	$(BIN)/python -m pytest -n $(JOBS) --cov --cov-report=term-missing:skip-covered

changelog: $(STAMP)  ## fail where a user can notice what was committed, and CHANGELOG.md does not say it
	$(BIN)/python .ci/changelog.py

release-check: $(STAMP)  ## fail where the places that name the version disagree; TAG=v1.2.3: where it cannot be released
	$(BIN)/python .ci/release.py $(if $(TAG),--tag $(TAG))

lint: $(STAMP)  ## check style, and format
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .
	$(BIN)/clang-format -i $(CSRC)

types: $(STAMP)  ## check types
	$(BIN)/mypy

docs: $(STAMP)  ## write the pages that are generated from the program
	$(BIN)/python docs/generate.py

docs-check: $(STAMP)  ## fail if a generated page is not what the program says
	$(BIN)/python docs/generate.py --check

golden: $(STAMP)  ## write the golden files anew; look at the difference before you commit it
	$(BIN)/python tests/golden/write.py

bench: $(STAMP)  ## measure speed, as ratios inside one run
	$(BIN)/python -m benchmarks.run

PEERS := pink mink placo bpy pybvh
# What cannot be installed is left out; its rows say so. Its log is .venv-peers/NAME.log.
.venv-peers/%/.installed: benchmarks/peers/requirements/%.txt
	@echo "setting up .venv-peers/$*"
	@mkdir -p .venv-peers
	@($(PYTHON) -m venv $(@D) && $(@D)/bin/python -m pip install --requirement $< && touch $@) > .venv-peers/$*.log 2>&1 \
		|| echo "$* cannot be installed, see .venv-peers/$*.log"

bench-peers: $(STAMP) $(PEERS:%=.venv-peers/%/.installed)  ## measure beside pink, mink, placo, Blender and pybvh, each in a .venv-peers/NAME
	$(BIN)/python -m benchmarks.peers.compare

bench-scale: $(STAMP)  ## measure many and long clips: their time and peak memory
	$(BIN)/python -m benchmarks.scale

figures: $(STAMP)  ## print the accuracy figures that the documentation quotes
	$(BIN)/python -m studies.figures

pictures: $(STAMP)  ## draw the pictures of docs/giving-way.md anew
	$(BIN)/python -m studies.giving_way

trials: $(STAMP)  ## measure many edits of many clips from outside: strict, smooth, believable
	$(BIN)/python -m studies.trials.run

paper: $(STAMP)  ## make the tables and figures of both papers anew, in out/paper and in docs/
	$(BIN)/python -m studies.paper.run --out $(OUT)/paper --docs

data: $(STAMP)  ## write the clips in data/ anew, from the generator
	$(BIN)/python -m data.generator

clean:  ## remove what the targets made, but not the virtual environment
	rm -rf $(OUT) build dist *.egg-info .coverage htmlcov .mypy_cache .pytest_cache .ruff_cache .hypothesis
