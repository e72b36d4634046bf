# shellcheck shell=bash
# Upgrade, remove, purge, by dpkg: apt takes long to decide on what is decided.

by_dpkg() { DEBIAN_FRONTEND=noninteractive dpkg "$@" </dev/null >"$STATE/dpkg" 2>&1 || { cat "$STATE/dpkg"; return 1; }; }

upgrade_keeps_the_configuration() {
	local before sum
	before=$(main_pid)
	sum=$(md5sum </etc/irhorizon/irhorizon.toml)
	by_dpkg --force-confdef -i /host/second.deb
	dpkg -s irhorizon | grep '^Version'
	[ "$(md5sum </etc/irhorizon/irhorizon.toml)" = "$sum" ]
	ls /etc/irhorizon
	# What ran runs again, as the new one.
	active
	[ "$(main_pid)" != "$before" ]
	soon 3 "attitude" attitude 20
	rm -f /etc/irhorizon/*.dpkg-*
}

remove_leaves_it() {
	# As `irhorizonctl trim --save` does.
	mkdir -p /etc/irhorizon/irhorizon.toml.d
	echo '[head]' >/etc/irhorizon/irhorizon.toml.d/trim.toml
	by_dpkg -r irhorizon
	! active
	[ ! -e /usr/bin/irhorizond ]
	ls /etc/irhorizon/irhorizon.toml /etc/irhorizon/irhorizon.toml.d/trim.toml
	grep -q /dev/i2c-0 /etc/irhorizon/irhorizon.toml
	refuted horizon Mode
}

purge_leaves_nothing() {
	# The administrator's own: drop-ins of the unit.
	rm -r /etc/systemd/system/irhorizond.service.d
	by_dpkg -P irhorizon
	local left
	left=$(find / -xdev \( -iname '*irhorizon*' -o -user irhorizon -o -group irhorizon \) \
		-not -path '*irhorizon-checks*' -not -path '/var/log/journal/*')
	left+=$(grep -rl irhorizond /etc /var/lib/systemd /var/lib/dpkg/info --exclude='irhorizon-checks*' || true)
	echo "left: ${left:-nothing}; the user: $(getent passwd irhorizon)"
	[ -z "$left" ]
	systemctl reset-failed
	[ -z "$(systemctl list-unit-files --no-legend 'irhorizond*')" ]
}
