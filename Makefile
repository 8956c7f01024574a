# Short names for the few commands that everybody needs. CMakePresets.json has the details.
#
#   make         installs missing packages, builds luxel and luxel-view
#   make demo    the same, and bakes the Cornell box
#   make test    installs missing packages, builds everything, runs the tests
#   make test-all   the tests, and those of tests/only_in_test_all.txt
#   make luxel-bench  the program behind `luxel bench`
#   make python  the Python module, build/release/python, and a wheel of it, build/release/wheel
#   make package  the .deb files of Debian, build/release/packages (docs/guide/install.md)
#   make docs    checks the pages: links, widths, sentences, commands, options, generated pages; makes
#                the API pages, build/api/html/index.html

SHELL := /bin/bash
LUXEL := build/release/bin/luxel
SOURCES := find . \( -path ./build -o -path './.*' -o -name node_modules \) -prune -o \
           \( -name '*.h' -o -name '*.cpp' \) -print0

# ccache, where there is one, makes rebuilding cheap. It is never required.
ifneq ($(shell command -v ccache),)
export CMAKE_CXX_COMPILER_LAUNCHER ?= ccache
export CCACHE_SLOPPINESS ?= pch_defines,time_macros
endif
# One compiler for every 2 GB of memory, at most one per core: Debian machines swap otherwise.
JOBS ?= $(shell awk -v cores=$$(nproc) '/MemAvailable/ { jobs = int($$2 / 2097152); \
          print jobs < 1 ? 1 : jobs < cores ? jobs : cores }' /proc/meminfo)

# More arguments for configuring: .ci/run gives -DLUXEL_WERROR=ON.
CONFIGURE ?=

.DEFAULT_GOAL := all
.PHONY: all luxel-bench setup setup-tests setup-docs setup-package build python package test ray-queries test-all demo docs bench asan tsan fuzz mutants format format-check clean

setup:
	@tools/setup.sh

# What only tests use, too.
setup-tests:
	@tools/setup.sh tests

# What only the API pages need.
setup-docs:
	@tools/setup.sh docs

# What only packages need.
setup-package:
	@tools/setup.sh package

build: setup
	cmake --preset release $(CONFIGURE)
	cmake --build --preset release --parallel $(JOBS) --target luxel luxel-view

all: build
	@echo
	@echo "Built build/release/bin/luxel and build/release/bin/luxel-view. Next: make demo, or"
	@echo "  build/release/bin/luxel bake scenes/cornell-box.glb -o baked/cornell-box"

luxel-bench: build
	cmake --build --preset release --parallel $(JOBS) --target luxel-bench

python: build
	cmake --build --preset release --parallel $(JOBS) --target luxel_python
	tools/python_wheel.sh build/release/python build/release/wheel \
	  $$(sed -n 's/^_Python3_EXECUTABLE:INTERNAL=//p' build/release/CMakeCache.txt)

package: setup setup-package
	cmake --preset release $(CONFIGURE)
	cmake --build --preset release --parallel $(JOBS) --target packages
	@ls build/release/packages/*.deb

test: setup-tests
	cmake --preset release $(CONFIGURE)
	cmake --build --preset release --parallel $(JOBS)
	ctest --preset release --parallel $$(nproc) --label-exclude thorough --output-junit tests.xml

# Rays by ray queries, which lavapipe knows from Mesa 24.1 on: on that of Debian's backports, where
# there is one. After `make test`.
ray-queries:
	tools/newer_lavapipe.sh build/lavapipe
	export VK_ICD_FILENAMES=$$(ls $(CURDIR)/build/lavapipe/lavapipe.json 2>/dev/null); \
	  [[ -n $$VK_ICD_FILENAMES ]] || unset VK_ICD_FILENAMES; \
	  ctest --preset release --parallel $$(nproc) -R '/driver|RayQueries|HierarchiesOnDevice|FirstHitsOnDevice'

test-all: setup-tests
	cmake --preset release $(CONFIGURE)
	cmake --build --preset release --parallel $(JOBS)
	ctest --preset release --parallel $$(nproc)

demo: build
	$(LUXEL) bake scenes/cornell-box.glb -o baked/cornell-box --resolution 256 --samples 512
	@echo
	@echo "A picture of the bake:  baked/cornell-box/preview.png"
	@echo "Walk about in it:       build/release/bin/luxel-view baked/cornell-box"
	@echo "For any glTF viewer:    build/release/bin/luxel bake scenes/cornell-box.glb -o baked/viewer --attach combined"

# docs/options.md is made by tools/make_options_page.py, docs/bench/benchmarks.md by
# tools/make_bench_page.py from the .csv files beside it.
docs: luxel-bench setup-docs
	tools/make_options_page.py $(LUXEL) --check
	tools/make_options_page.py $(LUXEL) --names > build/option_names.txt
	tools/check_pages.py --options build/option_names.txt
	tools/make_bench_page.py --check
	tools/check_api.py --pages build/api

bench: luxel-bench
	$(LUXEL) bench all

# The fast tests under clang's AddressSanitizer and UndefinedBehaviorSanitizer, and a corpus of the fuzzers. Leak
# detection stays on: neither Embree nor TBB needs a suppression.
asan: setup-tests
	cmake --preset asan $(CONFIGURE)
	cmake --build --preset asan --parallel $(JOBS)
	ctest --preset asan --parallel $$(nproc)

# The fast tests under ThreadSanitizer: once before each release.
tsan: setup-tests
	cmake --preset tsan
	cmake --build --preset tsan --parallel $(JOBS)
	ctest --preset tsan --parallel $$(nproc)

# Each fuzzer for a minute: tests/fuzz/README.md. FUZZ_SECONDS and TARGET choose otherwise.
FUZZ_SECONDS ?= 60
fuzz:
	@tools/setup.sh fuzz
	cmake --preset fuzz $(CONFIGURE)
	cmake --build --preset fuzz --parallel $(JOBS) --target luxel_fuzz
	tools/fuzz.sh $(FUZZ_SECONDS) $(TARGET)

# Damaged files of every format that luxel reads: before each release.
mutants: build
	tools/mutants.py $(LUXEL)

format:
	$(SOURCES) | xargs -0 clang-format -i

format-check: setup
	$(SOURCES) | xargs -0 clang-format --dry-run -Werror

clean:
	rm -rf build baked
