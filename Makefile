# Everything needed to try the program and to work on it; `make help` lists it. Windows: see README.md.
# The environment is in .venv and is rebuilt only when pyproject.toml changes.

# Tried in this order, within the versions that pyproject.toml allows. To use another one:
#   make clean; make PYTHON=/path/to/python3.12 run
PYTHON = python3.13 python3.12 python3.11 python3.10 python3

# Packages that a minimal Debian or Ubuntu lacks: to load Qt, to show windows under X, to show them under Wayland.
packages = libglib2.0-0 libgl1 libegl1 libxkbcommon0 libdbus-1-3 libfontconfig1 \
           libxcb-cursor0 libxkbcommon-x11-0 libxcb-icccm4 libxcb-keysyms1 libxcb-shape0 \
           libwayland-cursor0 libwayland-egl1
quick test night pictures: packages += xvfb xauth

# Without a display, `make run` deforms the sample on the command line instead. macOS always has a display.
display = $(filter Darwin,$(shell uname))$(DISPLAY)$(WAYLAND_DISPLAY)

.PHONY: help run test night night-suite night-alone night-extras night-blender blender fuzz quick lint format docs pictures wheel release texts installer container clean \
        programs system-packages
.NOTPARALLEL:
.DELETE_ON_ERROR:

help: ## show this list
	@awk -F ':.*## ' '/^[a-z]+:.*## / { printf "  make %-9s %s\n", $$1, $$2 }' Makefile

# The window compiles beside itself; on the command line that would be a long silence.
run: $(if $(display),.venv/.installed,.venv/.compiled) ## set up what is missing, then open the window on the sample bottle
ifneq ($(display),)
	@.venv/bin/apd-viewer
else
	@mkdir -p out
	@.venv/bin/apd-viewer deform resources/bottle.obj --selection resources/bottle.sel \
	    --transform resources/bottle-twist-60.def \
	    -o out/bottle.obj --report out/report.json --picture out/bottle.png
	@echo "No display found; the sample bottle was twisted by 60 degrees on the command line instead, with its area kept."
	@echo "See out/bottle.obj (the mesh), out/bottle.png (a picture) and out/report.json (the measurements)."
endif

# pytest-xvfb starts its own X displays, but Qt would still prefer that of a Wayland session.
environment = env -u WAYLAND_DISPLAY XDG_SESSION_TYPE=x11

workers = -n auto --dist worksteal

test: lint programs ## set up what is missing, then run every check of the day: ruff, mypy, vermin, zizmor, pytest
	@.ci/step "pytest" $(environment) .venv/bin/pytest $(workers)
	@.venv/bin/python tests/support/night.py --last

# Named otherwise than by $(MAKE), which `make --dry-run` would run all the same.
make = $(MAKE)

# Each step is run, whether those before have passed or not.
night: .venv/.tools programs ## run every check, and write into tests/night.md what was found
	@.ci/step "The night" .venv/bin/python tests/support/night.py $(make) lint night-suite night-alone night-extras night-blender

# Only this form has what tests record.
results = -o junit_family=xunit1 --junit-xml=build/night/

night-suite: .venv/.tools
	@.ci/step "pytest, all tests" $(environment) .venv/bin/pytest --night $(workers) $(results)suite.xml

night-alone: .venv/.tools
	@.ci/step "pytest, tests that need all cores" $(environment) .venv/bin/pytest --alone $(results)alone.xml

# In an environment of its own, so that by day all is tested as it is for a user who has installed no extra.
extras = build/night/environment

night-extras: $(extras)/.installed
	@.ci/step "pytest, tests of extras" $(environment) $(extras)/bin/python -m pytest --extras $(results)extras.xml

$(extras)/.installed: pyproject.toml | system-packages
	@.ci/step "Creating $(extras) with $(python)" $(python) -m venv --clear $(extras)
	@.ci/step "Updating pip" $(extras)/bin/python -m pip install --quiet 'pip>=25.1'
	@.ci/step "Installing apd-viewer with all extras and the development tools into $(extras)" \
	    $(extras)/bin/python -m pip install --quiet --editable '.[video,cluster,usd,cad,notebook]' --group extras
	@touch $@

# Each version of Blender's module is for one version of Python: those that are here have an environment each.
blenders = $(strip $(foreach version,3.13 3.11,$(if \
    $(shell python$(version) -c '' 2>/dev/null && echo yes),build/night/blender-$(version))))
addon_tests = -c resources/blender/tests/pytest.ini --confcutdir=resources/blender/tests resources/blender/tests

