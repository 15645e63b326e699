#!/bin/sh
# installed.sh SOURCE BUILD CC..: installs into an empty root, compiles the example against the installed files
# alone, and checks the symbols that the library exports.
set -eu
source=$1 build=$2
shift 2
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT

meson install -C "$build" --no-rebuild --quiet --destdir "$root"
pc=$(find "$root" -name obsim.pc)
export PKG_CONFIG_PATH="${pc%/obsim.pc}" PKG_CONFIG_SYSROOT_DIR="$root"
library=$(find "$root" -name libobsim.so)
# shellcheck disable=SC2046 # words are what pkg-config gives
"$@" "$source/examples/watch.c" $(pkg-config --cflags --libs obsim) -Wl,-rpath,"${library%/*}" -o "$root/watch"

if "$root/watch" no-such-universe 2>"$root/said"; then
	echo "watch found a universe that is not there" && exit 1
fi
grep -q no-such-universe "$root/said" || { echo "watch does not name it: $(cat "$root/said")"; exit 1; }

"$(find "$root" -path '*/bin/obsim')" run stack --duration .02 --json - 2>/dev/null | grep -q "\"$root.*/scenes/stack.lua\"" ||
	{ echo "the installed obsim does not find its scenes"; exit 1; }

nm -D --defined-only "$library" | awk '$2 ~ /[TDBR]/ { sub(/@.*/, "", $3); print $3 }' | sort >"$root/shown"
cat "$source"/include/ob/*.h | grep -o '\bob_[a-z_]*(' | tr -d '(' | sort -u >"$root/declared"
extra=$(comm -23 "$root/shown" "$root/declared")
[ -z "$extra" ] || { echo "libobsim shows what no installed header declares: $extra"; exit 1; }
grep -o '\bob_[a-z_]*;' "$source/include/ob/libobsim.map" | tr -d ';' | sort >"$root/versioned"
missing=$(comm -13 "$root/shown" "$root/versioned")
[ -z "$missing" ] || { echo "libobsim lacks what its map names: $missing"; exit 1; }
