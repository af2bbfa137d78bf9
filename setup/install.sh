# SPDX-License-Identifier: Apache-2.0
# Sourced by ./run, ./test, .ci/run and bench/run: installs their packages, as root or with sudo, and removes nothing.
# Checking installed packages takes a fraction of a second. Each function ends the script with 2 if it fails.

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root" || exit 2
say() { printf 'aeolis: %s\n' "$*" >&2; }
stop() { say "$@"; exit 2; }

# Prints the number of the Debian release, or nothing on other systems.
debian_release() (
    ID='' VERSION_ID=''
    [ -r /etc/os-release ] && . /etc/os-release
    if [ "$ID" = debian ]; then echo "$VERSION_ID"; fi
)

# packages_for RELEASE KIND...: prints the packages of these kinds (run, test, check, node, unpacked) on that release.
packages_for() {
    local release=$1
    shift
    awk -F'|' -v kinds=" $* " -v release="$release" '!/^#/ && NF >= 4 {
        gsub(/ /, "", $1); gsub(/ /, "", $2)
        split($1, name, "@")
        if (index(kinds, " " $2 " ") && (name[2] == "" || name[2] == release)) print name[1]
    }' setup/debian-packages.txt
}

is_installed() { [ "$(dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null)" = installed ]; }

# need_packages KIND...: installs the missing packages of these kinds. Outside Debian 12 and 13 it only names them.
need_packages() {
    local missing=() package as_root=() release
    release=$(debian_release)
    if [ "$release" != 12 ] && [ "$release" != 13 ]; then
        say "not Debian 12 or 13, so install by hand, under your system's names (or see Containerfile): $(packages_for 13 "$@" | xargs)"
        return
    fi
    for package in $(packages_for "$release" "$@"); do is_installed "$package" || missing+=("$package"); done
    [ ${#missing[@]} -eq 0 ] && return
    if [[ " ${missing[*]} " == *" libboost1.81-dev "* ]] && is_installed libboost1.74-dev; then
        stop "Debian allows one Boost's headers at a time: libboost1.74-dev is installed, Aeolis needs libboost1.81-dev." \
             "We remove nothing: when you can do without it, 'apt-get remove libboost1.74-dev' and start again."
    fi
    if [ "$(id -u)" -ne 0 ]; then
        if command -v sudo >/dev/null && { sudo -n true 2>/dev/null || { [ -t 0 ] && sudo -v; }; }; then
            as_root=(sudo)
        else
            say "these Debian packages are missing, and installing them takes root or sudo. As root:"
            printf '  apt-get update && apt-get install --no-remove --no-install-recommends %s\n' "${missing[*]}" >&2
            exit 2
        fi
    fi
    say "installing ${#missing[@]} Debian packages: ${missing[*]}"
    local apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -o Dpkg::Use-Pty=0 -o DPkg::Lock::Timeout=300)
    mkdir -p build
    { "${apt[@]}" update && "${apt[@]}" install -y --no-remove --no-install-recommends "${missing[@]}"; } >build/apt.log 2>&1 </dev/null || {
        tail -n 20 build/apt.log >&2
        stop "apt-get could not install: ${missing[*]} (whole output in build/apt.log; where it says 'remove is disabled', a package of yours conflicts)"
    }
}

# need_unpacked PACKAGE: has Debian's package of a program in build/PACKAGE without installing it, so that no service
# begins.
need_unpacked() {
    local folder=$root/build/$1 as_root=()
    [ -e "$folder/unpacked" ] && return
    if ! command -v apt-get >/dev/null || ! command -v dpkg-deb >/dev/null; then
        say "$1 is not unpacked, because this is no Debian: the tests that start it are skipped"
        return
    fi
    rm -rf "$folder" && mkdir -p "$folder"
    say "unpacking $1 into build/$1"
    fetch() { (cd "$folder" && apt-get -qq download "$1" && dpkg-deb -x "$1"_*.deb .) >>"$root/build/apt.log" 2>&1; }
    if ! fetch "$1"; then
        if [ "$(id -u)" -ne 0 ]; then as_root=(sudo -n); fi
        "${as_root[@]}" apt-get -qq update >>"$root/build/apt.log" 2>&1
        fetch "$1" || stop "apt-get could not download $1 (output in build/apt.log)"
    fi
    touch "$folder/unpacked"
}

node_is_new_enough() {
    command -v node >/dev/null && command -v npm >/dev/null || return 1
    node -e 'const [major, minor] = process.versions.node.split(".").map(Number); process.exit(major > 20 || (major === 20 && minor >= 19) ? 0 : 1)'
}

# npm_ci FOLDER: installs node_modules by the folder's lock file, unless they are newer than that file.
npm_ci() {
    local stamp=$1/node_modules/.aeolis-installed
    [ -e "$stamp" ] && [ "$stamp" -nt "$1/package-lock.json" ] && return
    [ -e "$1/package-lock.json" ] || stop "$1/package-lock.json is missing: the npm packages are pinned there"
    say "installing the npm packages of $1"
    (cd "$1" && npm ci --no-audit --no-fund --loglevel=error --prefer-offline </dev/null >&2) || stop "npm ci failed in $1"
    touch "$stamp"
}

# need_node: provides a Node that the web build accepts: the system's, Debian 13's, or the one pinned by setup/node
# (Debian 12 has Node 18).
need_node() {
    node_is_new_enough && return
    need_packages node
    node_is_new_enough && return
    local pinned=$root/setup/node/node_modules/.bin
    if [ ! -x "$pinned/node" ] || [ setup/node/package-lock.json -nt setup/node/node_modules/.aeolis-installed ]; then
        [ "$(uname -m)" = x86_64 ] || stop "the pinned Node is for x86_64; install Node >= 20.19 with npm, then start again"
        npm_ci setup/node
    fi
    PATH=$pinned:$PATH
    hash -r
    node_is_new_enough || stop "the Node of setup/node does not start: $("$pinned/node" --version 2>&1)"
}
