#!/bin/sh
# compare_builds.sh COMMIT|BUILD: compares what this checkout and COMMIT write, byte for byte. COMMIT is built in
# build/compare; BUILD is the build folder of another checkout. Both make creatures, compiled files and poses of each
# character (CHARACTERS; default ../shared/characters), pictures, a film, and the examples' output about events and
# sockets. Prints the differences, and fails if there are any.
set -eu
[ $# -eq 1 ] || { echo "usage: tests/compare_builds.sh COMMIT|BUILD" >&2; exit 2; }
old=$(realpath -- "$1" 2>/dev/null || true)
cd "$(dirname "$0")/.."
here=$PWD
work=$here/build/compare
characters=${CHARACTERS:-$here/../shared/characters}

build() { cmake --preset release >/dev/null && cmake --build build/release --target throng_tool state_machine; }

rm -rf "$work/old" "$work/new"
mkdir -p "$work/old" "$work/new"
if [ "$old" = "$here/build/release" ]; then
  echo "compare_builds.sh: '$1' is this checkout's own build; give that of another checkout" >&2
  exit 2
fi
if [ ! -x "$old/tools/throng" ]; then
  commit=$(git rev-parse --verify --quiet "$1^{commit}") ||
    { echo "compare_builds.sh: '$1' is neither a commit nor the folder of a build" >&2; exit 2; }
  if [ ! -e "$work/source/.git" ]; then
    rm -rf "$work/source"
    git worktree prune
    git worktree add --quiet --detach "$work/source" "$commit"
  fi
  (cd "$work/source" && git checkout --quiet --detach "$commit" && build)
  old=$work/source/build/release
fi
build

# write SIDE BUILD
write() {
  tool=$2/tools/throng
  examples=$2/examples
  cd "$work/$1"
  for kind in dragon willow walker centipede; do "$tool" generate $kind --out $kind.glb >/dev/null; done
  find "$characters" -name '*.glb' -o -name '*.gltf' | sort | while read -r file; do
    name=$(basename "$file")
    "$tool" compile "$file" -o "$name.throng" >/dev/null 2>&1 || true
    "$tool" compile "$file" --error exact -o "$name.exact.throng" >/dev/null 2>&1 || true
    for more in "" --reference; do
      "$tool" pose "$file" --clip 0 --time 0.3 --json $more >"$name.pose$more.json" 2>/dev/null || true
    done
  done
  controllers=$here/examples/controllers
  "$tool" render dragon.glb willow.glb walker.glb --sizes 5,9,1.8 --counts 30,12,400 --placement disc \
    --controller dragon.glb=$controllers/dragon.json --controller willow.glb=$controllers/willow.json \
    --controller walker.glb=$controllers/walker_run.json --eye 0,16,60 --target 0,0,30 --size 640x360 --time 1 \
    --seed 1 --out crowd.png >/dev/null
  "$tool" render walker.glb --count 60 --everything --scan subgroup --out everything.png --size 320x200 >/dev/null
  mkdir film
  "$tool" render walker.glb --count 30 --steer --spacing 2.5 --controller $controllers/walker_steer.json \
    --size 160x90 --frames 0:8 --out film/f_%04d.png >/dev/null
  "$examples/state_machine" dragon.glb $controllers/guard.json guard.png >guard.txt
}
write old "$old"
write new "$here/build/release"
cd "$work"
if diff -rq old new; then echo "$(find new -type f | wc -l) files are the same"; else exit 1; fi