night-blender: $(blenders:=/.installed) .venv/.compiled
	@test -n '$(blenders)' || { echo "Blender's module needs Python 3.13 or 3.11; install one."; exit 1; }
	@failed=; for blender in $(blenders); do \
	    .ci/step "pytest, the add-on in $$blender" $(environment) $$blender/bin/python -m pytest $(addon_tests) \
	        $(results)$$(basename $$blender).xml || failed=yes; \
	done; test -z "$$failed"

blender: $(firstword $(blenders:=/.installed)) ## build/apd_live-*.zip, the add-on for Blender
	@test -n '$(blenders)' || { echo "Blender's module needs Python 3.13 or 3.11; install one."; exit 1; }
	@.ci/step "Building the add-on" $(firstword $(blenders))/bin/python resources/blender/build.py build --archive

build/night/blender-%/.installed: resources/blender/tests/requirements.txt | system-packages
	@.ci/step "Creating $(@D) with python$*" python$* -m venv --clear $(@D)
	@.ci/step "Updating pip" $(@D)/bin/python -m pip install --quiet 'pip>=25.1'
	@.ci/step "Installing Blender's module and pytest into $(@D)" \
	    $(@D)/bin/python -m pip install --quiet --requirement resources/blender/tests/requirements.txt
	@touch $@

# atheris, which guides by coverage, has wheels for Linux and CPython 3.11 to 3.13.
fuzz = build/fuzz/environment
minutes = 60

fuzz: $(fuzz)/.installed ## damaged files to every reader for minutes=N, guided by coverage; only="NAME ..." to some
	@.ci/step "Fuzzing for $(minutes) minutes" $(fuzz)/bin/python tests/support/guided_fuzz.py $(minutes) $(only)

$(fuzz)/.installed: pyproject.toml | system-packages
	@.ci/step "Creating $(fuzz) with $(python)" $(python) -m venv --clear $(fuzz)
	@.ci/step "Updating pip" $(fuzz)/bin/python -m pip install --quiet 'pip>=25.1'
	@.ci/step "Installing apd-viewer, the development tools and atheris into $(fuzz)" \
	    $(fuzz)/bin/python -m pip install --quiet --editable . --group fuzz
	@touch $@

# What some tests run.
programs:
	@.ci/system-packages calculix-ccx || echo "Without CalculiX the tests that compute FE decks are skipped."
	@.ci/system-packages chromium || echo "Without Chromium the test of looking at pages is skipped."
	@.ci/system-packages desktop-file-utils || echo "Without desktop-file-utils two tests of desktop entries are skipped."

# Some tests of every room, about 75 s of CPU time together once the kernels are compiled.
quick_tests = tests/test_architecture.py tests/test_package.py tests/presentation tests/files/formats \
              tests/files/selections/test_selection_files.py tests/geometry/mesh/test_operators.py \
              tests/geometry/energy/test_arap.py tests/geometry/solver/test_deformation.py tests/session/model \
              tests/session/quantities tests/session/test_session.py tests/ui/scene/test_viewport.py

quick: lint .venv/.compiled ## run ruff, mypy and the tests that matter most, in less than a minute
	@.ci/step "pytest, the quick tests" $(environment) .venv/bin/pytest -n 2 --dist worksteal $(quick_tests)

lint: .venv/.tools ## run the checks that do not execute the program: ruff, mypy, vermin, zizmor
	@.ci/step "ruff check" .venv/bin/ruff check
	@.ci/step "ruff format --check" .venv/bin/ruff format --check
	@.ci/step "mypy" .venv/bin/mypy
	@.ci/step "vermin" .venv/bin/vermin --quiet -t=3.10- --no-tips --eval-annotations apd_viewer hatch_build.py
	@.ci/step "zizmor" .venv/bin/zizmor --offline --no-progress --quiet .github/workflows

format: .venv/.tools ## format the source and sort its imports
	@.ci/step "Sorting imports" .venv/bin/ruff check --fix --select I
	@.ci/step "Formatting" .venv/bin/ruff format

# Doctrees are kept beside the pages, so that the second time only what has changed is written.
docs: .venv/.tools ## build the site into build/docs; links between pages are checked
	@.ci/step "Building the site" .venv/bin/python -m sphinx -W -n -q --keep-going -d build/doctrees docs build/docs
	@echo "See build/docs/index.html."

