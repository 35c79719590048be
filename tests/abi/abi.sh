#!/bin/sh
# Lists the parts of the ABI that programs compiled against libthrong.so rely on, one per line: the functions that the
# public headers declare, the sizes of the classes they define, and the values of their enumerations. Leaves out
# internal functions, which throng-bench takes from the library, and functions that headers define inline.
#   abi.sh check|update LIBRARY GCC FLAG…     compares abi.txt with it, or writes it
set -eu
action=$1 library=$2 compiler=$3
shift 3
here=$(cd "$(dirname "$0")" && pwd)
include=$(cd "$here/../../include" && pwd)
work=$(mktemp -d)
trap 'rm -r "$work"' EXIT
cd "$work"

# GCC itself lists the classes.
(cd "$include" && ls throng/*.h) | sed 's/.*/#include <&>/' > headers.cpp
"$compiler" -std=c++20 -I"$include" "$@" -fsyntax-only -fdump-lang-class=dump headers.cpp
awk '/^Vtable for throng::/ { vtable = $3 }
  vtable && /entries$/ { print "vtable " vtable ": " $(NF - 1) " entries"; vtable = "" }
  /^Class throng::/ { class = substr($0, 7) }
  class && /^   size=/ { print "class " class ": " $1 " " $2; class = "" }' dump > classes
sed 's|//.*||' "$include"/throng/*.h | tr -s '\n ' ' ' | grep -oE 'enum class [^{;]*\{[^}]*\}' |
  sed 's/, }$/ }/' > enums

# Public symbols are members of these classes and functions that headers declare. Only strong symbols count: whether the
# library also contains a copy of an inline function is up to the optimiser.
sed -n 's/^class \(.*\): size.*/\1/p' classes > public
sed -nE 's/^[A-Za-z][^(]* ([a-z][a-z_0-9]*)\(.*/throng::\1/p' "$include"/throng/*.h >> public
nm -D --defined-only --demangle "$library" | sed -nE 's/^[0-9a-f]+ [TDBR] (throng::.*)/\1/p' |
  sed -E 's/std::__cxx11::basic_string<char, std::char_traits<char>, std::allocator<char> >/std::string/g
    s/std::basic_string_view<char, std::char_traits<char> >/std::string_view/g
    s/std::filesystem::__cxx11::/std::filesystem::/g
    s/std::vector<([^<>]*), std::allocator<\1 ?> >/std::vector<\1>/g
    s/, 18446744073709551615ul>/>/g' |
  awk 'NR == FNR { public[$0]; next }
    { name = $0; sub(/[[(].*/, "", name); scope = name; sub(/::[^:]*$/, "", scope) }
    name in public || scope in public { print "symbol " $0 }' public - > symbols

LC_ALL=C sort -u classes enums symbols > abi
if [ "$action" = update ]; then
  cp abi "$here/abi.txt"
elif ! diff -U0 "$here/abi.txt" abi; then
  echo "The ABI is not that of tests/abi/abi.txt: lines with + are new, those with - are gone. Within a major version"
  echo "nothing may go (CONTRIBUTING.md, \"Change the ABI\"). Where it is meant: ninja -C build/release update_abi"
  exit 1
fi
