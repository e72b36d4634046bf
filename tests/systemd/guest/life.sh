# shellcheck shell=bash
# What may happen to the daemon while it runs.

bus_absent_at_boot() {
	[ ! -e /dev/i2c-0 ]
	within 30 "the service is active" active
	systemctl show -p ActiveEnterTimestampMonotonic irhorizond
	within 10 "status says why" bus_is_down
	nobody irhorizonctl status || true
	journal | tail -n 3
	# It is fed by a fault, too: two more of the watchdog's times, and no restart.
	sleep 11
	[ "$(restarts)" = 0 ]
}
bus_is_down() { horizon Faults | grep -q 'bus-down:/dev/i2c-0'; }

bus_appears() {
	local begin=$EPOCHREALTIME
	sensors_appear
	echo "written after $(since "$begin") s"
	stat -c '%A %U %G %n' /dev/i2c-0
	[ "$(stat -c '%a %G' /dev/i2c-0)" = '660 i2c' ]
	soon 10 "attitude, roll 20°" attitude 20
	show
	[ "$(restarts)" = 0 ]
	# The tag that units of one's own can wait for.
	systemctl is-active 'dev-i2c\x2d0.device'
}

status_as_nobody() {
	nobody irhorizonctl status
	echo "exit code $?"
	nobody irhorizonctl sensors
}

enable_now() {
	systemctl disable --now irhorizond 2>&1
	[ "$(systemctl is-active irhorizond)" = inactive ]
	local begin=$EPOCHREALTIME
	systemctl enable --now irhorizond 2>&1
	active
	echo "enable --now returned after $(since "$begin") s"
	soon 3 "attitude" attitude 20
}

killed() {
	local before
	before=$(main_pid)
	kill -9 "$before"
	soon 2 "attitude" ready
	of_another "$before"
	show
}
# One process that waits: at this pace, to start one for each look would be most of the time.
ready() { nobody irhorizonctl wait-ready --mode degraded --timeout 30; }
of_another() { [ "$(main_pid)" != "$1" ] && attitude 20; }

bitten() { [ "$(main_pid)" != "$1" ]; }
stopped() {
	local before cursor
	before=$(main_pid)
	cursor=$(mark)
	kill -STOP "$before"
	# WatchdogSec=5 is of the clock, whatever the pace.
	within 10 "the watchdog bites" bitten "$before"
	soon 2 "attitude" ready
	of_another "$before"
	journalctl --after-cursor="$cursor" -o cat --no-pager | grep -i watchdog
}

dbus_restarted() {
	local before
	before=$(main_pid)
	systemctl restart dbus
	soon 2 "properties" ready
	attitude 20
	[ "$(main_pid)" = "$before" ]
}

recording_on_a_full_disk() {
	local before status=0 fields
	before=$(main_pid)
	mkdir -p /mnt/small
	mountpoint -q /mnt/small || mount -t tmpfs -o size=64k,mode=1777 tmpfs /mnt/small
	timeout 60 setpriv --reuid=nobody --regid=nogroup --clear-groups irhorizonctl record /mnt/small/flight.csv || status=$?
	echo "record ended with status $status"
	[ "$status" != 0 ] && [ "$status" != 124 ]
	df --output=used,avail /mnt/small | tail -n 1
	# Whole: every row ends, and has as many cells as the header.
	[ "$(tail -c 1 /mnt/small/flight.csv | od -An -c | tr -d ' ')" = '\n' ]
	fields=$(grep -v '^#' /mnt/small/flight.csv | awk -F, '{ print NF }' | sort -u)
	echo "$(grep -vc '^#' /mnt/small/flight.csv) rows of $fields cells"
	[ "$(wc -w <<<"$fields")" = 1 ]
	irhorizonctl replay /mnt/small/flight.csv --output /tmp/replayed.csv 2>&1
	attitude 20
	[ "$(main_pid)" = "$before" ]
	umount /mnt/small
}

broken_configuration() {
	local before cursor config=/etc/irhorizon/irhorizon.toml
	before=$(main_pid)
	cursor=$(mark)
	cp "$config" /tmp/sound.toml
	sed -i 's/^\[daemon\]/[daemon]\nrate-hx = 10/' "$config"
	systemctl reload irhorizond
	within 5 "the journal says so" refusal "$cursor"
	journal_since "$cursor"
	refuted reload
	attitude 20
	[ "$(main_pid)" = "$before" ]
	# Started with it, it says what is wrong and is not started again and again.
	systemctl restart irhorizond && return 1
	sleep 2
	systemctl show -p Result -p ExecMainStatus -p NRestarts irhorizond | paste -sd ' '
	[ "$(systemctl show -P ExecMainStatus irhorizond)" = 78 ]
	[ "$(restarts)" = 0 ]
	cp /tmp/sound.toml "$config"
	systemctl restart irhorizond
	soon 3 "attitude" attitude 20
}
refusal() { journal_since "$1" | grep -q 'the old one stays in force'; }
