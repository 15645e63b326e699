#!/bin/sh
# abi.sh SOURCE check|write: compares the binary interface of libobsim, its functions and the types in installed headers,
# with that kept in libobsim.abi; or keeps that of now. Skipped without Debian's abigail-tools. Builds the library with
# debugging information, from which types are read.
set -eu
source=$1 kept=$1/tests/library/libobsim.abi
command -v abidiff >/dev/null || exit 77
build=$(mktemp -d)
trap 'rm -rf "$build"' EXIT

meson setup "$build" "$source" -Dbuildtype=debug -Doptimization=1 -Dtests=false -Dbench=false -Dlto=false >"$build/log" &&
	meson compile -C "$build" obsim:shared_library >>"$build/log" || { tail -n 20 "$build/log"; exit 1; }
now=$build/libobsim.abi
abidw --drop-private-types --headers-dir "$source/include/ob" --exported-interfaces-only --short-locs --no-parameter-names \
	--no-comp-dir-path --no-corpus-path --out-file "$now" "$build/include/ob/libobsim.so"
if [ "$2" = write ]; then
	cp "$now" "$kept"
	exit
fi
abidiff --no-show-locs "$kept" "$now" || {
	echo "The interface differs from tests/library/libobsim.abi. Additions: name them in include/ob/libobsim.map, then"
	echo "tests/library/abi.sh . write. All else breaks programs that are installed: it needs another soname."
	exit 1
}
