#!/bin/sh
# Builds whose options would change bits are refused: when they are compiled, or else when a world is created. Includes
# the proof that it does not find everything refused, and that it finds what is not: without probes.
#
#   refused.sh quick ROOT CONFIG KERNELS TARGETS COMPILER...   the files that must not compile, and the probe alone with
#                                                              every option
#   refused.sh whole ROOT CONFIG KERNELS TARGETS COMPILER...   with every option that the probe lets pass, the whole of the
#                                                              state's code: it must give the same hash; and one that it
#                                                              does not is not created
#
# ROOT: the sources; CONFIG: the folder that has rheolog/config.h; KERNELS: the files, below ROOT, that are compiled for each
# target; TARGETS: the options of each, with semicolons between. Options that a compiler does not know are left out. Options
# are given to the compiler only: what the linker adds for them is the business of fast_math_program.c.
set -eu
mode=$1 root=$2 config=$3 kernels=" $4 " targets=$5
shift 5
trap 'rm -rf "$tmp"' EXIT
tmp=$(mktemp -d)
failed=0 checks=0 left_out=
state="$root/src/core $root/src/space $root/src/thickening $root/src/melting $root/src/solids $root/src/world"
includes="-I$root/src -I$root/include -I$config"
usual="-std=c17 -ffp-contract=off -fno-math-errno -fno-trapping-math -Wno-psabi"
macros=$("$@" -dM -E -x c /dev/null)
is() { echo "$macros" | grep -q "define $1 "; }
: >"$tmp/empty.c"
knows() { "$@" -Werror -c "$tmp/empty.c" -o "$tmp/empty.o" >/dev/null 2>&1; }
wrong() {
    echo "$1"
    failed=$((failed + 1))
}

# objects FILE: the options of each time that a file is compiled, a line each.
objects() {
    case $kernels in
    *" ${1#"$root"/} "*) echo "$targets" | tr ';' '\n' ;;
    *) echo "$targets" | grep -o -m 1 -e '-DRHEO__[A-Z0-9]*_VARIANTS' -e '-DRHEO__SCALAR_ALONE' | head -n 1 | grep . || echo ;;
    esac
}

# does_not_compile TEXT FILE OPTIONS...: the compiler refuses, and says this.
does_not_compile() {
    text=$1 file=$2
    shift 2
    checks=$((checks + 1))
    if "$@" $usual $includes $options $(objects "$file" | head -n 1) -fsyntax-only "$file" >"$tmp/log" 2>&1; then
        wrong "$file compiles with $options"
    elif ! grep -q "error.*$text" "$tmp/log"; then
        wrong "$file does not compile with $options, but not because of \"$text\""
    fi
}

