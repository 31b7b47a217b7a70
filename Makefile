# Thin: the real rules are Meson's. Each target installs what it misses (Debian, Ubuntu), configures and builds.
PREFIX ?= /usr/local
# On a terminal ninja keeps to one line; elsewhere it would fill a log.
# `make NINJA='ninja -j1'` is for this file: in the environment Meson takes it for the path of a program.
unexport NINJA
NINJA = ninja $$([ -t 1 ] || echo --quiet)
# Warnings are errors in CI only: users' compilers may know others.
WERROR = false
SANITIZE = -Db_sanitize=address,undefined -Dbuildtype=debugoptimized -Dbench=false

.PHONY: help demo build configured built check gpu-report asan tsan fuzz coverage arm64 format install clean deps deps-check

help:
	@echo "make demo     build, and draw the built-in city by night: night.png"
	@echo "make build    build build/nocturne"
	@echo "make check    build, and run the tests; FULL=1: all of them, with all samples"
	@echo "make gpu-report  tests and times of the Vulkan backend on this machine's GPU: docs/gpu/"
	@echo "make asan     the tests again under AddressSanitizer and UBSan"
	@echo "make tsan     those of them that run threads, under ThreadSanitizer"
	@echo "make fuzz     fuzzers of all that reads bytes, TIME=60 seconds each, with a table (CORPUS=\"pbf csv\" for some of them)"
	@echo "make coverage what share of each room's lines the tests run, and the fuzzers' inputs"
	@echo "make arm64    builds for arm64, and runs some tests of it by qemu"
	@echo "make format   lays out C as clang-format 14 does; make check fails where it would change a file"
	@echo "make install  install to PREFIX ($(PREFIX)), DESTDIR respected"
	@echo "make clean    remove what was built"

deps:
	@tools/install-deps.sh build
deps-check:
	@tools/install-deps.sh check
	@tools/vulkan-driver.sh

build/build.ninja: | deps
	@meson setup build --prefix $(abspath $(PREFIX)) >build.log 2>&1 || { cat build.log; rm -rf build build.log; exit 1; }
	@mv build.log build/setup.log
	@echo "Building ..."

build: deps build/build.ninja
	@$(NINJA) -C build nocturne

demo: build
	@build/nocturne render builtin:city --frames 32 --time 45 -o night.png
	@echo
	@echo "Try next"
	@echo "  build/nocturne render builtin:city --view aerial --size 1920x1080 -o aerial.png"
	@echo "  build/nocturne render builtin:city --city-seed 7 --window-lit 0.6 -o other.png"
	@echo "  build/nocturne render CITY.gml LAMPS.geojson -o city.png    (where to get them: docs/formats.md)"
	@echo "  build/nocturne help render"

# Tests need packages that the program does not: a build folder made without them must look again.
configured: deps-check build/build.ninja
	@[ -e build/.tests-$(WERROR) ] || { rm -f build/.tests-* && \
		meson setup --reconfigure build -Dtests=enabled -Dwerror=$(WERROR) >build/setup.log && touch build/.tests-$(WERROR); }
built: configured
	@$(NINJA) -C build

# The quick suite builds what it runs. TURN=N: a third of the suite `full` beside it, and a third of the statistics with
# all their samples. Whether build.ninja is of this tree is looked at first: the list comes with it.
check: configured
	@$(NINJA) -C build build.ninja
	@$(NINJA) -C build $(if $(FULL),,$$($(if $(TURN),tools/turn-tests.py build - $(TURN) targets,tools/test_targets.py build)))
	@$(if $(FULL),,NOC_SUITE=quick$(if $(TURN),:$(TURN)) )tools/run-tests.sh build \
		$(if $(FULL),,$(if $(TURN),$$(tools/turn-tests.py build - $(TURN)),--no-suite full))

# Under nine minutes; DEVICE=NAME chooses one of several.
gpu-report: built
	@tools/gpu-report.sh

# -O1 and line numbers alone: most of its time goes into compiling. TURN=N: after `make check`, its quick tests and a
# share of the others, and of the programs those alone.
asan: deps-check
	@[ -e build-asan/build.ninja ] || meson setup build-asan $(SANITIZE) -Dwerror=$(WERROR) -Doptimization=1 -Ddebug=false -Dc_args=-g1 -Dtests=enabled >/dev/null
	@$(NINJA) -C build-asan build.ninja
	@$(NINJA) -C build-asan $(if $(TURN),$$(tools/turn-tests.py build-asan build $(TURN) targets))
	@tools/run-tests.sh build-asan --timeout-multiplier 4 $(if $(TURN),$$(tools/turn-tests.py build-asan build $(TURN)))

# The pool, the log, frames, the tables that they share, and what loads a scene.
THREADED = base-test_base base-test_api backend-test_lists backend-test_many light-test_learned render-test_light_stats \
	render-test_shadow render-test_renderer render-test_worlds render-test_views render-test_memory render-test_golden \
	import-test_load import-test_at_once viewer-test_world
tsan: deps-check
	@[ -e build-tsan/build.ninja ] || meson setup build-tsan -Db_sanitize=thread -Dbuildtype=debugoptimized -Dbench=false -Dtests=enabled >/dev/null
	@$(NINJA) -C build-tsan
	@tools/run-tests.sh build-tsan --timeout-multiplier 8 $(THREADED)

TIME = 60
fuzz:
	@tools/install-deps.sh fuzz
	@[ -e build-fuzz/build.ninja ] || CC=clang meson setup build-fuzz -Dfuzz=true $(SANITIZE) -Ddebug=false -Dc_args=-g1 -Dwerror=$(WERROR) -Dexamples=false -Dtests=disabled >/dev/null
	@$(NINJA) -C build-fuzz fuzzers
	@tools/fuzz.sh build-fuzz $(TIME) $(CORPUS)

# Clang's own counters, which cost less than gcov's in many threads; of samples as few as under sanitizers (tests/test.h).
COUNT = -fprofile-instr-generate -fcoverage-mapping
coverage:
	@tools/install-deps.sh coverage
	@[ -e build-coverage/build.ninja ] || LLVM_PROFILE_FILE=/dev/null CC=clang CXX=clang++ meson setup build-coverage -Dc_args='$(COUNT) -DFEW_SAMPLES' -Dcpp_args='$(COUNT)' \
		-Dc_link_args=-fprofile-instr-generate -Dcpp_link_args=-fprofile-instr-generate -Doptimization=1 -Ddebug=false -Db_lundef=false \
		-Dbench=false -Dtests=enabled >/dev/null
	@$(NINJA) -C build-coverage
	@tools/coverage.py build-coverage build-fuzz/corpus

arm64:
	@tools/check-arm64.sh

format:
	@tools/check-format.sh --write

# PREFIX may differ from that of an earlier `make build`. Only what is installed is built, and the list tells what was installed.
INSTALLED = bin/nocturne|nocturne-reader|libnocturne\.so|nocturne\.pc|nocturne\.1|nocturne\.bash|_nocturne|nocturne\.fish
install: deps build/build.ninja
	@meson configure build --prefix $(abspath $(PREFIX))
	@ninja -C build build.ninja >build/setup.log || { cat build/setup.log; exit 1; }
	@ninja -C build -n nocturne pages | grep -q 'no work to do' || $(NINJA) -C build nocturne pages
	@meson install -C build --no-rebuild --quiet
	@echo "Installed, among others:"
	@grep -E '/($(INSTALLED))$$' build/meson-logs/install-log.txt | sed 's/^/  /'

clean:
	rm -rf build build-asan build-tsan build-coverage build-fuzz build-arm64 build-mutants night.png
