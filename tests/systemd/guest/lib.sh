# shellcheck shell=bash
# What the checks are made of: running them, waiting, asking the daemon.

STATE=/var/lib/checks
passed=0 failed=0

# check NAME: runs the function of that name; what it prints is what was seen.
check() {
	local name=$1 begin=$EPOCHREALTIME log=$STATE/log status
	PACE=$(pace)
	# Not with || behind it: that would switch -e off inside.
	(set -euo pipefail; "$name") >"$log" 2>&1
	status=$?
	if [ "$status" = 0 ]; then
		passed=$((passed + 1))
		echo "test systemd::$name ... ok ($(since "$begin") s in all)"
	else
		failed=$((failed + 1))
		echo "test systemd::$name ... FAILED (status $status)"
		systemctl --no-pager --lines=0 status irhorizond >>"$log" 2>&1 || true
		journalctl -u irhorizond -o cat -n 20 --no-pager >>"$log" 2>&1 || true
	fi
	sed 's/^/    /' "$log"
}

# Seconds since an EPOCHREALTIME, to the hundredth.
since() {
	local us=$((${EPOCHREALTIME/[.,]/} - ${1/[.,]/}))
	printf '%d.%02d' $((us / 1000000)) $((us % 1000000 / 10000))
}

# How many times slower than a real machine the guest is, by a call over D-Bus that takes one 0.1 s:
# emulation on a busy host is. Limits below are the real ones times this.
pace() {
	local begin=$EPOCHREALTIME _
	for _ in 1 2 3 4 5; do
		nobody busctl --timeout=30 call org.freedesktop.DBus /org/freedesktop/DBus org.freedesktop.DBus GetId >/dev/null
	done
	awk -v took="$(since "$begin")" 'BEGIN { pace = took / 0.5; printf "%.1f\n", pace < 1 ? 1 : pace }'
}

# soon SECONDS WHAT COMMAND…: as within, at the guest's pace.
soon() {
	echo "limit $1 s, at this guest's pace: times $PACE"
	within "$(awk -v s="$1" -v pace="$PACE" 'BEGIN { print int(s * pace + 0.99) }')" "${@:2}"
}

# within SECONDS WHAT COMMAND…: waits until the command succeeds, says how long that took.
within() {
	local limit=$1 what=$2 begin=$EPOCHREALTIME took
	shift 2
	until "$@" >/dev/null 2>&1; do
		took=$(since "$begin")
		if [ "${took%.*}" -ge "$limit" ]; then
			echo "$what: not within $limit s"
			return 1
		fi
	done
	took=$(since "$begin")
	echo "$what after $took s"
	# It may have come true while the last try was made.
	awk -v took="$took" -v limit="$limit" 'BEGIN { exit !(took <= limit) }' ||
		{ echo "that is later than $limit s"; return 1; }
}

# refuted COMMAND…: the command must fail; says what it said.
refuted() {
	local said
	if said=$("$@" 2>&1); then
		echo "this should have failed: $*"
		return 1
	fi
	echo "refused: ${said##*$'\n'}"
}

nobody() { setpriv --reuid=nobody --regid=nogroup --clear-groups "$@"; }
member() { setpriv --reuid=pilot --regid=pilot --init-groups "$@"; }

NAME='org.irhorizon1 /org/irhorizon1'
# horizon PROPERTY…: as an unprivileged user sees them, a line each.
# shellcheck disable=SC2086 # NAME is two words
horizon() { nobody busctl --timeout=2 get-property $NAME org.irhorizon1.Horizon "$@"; }
# shellcheck disable=SC2086
reload() { "$@" busctl --timeout=15 call $NAME org.irhorizon1.Control Reload; }

# attitude [ROLL]: whether one is given, and whether roll is that, to 3°.
attitude() {
	horizon Mode RollDeg PitchDeg |
		awk -v want="${1:-}" 'NR == 1 { mode = $2 } NR == 2 { roll = $2 } NR == 3 { pitch = $2 }
			END { good = mode ~ /nominal|degraded/ && roll == roll + 0 && pitch == pitch + 0
				if (want != "") good = good && roll - want < 3 && want - roll < 3
				exit !good }'
}

show() { horizon Mode RollDeg PitchDeg Faults | paste -sd ' '; }
active() { [ "$(systemctl is-active irhorizond)" = active ]; }
main_pid() { systemctl show -P MainPID irhorizond; }
restarts() { systemctl show -P NRestarts irhorizond; }
journal() { journalctl -u irhorizond -o cat --no-pager; }

# Words of the journal since a cursor that `mark` gave.
mark() { journalctl -n 0 --show-cursor | sed -n 's/^-- cursor: //p'; }
journal_since() { journalctl --after-cursor="$1" -u irhorizond -o cat --no-pager; }
