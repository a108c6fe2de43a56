#!/usr/bin/env bash
# The kernels of every set of instructions against the plain loops: numbers of dense pages of all widths, errors in eighths,
# selected bits and gathered heights, more than 10^9 samples each; damaged numbers, and triangulation by words. About half
# an hour.
#
#   tests/soak/kernels.sh
set -euo pipefail

cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."
test=build/release/tests/test_engine
TALUS_PROPERTY_CASES=1600000 $test --gtest_filter='Eighths.*'
TALUS_PROPERTY_CASES=1100000 $test --gtest_filter='DenseNumbersOf*WhatIsStored*'
TALUS_PROPERTY_CASES=20000 $test --gtest_filter='DenseNumbersOf*Damaged*:TriangulationByWords.*'