# The verdict on a build: "compile: ...", "refused: ..." or "fit: ...". The options go to every file, but not to the linker.
verdict() {
    files=$1
    shift
    rm -rf "$tmp/o"
    mkdir "$tmp/o"
    for file in $files "$root/tests/refused_program.c"; do
        objects "$file" >"$tmp/objects"
        while read -r target; do
            if ! "$@" $usual $includes $options $target -c "$file" -o "$tmp/o/$(echo "${file#"$root"/}$target" | tr / _).o" >"$tmp/log" 2>&1; then
                echo "compile: $(grep -o 'error.*rheolog.*' "$tmp/log" | head -n 1)"
                return
            fi
        done <"$tmp/objects"
    done
    "$@" "$tmp"/o/*.o -o "$tmp/program" -lm && { "$tmp/program" || true; }
}
environment="$root/src/core/environment.c"
probe() { verdict "$environment $root/src/core/error.c $root/src/core/simd.c $root/src/core/probe.c" "$@" -DPROBE_ALONE; }
whole() { verdict "$environment $(find $state -name '*.c' ! -name environment.c | sort)" "$@"; }

# Options that let a compiler contract; machines other than x86 mostly contract by default.
machine= contracting=
if is __x86_64__ || is __i386__; then
    ! grep -qw fma /proc/cpuinfo || machine=-mfma contracting=yes
elif is __aarch64__ || is __powerpc64__ || is __s390x__ || is __riscv_flen; then
    contracting=yes
fi
[ -n "$contracting" ] || echo "this machine has no FMA: contraction is not tested"

# All options that may change bits, one set a line. With and without optimisation: compilers act on them at other places.
sets() {
    cat <<END
-ffast-math
-Ofast
-funsafe-math-optimizations
-fassociative-math
-fassociative-math -fno-signed-zeros -fno-trapping-math
-freciprocal-math
-fno-signed-zeros
-ffinite-math-only
-fno-honor-nans
-fno-honor-infinities
-fapprox-func
-fapprox-func -fno-honor-infinities
-mrecip
-fsingle-precision-constant
-frounding-math
-fsignaling-nans
-fexcess-precision=standard
-ffp-contract=fast
-ffp-contract=on
END
    [ -z "$machine" ] || printf '%s\n' "-ffp-contract=fast $machine" "-ffp-contract=on $machine" "-ffp-model=precise $machine" -march=native
}

# The words that known cases are refused with, by their first option.
expected() {
    case "$1" in
    *-Ofast* | *-ffast-math*) echo 'with -ffast-math or -Ofast' ;;
    *-ffinite-math-only*) echo 'with -ffinite-math-only' ;;
    *-funsafe-math-optimizations*) echo '-fassociative-math|-freciprocal-math' ;;
    *"-fassociative-math -fno-signed-zeros"*) echo '-fassociative-math|-fno-signed-zeros' ;;
    *-freciprocal-math*) echo '-freciprocal-math' ;;
    *-fno-signed-zeros*) echo '-fno-signed-zeros' ;;
    *-fsingle-precision-constant*) echo '-fsingle-precision-constant' ;;
    *"-fapprox-func -fno-honor-infinities"*) echo 'approximates square roots' ;;
    *-fno-honor-nans*) echo 'no infinities or NaNs' ;;
    *-O[23]*-ffp-contract=fast*-mfma*) echo 'contracts a \* b \+ c' ;;
    esac
}

if [ $mode = quick ]; then
    # Every file of the state that calculates refuses the worst by itself, so that options for single files are seen too.
    options=-ffast-math
    for file in $(find $state "$root/src/scenes" -name '*.c' | sort); do
        case $file in
        */environment.c | */error.c | */memory.c | */simd.c | */text.c | */words.c) ;;
        */scenes/letters.c | */scenes/mesh_file.c | */scenes/parameters.c) ;; # calculate nothing
        *) does_not_compile 'with -ffast-math or -Ofast' "$file" "$@" ;;
        esac
    done
    # 32-bit x86: arithmetic in x87 registers is wider than the numbers.
    if is __x86_64__ || is __i386__; then
        bits32=
        for compiler in "$*" i686-linux-gnu-gcc; do
            options="-m32 -msse2 -mfpmath=sse"
            if command -v ${compiler%% *} >/dev/null && $compiler $usual $includes $options $(objects "$root/src/core/probe.c" | head -n 1) -fsyntax-only "$root/src/core/probe.c" 2>/dev/null; then
                bits32=$compiler
                for options in "-m32 -msse2 -mfpmath=387" "-m32 -mno-sse" "-m32 -msse2 -mfpmath=both"; do
                    if knows $compiler $options; then
                        does_not_compile 'FLT_EVAL_METHOD 0' "$root/src/core/probe.c" $compiler
                        does_not_compile 'FLT_EVAL_METHOD 0' "$root/src/core/math.c" $compiler
                    fi
                done
                break
            fi
        done
        [ -n "$bits32" ] || echo "no compiler here has headers for 32-bit x86: x87 arithmetic is not tested"
    fi
fi

# The usual options are fit, which also proves that this script does not find everything refused.
options=-O2
fit=$(probe "$@")
case $fit in "fit: "*) ;; *) wrong "$options: $fit" ;; esac
if [ $mode = whole ]; then
    hash=$(whole "$@")
    echo "$options: $hash"
    case $hash in "fit: "*) ;; *) wrong "$options: $hash" ;; esac
fi

# judge COMPILER...: whether $options are refused if they must be, and are harmless if they are not.
judge() {
    found=$(probe "$@")
    words=$(expected "$options")
    checks=$((checks + 1))
    case $found in
    "compile: "* | "refused: "*)
        [ -z "$words" ] || echo "$found" | grep -qE -e "$words" || wrong "$options: $found; expected: $words"
        ;;
    "$fit")
        [ -z "$words" ] || wrong "$options is not refused; expected: $words"
        if [ $mode = whole ]; then
            found=$(whole "$@")
            [ "$found" = "$hash" ] || wrong "$options changes bits and is not refused: $found"
        fi
        ;;
    *) wrong "$options: $found" ;;
    esac
}

sets >"$tmp/sets"
while read -r set; do
    for level in -O0 -O2; do
        options="$level $set"
        if knows "$@" $set; then
            judge "$@"
        elif [ $level = -O0 ]; then
            left_out="$left_out [$set]"
        fi
    done
done <"$tmp/sets"

if [ -n "$contracting" ]; then
    options="-O2 -ffp-contract=fast $machine"
    # A world of such a build is not created.
    if [ $mode = whole ]; then
        found=$(whole "$@")
        echo "$options: $found"
        case $found in "refused: this build contracts"*) ;; *) wrong "$options: $found" ;; esac
    fi
    # With a probe that finds nothing, this script finds that, and that the bits differ.
    printf '#include "core/environment.h"\nrheo_result rheo__check_environment(rheo_error *e) { (void)e; return RHEO_OK; }\n' >"$tmp/blind.c"
    (
        environment=$tmp/blind.c failed=0
        judge "$@" >"$tmp/log.blind"
        [ $failed = $([ $mode = quick ] && echo 1 || echo 2) ]
    ) || wrong "a probe that finds nothing passes: $(cat "$tmp/log.blind")"
fi

[ -z "$left_out" ] || echo "not known to this compiler:$left_out"
[ $failed = 0 ] || { echo "refused: $failed of $checks are not as they should be"; exit 1; }
echo "refused: as it should be ($checks builds)"
