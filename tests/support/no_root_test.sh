#!/usr/bin/env bash
# Without root and without packages, both entry scripts end with 2 and name every package to ask for.
# no_root_test.sh PROJECT EMPTY_FOLDER
set -euo pipefail
project=$1 fake=$2
rm -rf "$fake"
mkdir -p "$fake"
for tool in bash env dirname grep; do ln -s "$(command -v "$tool")" "$fake/$tool"; done
printf '#!/bin/sh\nexit 1\n' > "$fake/dpkg-query"   # nothing is installed
printf '#!/bin/sh\necho 1000\n' > "$fake/id"        # not root; there is no sudo in this PATH
chmod +x "$fake/dpkg-query" "$fake/id"
source "$project/tests/support/build.sh"
for script in tests/run pipelines/quickstart; do
  code=0
  said=$(PATH=$fake "$project/$script" 2>&1) || code=$?
  wanted=("${packages_build[@]}")
  [ "$script" = tests/run ] && wanted+=("${packages_test[@]}")
  expected="These Debian packages are missing; ask whoever administers this machine to install them:
  apt-get install ${wanted[*]}"
  if [ "$code" -ne 2 ] || [ "$said" != "$expected" ]; then
    printf '%s ended with %s and said\n%s\n' "$script" "$code" "$said"
    exit 1
  fi
done
