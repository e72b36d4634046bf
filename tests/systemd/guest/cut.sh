# shellcheck shell=bash
# The power is cut while `calibrate` saves: at the end of the first life, looked at in the second.

CUT=$STATE/cut
DROP_INS=$CUT/irhorizon.toml.d

# A daemon parked level in a made-up sky, its head 3° and -2° askew, on a bus of its own; trims of 1° that are the old ones.
cut_the_power() {
	local bus=unix:path=$CUT/bus
	mkdir -p "$DROP_INS"
	printf '[simulation]\nenabled = true\nflight = "parked"\n[dbus]\nbus = "%s"\n' "$bus" >"$CUT/irhorizon.toml"
	printf '[head]\nroll-trim-deg = 1.00\npitch-trim-deg = 1.00\n' >"$DROP_INS/50-trim.toml"
	cat >"$CUT/bus.conf" <<-END
		<busconfig><type>session</type><listen>$bus</listen><auth>EXTERNAL</auth>
		<policy context="default"><allow send_destination="*" eavesdrop="true"/><allow eavesdrop="true"/>
		<allow own="*"/></policy></busconfig>
	END
	sync
	dbus-daemon --config-file="$CUT/bus.conf" --nofork &
	irhorizond --config "$CUT/irhorizon.toml" >"$CUT/log" 2>&1 &
	irhorizonctl wait-ready --bus "$bus" --timeout 30 || return
	irhorizonctl calibrate --bus "$bus" --config "$CUT/irhorizon.toml" --seconds 2 --yes >"$CUT/said" 2>&1 &
	# From the first of its files on it is saving.
	until compgen -G "$DROP_INS/.*50-trim*" >/dev/null; do
		kill -0 $! 2>/dev/null || return
	done
	echo "power cut at $(cut -d' ' -f1 /proc/uptime) s, while saving"
	echo 1 >/proc/sys/kernel/sysrq
	echo b >/proc/sysrq-trigger
	sleep 60
}

power_cut_while_calibrate_saves() {
	[ ! -e "$CUT/uncut" ]
	ls -A "$DROP_INS"
	cat "$DROP_INS/50-trim.toml"
	# The old ones, or the new ones, to half a degree.
	awk '$1 == "roll-trim-deg" { roll = $3 } $1 == "pitch-trim-deg" { pitch = $3 }
		END { old = roll == 1 && pitch == 1; new = roll > 2.5 && roll < 3.5 && pitch > -2.5 && pitch < -1.5
			exit !(old || new) }' "$DROP_INS/50-trim.toml"
	irhorizonctl validate "$CUT/irhorizon.toml"
	# What was left half done is in nobody's way: nothing but drop-ins is read.
	rm -r "$CUT"
}
