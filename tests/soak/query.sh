#!/usr/bin/env bash
# Questions for long: two thousand of each border to real terrain, each answer laid over every sample, then eight threads
# that ask at random for ten minutes under the thread sanitizer and must get what one thread gets.
#
#   tests/soak/query.sh TALUS [SECONDS]     600, unless said otherwise
#
# The first part needs TALUS_DEM_DIR and is skipped without it.
set -euo pipefail

seconds=${2:-600}
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."

echo "== questions to real terrain"
TALUS_PROPERTY_CASES=${TALUS_PROPERTY_CASES:-40000} build/release/tests/test_property --gtest_filter='*RealQuestions*'

echo "== eight threads for $seconds s under the thread sanitizer"
./dev build tsan test_query
around=()
if setarch -R true 2>/dev/null; then around=(setarch -R); fi
TALUS_SOAK_SECONDS=$seconds TSAN_OPTIONS="suppressions=$PWD/tests/tsan.supp halt_on_error=1" \
  "${around[@]}" build/tsan/tests/test_query --gtest_filter='Threads.Eight*'
