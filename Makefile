# The front door. Each target does all the set-up that it needs; a second run does no work twice.
#   NO_INSTALL=1   print the missing Debian packages and stop
SHELL := /bin/sh
BUILD := build/vtk
JOBS ?= $(shell nproc)
PYTHON = $(shell dpkg -L python3-minimal 2>/dev/null | grep 'bin/python3$$' | head -n 1)
SITE = $(shell find $(CURDIR)/$(BUILD) -path '*/chiaroscuro/__init__.py' -printf '%h/..' -quit 2>/dev/null)
# -noreset: the server outlives its first client, so that several can follow each other
DISPLAYED = xvfb-run -a -s "-screen 0 1280x1024x24 -noreset"
CTEST = ctest --output-on-failure --no-tests=error

.PHONY: help demo test bench paraview build sanitize data packages clean

help:
	@echo "make demo      pictures of a brain with fibres, with and without occlusion, in build/demo"
	@echo "make test      all tests: core, C++, Python, ParaView; the core once more with sanitizers"
	@echo "make bench     run time against error as CSV and PNG in build/bench"
	@echo "make paraview  build the ParaView plugin and say how to load it"
	@echo "make clean     remove the build directory"

packages:
	@sh CMake/install_packages.sh

$(BUILD)/build.ninja: CMakePresets.json | packages
	cmake --preset vtk -DCHIAROSCURO_BUILD_PARAVIEW=ON \
	  -DVTK_DIR="$$(dirname "$$(dpkg -L paraview-dev | grep '/vtk-config.cmake$$')")" >/dev/null

build: packages
	@$(MAKE) --no-print-directory $(BUILD)/build.ninja
	cmake --build $(BUILD) -j $(JOBS)

sanitize: packages
	cmake --preset sanitize >/dev/null
	cmake --build build/sanitize -j $(JOBS)

data: packages
	@sh CMake/fetch_data.sh build/data

demo: build data
	@mkdir -p build/demo
	PYTHONPATH=$(SITE) $(DISPLAYED) $(PYTHON) Examples/Python/demo.py build/data build/demo

test: build sanitize data
	cd build/sanitize && $(CTEST) -j $(JOBS)
	cd $(BUILD) && $(DISPLAYED) $(CTEST) -j 2

bench: build data
	@mkdir -p build/bench
	PYTHONPATH=$(SITE) $(DISPLAYED) $(PYTHON) Testing/Benchmarks/run.py $(BUILD) build/data build/bench

paraview: build
	@find $(CURDIR)/$(BUILD) -name 'Chiaroscuro.so' -printf 'load it in ParaView (Tools, Manage Plugins) or pvbatch: %p\n'

clean:
	rm -rf build
