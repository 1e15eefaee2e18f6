#!/bin/sh
# Builds with options that would change bits are refused, at compile time or when a world is created. The script also proves
# that it accepts good options, and that it notices a missing probe.
#
#   refused.sh quick ROOT CONFIG FILES VARIANTS PROGRAM ARCHIVE COMPILER...
#                                                             tests the files that must not compile, and only the probe with
#                                                             every option
#   refused.sh whole ROOT CONFIG FILES VARIANTS PROGRAM ARCHIVE COMPILER...
#                                                             also compiles all code that feeds the state, with all options
#                                                             that the probe accepts: the hash must be the same. A build that
#                                                             the probe refuses must not create a world. Only with
#                                                             optimisation and as many options at a time as the probe accepts,
#                                                             because each of these builds takes long
#
# ROOT: the sources. CONFIG: the folder of rheolog/config.h. FILES: the files below ROOT that are compiled for each SIMD variant.
# VARIANTS: the options of each variant, separated by semicolons. PROGRAM: tells the variant that runs on this machine. ARCHIVE: the
# objects of the state, which give a whole build the other variants, because these do not run in it. Options unknown to the compiler
# are skipped. Only the compiler gets the options; fast_math_program.c tests what the linker adds for them.
set -eu
mode=$1 root=$2 config=$3 files_of_variants=" $4 " variants=$5 archive=$7
running=$("$6" --version | sed -n 's/^simd: .*(in use: \(.*\))$/\1/p')
shift 7
[ -n "$running" ] || { echo "the program does not tell its SIMD variant" && exit 1; }
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

# objects FILE: prints the options of each compilation of a file, one line each; only those of the variant $only, if it is set.
only=
objects() {
    case $files_of_variants in
    *" ${1#"$root"/} "*) echo "$variants" | tr ';' '\n' | grep -e "-DRHEO__SIMD_VARIANT=${only:-[a-z0-9]*}\( \|\$\)" ;;
    *) echo "$variants" | grep -o -m 1 -e '-DRHEO__[A-Z0-9]*_VARIANTS' -e '-DRHEO__SCALAR_ALONE' | head -n 1 | grep . || echo ;;
    esac
}

# does_not_compile TEXT FILE COMPILER...: the compiler must refuse the file with this text in its error.
does_not_compile() {
    text=$1 file=$2
    shift 2
    checks=$((checks + 1))
    if "$@" $usual $includes $options $(objects "$file" | head -n 1) -Wfatal-errors -fsyntax-only "$file" >"$tmp/log" 2>&1; then
        wrong "$file compiles with $options"
    elif ! grep -q "error.*$text" "$tmp/log"; then
        wrong "$file does not compile with $options, but not because of \"$text\""
    fi
}

# Prints the verdict on a build: "compile: ...", "refused: ..." or "fit: ...". All files get the options, the linker does not.
verdict() {
    files=$1
    shift
    rm -rf "$tmp/o"
    mkdir "$tmp/o"
    for file in $files "$root/tests/refused_program.c"; do
        objects "$file" | while read -r variant; do
            echo "$options $variant -c $file -o $tmp/o/$(echo "${file#"$root"/}$variant" | tr '/ ' __).o"
        done
    done >"$tmp/units"
    # All processors compile: this is most of the time of this script.
    if ! xargs -P "$(nproc)" -L 1 "$@" $usual $includes <"$tmp/units" >"$tmp/log" 2>&1; then
        echo "compile: $(grep -o 'error.*rheolog.*' "$tmp/log" | head -n 1)"
        return
    fi
    # shellcheck disable=SC2086
    "$@" "$tmp"/o/*.o ${only:+"$archive"} -o "$tmp/program" -lm && { "$tmp/program" || true; }
}
environment="$root/src/core/environment.c"
probe() { verdict "$environment $root/src/core/error.c $root/src/core/text.c $root/src/core/simd.c $root/src/core/probe.c" "$@" -DPROBE_ALONE; }
whole() {
    only=$running
    verdict "$environment $(find $state -name '*.c' ! -name environment.c | sort)" "$@"
    only=
}

# Options that let a compiler contract a * b + c. Most machines other than x86 contract by default.
machine= contracting=
if is __x86_64__ || is __i386__; then
    ! grep -qw fma /proc/cpuinfo || machine=-mfma contracting=yes
elif is __aarch64__ || is __powerpc64__ || is __s390x__ || is __riscv_flen; then
    contracting=yes
fi
[ -n "$contracting" ] || echo "this machine has no FMA: contraction is not tested"

# All options that may change bits, one set per line. Each is tested with and without optimisation, because compilers then
# apply them in different places.
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

# Prints the expected words of the refusal of a known case.
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
    # Every file that calculates refuses -ffast-math by itself, so that options for single files are noticed too.
    options=-ffast-math
    for file in $(find $state "$root/src/scenes" -name '*.c' | sort); do
        case $file in
        */environment.c | */error.c | */memory.c | */simd.c | */text.c | */words.c) ;;
        */scenes/arrays.c | */scenes/letters.c | */scenes/mesh_file.c | */scenes/parameters.c) ;; # do not calculate
        *) does_not_compile 'with -ffast-math or -Ofast' "$file" "$@" ;;
        esac
    done
    # 32-bit x86: x87 registers are wider than the number types.
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

