# shellcheck shell=bash
# How the scripts speak and fail, and what they need of the machine.

# shellcheck disable=SC2034 # used where this is sourced
PACKAGING_CACHE=${IRHORIZON_CACHE:-${XDG_CACHE_HOME:-${HOME:?HOME or IRHORIZON_CACHE must be set}/.cache}/irhorizon}/packaging

# What the caller sees on stdout is data; all the rest goes to stderr.
say() { printf 'build: %s\n' "$*" >&2; }
die() { printf 'build: error: %s\n' "$*" >&2; exit 1; }

# Run a command quietly; show what it said only if it failed.
quietly() {
    local log status=0
    log=$(mktemp)
    "$@" >"$log" 2>&1 || status=$?
    [ "$status" = 0 ] || tail -n 40 "$log" >&2
    rm -f "$log"
    return "$status"
}

missing=()
# need COMMAND PACKAGE: the package is installed by install_missing, if the command is not there.
need() { command -v "$1" >/dev/null || missing+=("$2"); }

install_missing() {
    [ ${#missing[@]} -gt 0 ] || return 0
    local sudo=()
    [ "$(id -u)" = 0 ] || sudo=(sudo -n)
    say "installing ${missing[*]}"
    export DEBIAN_FRONTEND=noninteractive
    quietly "${sudo[@]}" apt-get update || say "apt-get update failed, going on with what apt knows"
    quietly "${sudo[@]}" apt-get -o DPkg::Lock::Timeout=600 install -qy --no-install-recommends "${missing[@]}" ||
        die "missing: ${missing[*]}; as root run: apt-get install --no-install-recommends ${missing[*]}"
    missing=()
}
