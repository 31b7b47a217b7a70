# Thin: the real rules are Meson's. Each target installs what it misses (Debian, Ubuntu), configures and builds.
PREFIX ?= /usr/local

.PHONY: help demo build check asan install clean deps deps-check

help:
	@echo "make demo     build, and draw the built-in city by night: night.png"
	@echo "make build    build build/nocturne"
	@echo "make check    build, and run all tests"
	@echo "make asan     the tests again under AddressSanitizer and UBSan"
	@echo "make install  install to PREFIX ($(PREFIX)), DESTDIR respected"
	@echo "make clean    remove what was built"

deps:
	@tools/install-deps.sh build
deps-check:
	@tools/install-deps.sh check

build: deps
	@[ -e build/build.ninja ] || meson setup build --prefix $(PREFIX) >/dev/null
	@ninja -C build --quiet nocturne

demo: build
	@build/nocturne render builtin:city -o night.png
	@echo
	@echo "Try next"
	@echo "  build/nocturne render builtin:city --view aerial --size 1920x1080 -o aerial.png"
	@echo "  build/nocturne render builtin:city --city-seed 7 --city-lit 0.6 -o other.png"
	@echo "  build/nocturne render CITY.gml LAMPS.geojson -o city.png    (where to get them: docs/formats.md)"
	@echo "  build/nocturne help render"

check: deps-check
	@[ -e build/build.ninja ] || meson setup build --prefix $(PREFIX) >/dev/null
	@[ -e build/.tests ] || { meson configure build -Dtests=enabled && touch build/.tests; }
	@ninja -C build --quiet
	@tools/run-tests.sh build

asan: deps-check
	@[ -e build-asan/build.ninja ] || meson setup build-asan -Db_sanitize=address,undefined -Dbuildtype=debugoptimized \
		-Dbench=false -Dtests=enabled >/dev/null
	@ninja -C build-asan --quiet
	@tools/run-tests.sh build-asan --timeout-multiplier 4

install: build
	@meson install -C build

clean:
	rm -rf build build-asan night.png
