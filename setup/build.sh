# SPDX-License-Identifier: Apache-2.0
# Sourced after setup/install.sh: builds the parts, each only if it has changed.

export CCACHE_SLOPPINESS=pch_defines,time_macros  # otherwise ccache skips files that use a precompiled header

# build_target PRESET TARGET...: configures the preset if needed and builds the targets.
build_target() {
    local preset=$1 folder=build/$1
    shift
    if [ ! -e "$folder/build.ninja" ] || [ CMakePresets.json -nt "$folder/build.ninja" ]; then
        mkdir -p "$folder"
        cmake --preset "$preset" >"$folder/configure.log" 2>&1 || { tail -n 25 "$folder/configure.log" >&2; say "cmake failed for preset $preset"; return 1; }
        touch "$folder/build.ninja"
    fi
    cmake --build --preset "$preset" --target "$@" >&2 || { say "the build of $* ($preset) failed"; return 1; }
}

# One line that identifies the console's sources: a hash of their names, sizes and times.
console_sources() {
    find web schema -name node_modules -prune -o -path web/dist -prune -o -path web/src/gen -prune -o -type f -printf '%p %s %T@\n' |
        LC_ALL=C sort | sha256sum
}

# Builds the console into web/dist.
build_console() {
    local stamp=build/console.stamp
    [ -d web/node_modules ] || stop "web/ has no node_modules: need_node and npm_ci come first"
    [ -e web/dist/index.html ] && [ "$(cat $stamp 2>/dev/null)" = "$(console_sources)" ] && return
    say "building the console"
    mkdir -p build
    (cd web && npm run --silent build </dev/null >&2) || { say "the build of the console failed"; return 1; }
    console_sources >$stamp
}

# test_names PROGRAM [Catch2 arguments]: prints the names of these tests, one a line, for --input-file. Catch2 2 and 3
# have different options for it.
test_names() {
    local program=$1 option=(--list-tests --verbosity quiet)
    shift
    "$program" --libidentify | grep -q '^version: *2\.' && option=(--list-test-names-only)
    "$program" "${option[@]}" "$@" </dev/null
}
