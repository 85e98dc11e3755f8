#!/bin/sh
# The exported names of the library $1 are exactly the committed list $2.
exported=$(nm -D --defined-only "$1" | awk '{print $3}' | grep -v '^_' | LC_ALL=C sort)
wanted=$(LC_ALL=C sort "$2")
if [ "$exported" != "$wanted" ]; then
  echo "exported names differ from $2 (< committed, > exported):"
  printf '%s\n' "$wanted" > "${TMPDIR:-/tmp}/chi_wanted.$$"
  printf '%s\n' "$exported" | diff "${TMPDIR:-/tmp}/chi_wanted.$$" -
  rm -f "${TMPDIR:-/tmp}/chi_wanted.$$"
  exit 1
fi
