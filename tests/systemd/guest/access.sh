# shellcheck shell=bash
# Who may do what, and where MAVLink may go.

exposure_and_memory() {
	systemd-analyze security --no-pager irhorizond | tail -n 1
	systemd-analyze security --no-pager --threshold=15 irhorizond >/dev/null
	grep -E '^(VmRSS|VmHWM|Threads)' "/proc/$(main_pid)/status" | paste -sd ' '
	echo "memory of the unit: $(systemctl show -P MemoryCurrent irhorizond) bytes"
	# Nothing of the sandbox was left out because the kernel or systemd does not know it.
	! journalctl -b -o cat --no-pager | grep -E 'irhorizond.*(Unknown|did not match|ignoring)'
}

reload_by_whom() {
	refuted reload nobody
	reload member && echo "a member of the group irhorizon: done"
	reload env && echo "root: done"
	attitude 20
}

activation() {
	systemctl stop irhorizond
	local status=0
	nobody irhorizonctl status || status=$?
	[ "$status" = 3 ]
	[ "$(systemctl is-active irhorizond)" = inactive ]
	soon 5 "started by the first who asked" attitude 20
	active
}

endpoint() { horizon Endpoints; }
sent() { endpoint | sed 's/.* "sent" \([0-9]*\) .*/\1/'; }
denied() { endpoint | grep -q 'the system forbids it'; }

mavlink_stays_here() {
	soon 5 "the endpoint is refused" denied
	endpoint
	[ "$(sent)" = 0 ]
}

mavlink_to_another_machine() {
	local drop_ins=/etc/systemd/system/irhorizond.service.d begin count
	mkdir -p "$drop_ins"
	cp /usr/share/doc/irhorizon/examples/{network,serial}.conf "$drop_ins"/
	systemctl daemon-reload
	systemd-analyze verify irhorizond.service
	systemctl restart irhorizond
	soon 5 "attitude" attitude 20
	begin=$EPOCHREALTIME count=$(sent)
	sleep 4
	echo "$(($(sent) - count)) messages in $(since "$begin") s"
	[ "$(sent)" -gt $((count + 50)) ]
	endpoint
}

# It finds nothing wrong with what is installed and running; what it warns of is the guest's bus without PEC, and its pace.
doctor() {
	local said status=0
	said=$(irhorizonctl doctor) || status=$?
	echo "$said"
	[ "$status" = 0 ]
	grep -q '^ok    service' <<<"$said"
	grep -q '^ok    policy' <<<"$said"
	grep -q '^ok    mavlink' <<<"$said"
	irhorizonctl doctor --json | grep -q '"failures"'
}

real_time() {
	local drop_ins=/etc/systemd/system/irhorizond.service.d
	cp /usr/share/doc/irhorizon/examples/real-time.conf "$drop_ins"/
	systemctl daemon-reload
	systemctl restart irhorizond
	chrt -a -p "$(main_pid)"
	chrt -p "$(main_pid)" | grep -q SCHED_RR
	soon 3 "attitude" attitude 20
	rm "$drop_ins/real-time.conf"
	systemctl daemon-reload
	systemctl restart irhorizond
}
