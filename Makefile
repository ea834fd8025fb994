# SPDX-License-Identifier: GPL-3.0-or-later
# `make demo` and `make test` are all that a newcomer needs; the rest is for those who work on vgroove.
export UV_PYTHON_DOWNLOADS ?= never
unexport PYTHONDONTWRITEBYTECODE  # else each of the many processes of the tests compiles all of Python's files anew
UV := $(shell command -v uv 2>/dev/null || echo .tools/uv/bin/uv)
RUN = $(UV) run --quiet
RUN_45 = UV_PROJECT_ENVIRONMENT=.venv-4.5 $(UV) run --quiet --python 3.11
RUN_53 = UV_PROJECT_ENVIRONMENT=.venv-5.3 $(UV) run --quiet --no-group blender-5-2 --group blender-5-3
# Which rows test-all adds; DAY=2026-12-01 repeats those of that night.
DAY := $(shell date +%F)
PYTEST = pytest -n auto --dist worksteal  # neighbours stay together: they share node groups and the reference's integrals

.PHONY: demo test test-once test-4.5 test-5.3 test-all test-every test-window test-page lint check report across documents docs previews assets package listing release clean

demo: | $(UV)  ## the six lecture materials on one sheet, and Cycles against NumPy
	$(RUN) python tools/demo.py build/demo.png

test test-once test-4.5 test-5.3 test-all test-every: export OPENBLAS_NUM_THREADS = 1  # a worker a core: more threads would only wait for each other

test: | $(UV)  ## the tests, on Blender 5.2 LTS; of grids of renders each value; not what takes long
	$(RUN) $(PYTEST) -m "not once and not slow"

test-once: | $(UV)  ## the rest of them: what takes long, and deliberate errors
	$(RUN) $(PYTEST) -m "once or slow"

test-4.5: | $(UV)  ## on Blender 4.5 LTS, what depends on the Blender
	$(RUN_45) $(PYTEST)

test-5.3: | $(UV)  ## on Blender 5.3
	$(RUN_53) $(PYTEST)

test-all: | $(UV)  ## for each night: the tests on all three, a seventh of all other rows, clicks in a window, the page in a browser
	$(RUN) $(PYTEST) --rotate $(DAY)
	$(RUN_45) $(PYTEST) --rotate $(DAY)
	$(RUN_53) $(PYTEST) --rotate $(DAY)
	$(MAKE) test-window
	$(MAKE) test-page

test-every: | $(UV)  ## every row of every grid, on all three
	$(RUN) $(PYTEST) --cover 0
	$(RUN_45) $(PYTEST) --cover 0
	$(RUN_53) $(PYTEST) --cover 0

test-window: | $(UV)  ## clicks in a real Blender's window: Debian's, in .cache/window; as root, on Debian
	$(RUN) pytest tests/window

test-page: | $(UV)  ## the viewer's page in Chromium, which apt-get installs where it is missing; as root, on Debian
	$(RUN) pytest tests/page

lint: | $(UV)  ## format, lint, types
	$(RUN) ruff format --check .
	$(RUN) ruff check .
	mkdir -p .cache/types && ln -sfn ../.. .cache/types/vgroove && MYPYPATH=.cache/types $(RUN) mypy -p vgroove

check: | $(UV)  ## every model x estimator x backend, Cycles against NumPy, on each Blender
	@failed=0; for run in "$(RUN)" "$(RUN_53)" "$(RUN_45)"; do env $$run vgroove check || failed=$$?; done; exit $$failed

report: | $(UV)  ## error against run time, stability, what was left out: all of it on 5.2, the ends of it on the others; one page
	@failed=0; $(RUN) vgroove report -o build/report || failed=$$?; \
	$(RUN_53) vgroove report --quick -o build/report || failed=$$?; \
	if $(UV) python find --quiet 3.11 >/dev/null; then $(RUN_45) vgroove report --quick -o build/report || failed=$$?; \
	else echo "no Python 3.11: Blender 4.5 is left out"; fi; exit $$failed

across: | $(UV)  ## presets and textured scenes by each Blender, and how far apart they are
	$(RUN) python tools/across_blenders.py render build/across
	$(RUN_53) python tools/across_blenders.py render build/across
	$(RUN_45) python tools/across_blenders.py render build/across
	$(RUN) python tools/across_blenders.py compare build/across

documents: | $(UV)  ## what `make report` measured into docs/, its figures into every page, its biases into Automatic
	$(RUN) vgroove report --from build/report/report.json --documents .

docs: | $(UV)  ## the site: build/site/index.html, which needs no server
	NO_MKDOCS_2_WARNING=1 $(RUN) mkdocs build --strict  # with --quiet warnings would not count

previews: | $(UV)  ## a picture of every preset that has none yet or has changed, for the panel and the asset library
	$(RUN) python tools/previews.py

assets: previews  ## every preset for the Asset Browser, a file for each Blender that there is a Python for
	$(RUN) python tools/assets.py
	$(RUN_53) python tools/assets.py
	@if $(UV) python find --quiet 3.11 >/dev/null; then $(RUN_45) python tools/assets.py; \
	else echo "no Python 3.11: the library for Blender 4.5 is left out"; fi

package: assets  ## the extension as dist/vgroove-VERSION.zip, built and validated by Blender's own tool
	$(RUN) python tools/package.py dist

listing: | $(UV)  ## what a web server serves for Get Extensions and as a remote asset library: dist/extensions, dist/library
	$(RUN) python tools/listing.py extensions dist/extensions
	$(RUN_53) python tools/listing.py library dist/library

release: | $(UV)  ## from a clean tree: all that must pass, then zip, wheel, sdist, SHA256SUMS, notes and listings in dist/
	$(RUN) python tools/release.py --clean
	.ci/run
	$(MAKE) assets
	$(RUN) python tools/release.py dist
	$(MAKE) listing

.tools/uv/bin/uv:  # an environment of its own, as many systems refuse `pip install` outside one
	python3 -m venv .tools/uv
	.tools/uv/bin/pip install --quiet uv==0.13.9

clean:
	rm -rf build dist previews assets .cache .tools .venv .venv-4.5 .venv-5.3
