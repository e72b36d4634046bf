# shellcheck shell=bash
# Said by every part of the rig: where things lie, how it speaks and fails.

# What the caller sees on stdout is data; all the rest goes to stderr.
say() { printf 'vm: %s\n' "$*" >&2; }
die() { printf 'vm: error: %s\n' "$*" >&2; exit 1; }

# shellcheck disable=SC2034 # used where this is sourced
VM_SRC=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)
# shellcheck disable=SC2034
VM_CACHE=${IRHORIZON_CACHE:-${XDG_CACHE_HOME:-${HOME:?HOME or IRHORIZON_CACHE must be set}/.cache}/irhorizon}/vm

# Run a command up to four times: mirrors and locks fail for a moment.
retry() {
	local try
	for try in 1 2 3 4; do
		"$@" && return
		[ "$try" = 4 ] || { say "failed, trying again: $*"; sleep $((try * 3)); }
	done
	return 1
}

# Run a command quietly; show what it said only if it failed.
quietly() {
	local log
	log=$(mktemp)
	if "$@" >"$log" 2>&1; then
		rm -f "$log"
	else
		tail -n 40 "$log" >&2
		rm -f "$log"
		return 1
	fi
}