release: docs ## build what a release uploads into dist, and check it: source, wheels, bill of materials
	@.ci/step "Installing what a release needs into .venv" .venv/bin/python -m pip install --quiet --group release
	@rm -rf build/kernels dist
	@.ci/step "Writing the completions for shells" .venv/bin/python resources/installer/completions.py
	@.ci/step "Building source and wheel" .venv/bin/python -m hatchling build -t sdist -t wheel
	@$(make) wheel
	@.ci/step "Checking them" .venv/bin/python -m twine check --strict dist/*
	@.ci/step "Writing the bill of materials" .venv/bin/python resources/installer/sbom.py dist/apd-viewer.cdx.json
	@cd dist && sha256sum * > SHA256SUMS
	@echo "See dist. For a tag such as v0.2.0 the workflow release does this, and offers it to PyPI."

wheel: docs ## build a wheel of this system, with the manual and compiled kernels in it, into dist
	@.ci/step "Compiling the kernels (about 2 minutes)" .venv/bin/python resources/installer/kernels.py
	@.ci/step "Writing the completions for shells" .venv/bin/python resources/installer/completions.py
	@.ci/step "Building the wheel" .venv/bin/python -m pip wheel --quiet --no-deps -w dist .
	@echo "See dist."

# Several minutes each on a busy machine; only=NAME ... makes some.
pictures: .venv/.tools ## make the pictures and sessions of the site again; only="NAME ..." makes some pictures
	@$(if $(only),,.ci/step "Making the gallery" $(environment) .venv/bin/python docs/gallery/make_sessions.py)
	@.ci/step "Making the pictures" $(environment) .venv/bin/python docs/pictures/make_pictures.py $(only)

texts: .venv/.tools ## collect and compile translations; language=fr starts a new one
	@.ci/step "Collecting the texts" .venv/bin/python .ci/texts.py $(language)

# In an environment of its own: PyInstaller packs what libraries import, and that depends on what is there.
packer = build/installer/environment
manual = $(packer)/bin/python -m sphinx -W -n -q --keep-going -d build/doctrees docs build/docs

installer: $(packer)/.installed ## build a program that needs no Python, in a package of this system in dist/
	@.ci/system-packages binutils
	@.ci/step "Writing the manual" $(manual)
	@.ci/step "Writing the completions for shells" $(packer)/bin/python resources/installer/completions.py
	@.ci/step "Building the program and its package (several minutes)" $(packer)/bin/python resources/installer/build.py

# Clusters have Apptainer, which reads what these write.
engine = $(firstword $(foreach each,podman docker,$(shell command -v $(each))))

container: ## build an image of the commands without a window, by podman or docker
	@.ci/step "Building the image apd-viewer (several minutes)" \
	    $(or $(engine),$(error Neither podman nor docker is there; install one of them)) \
	    build --tag apd-viewer --file resources/installer/Containerfile .

$(packer)/.installed: pyproject.toml
	@.ci/step "Creating $(packer) with $(python)" $(python) -m venv --clear $(packer)
	@.ci/step "Updating pip" $(packer)/bin/python -m pip install --quiet 'pip>=25.1'
	@.ci/step "Installing apd-viewer, its libraries and PyInstaller into $(packer)" \
	    $(packer)/bin/python -m pip install --quiet --editable . --group installer
	@touch $@

clean: ## remove the environment and all caches, but not out/
	rm -rf .venv build dist *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis
	@find . -name __pycache__ -type d -prune -exec rm -rf {} +

.venv/.tools: .venv/.installed
	@.ci/step "Installing the development tools into .venv" .venv/bin/python -m pip install --quiet --group dev
	@touch $@

.venv/.installed: .venv/bin/python pyproject.toml
	@.ci/step "Installing apd-viewer and its libraries into .venv (a download of 360 MB the first time)" \
	    .venv/bin/python -m pip install --quiet --editable .
	@touch $@

.venv/.compiled: .venv/.installed
	@.ci/step "Compiling the kernels, so that nothing waits for it later (about 2 minutes)" \
	    .venv/bin/python -c 'from apd_viewer.geometry.warmup import warm_up; warm_up()'
	@touch $@

# pip supports dependency groups since version 25.1.
.venv/bin/python: | system-packages
	@.ci/step "Creating .venv with $(python)" $(python) -m venv --clear .venv
	@.ci/step "Updating pip" .venv/bin/python -m pip install --quiet 'pip>=25.1'

# Checked at every start, which takes milliseconds. Debian packages the module venv separately from Python.
system-packages:
	@.ci/system-packages $(packages) $(if $(shell test -x .venv/bin/python && echo yes),,$(venv_package))

venv_package = $(shell $(python) -c 'import ensurepip' 2>/dev/null || \
    $(python) -c 'import sys; print("python3.%d-venv" % sys.version_info[1])')

python = $(or $(shell for p in $(PYTHON); do \
    $$p -c 'import sys; sys.exit(not (3, 10) <= sys.version_info[:2] <= (3, 13))' 2>/dev/null && echo $$p && break; \
    done),$(error No Python 3.10 to 3.13 among: $(PYTHON). Install one, or name it: make PYTHON=/path/to/python3.12 run))
