#!/bin/sh
# on_vulkan.sh PROGRAM SUITE: tests whose views render on Vulkan. Skipped where no device traces rays.
set -u
if ! "$NOC_PROGRAM" devices | grep '^vulkan [0-9]' | grep -qv 'not usable'; then
    echo "1..0 # SKIP no Vulkan device traces rays here"
    exit 0
fi
NOC_TEST_BACKEND=vulkan exec "$@"