# The usual options must be accepted, which also proves that the script does not refuse everything.
options=-O2
fit=$(probe "$@")
case $fit in "fit: "*) ;; *) wrong "$options: $fit" ;; esac
if [ $mode = whole ]; then
    hash=$(whole "$@")
    echo "$options: $hash"
    case $hash in "fit: "*) ;; *) wrong "$options: $hash" ;; esac
fi

: >"$tmp/accepted"
# judge COMPILER...: checks that $options are refused if they must be, and otherwise adds them to the accepted ones.
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
        echo "$options" >>"$tmp/accepted"
        ;;
    *) wrong "$options: $found" ;;
    esac
}

sets >"$tmp/sets"
levels='-O0 -O2'
[ $mode = quick ] || levels=-O2
while read -r set; do
    if ! knows "$@" $set; then
        left_out="$left_out [$set]"
        continue
    fi
    for level in $levels; do
        options="$level $set"
        judge "$@"
    done
done <"$tmp/sets"

# change_nothing COMPILER...: checks that a whole build with $combined, if there are any, has the usual bits.
change_nothing() {
    [ -n "$combined" ] || return 0
    options=$combined
    found=$(whole "$@")
    echo "$options: $found"
    [ "$found" = "$hash" ] || wrong "$options changes bits and is not refused: $found"
}
if [ $mode = whole ]; then
    combined=
    while read -r accepted; do
        options="${combined:+$combined }$accepted"
        case $options in
        *-ffp-contract=*-ffp-contract=*) together="one of them has no effect" ;;
        *) together=$(probe "$@") ;;
        esac
        if [ "$together" = "$fit" ]; then
            combined=$options
        else
            change_nothing "$@"
            combined=$accepted
        fi
    done <"$tmp/accepted"
    change_nothing "$@"
fi

if [ -n "$contracting" ]; then
    options="-O2 -ffp-contract=fast $machine"
    # Without a probe, the script must notice that nothing is refused.
    printf '#include "core/environment.h"\nrheo_result rheo__check_environment(rheo_error *e) { (void)e; return RHEO_OK; }\n' >"$tmp/blind.c"
    (
        environment=$tmp/blind.c failed=0
        judge "$@" >"$tmp/log.blind"
        [ $failed = 1 ]
    ) || wrong "a missing probe is not noticed: $(cat "$tmp/log.blind")"
    # Such a build must not create a world. Without a probe, its bits differ.
    if [ $mode = whole ]; then
        found=$(whole "$@")
        echo "$options: $found"
        case $found in "refused: this build contracts"*) ;; *) wrong "$options: $found" ;; esac
        rm -f "$tmp"/o/*environment.c*
        "$@" $usual $includes $options $(objects "$environment") -c "$tmp/blind.c" -o "$tmp/o/blind.o"
        found=$("$@" "$tmp"/o/*.o "$archive" -o "$tmp/program" -lm && "$tmp/program") || true
        echo "$options without a probe: $found"
        case $found in "$hash") wrong "$options changes no bits" ;; "fit: "*) ;; *) wrong "$options without a probe: $found" ;; esac
    fi
fi

[ -z "$left_out" ] || echo "unknown to this compiler:$left_out"
[ $failed = 0 ] || { echo "refused: $failed of $checks checks failed"; exit 1; }
echo "refused: $checks builds checked"
