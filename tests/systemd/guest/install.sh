# shellcheck shell=bash
# From a clean Debian to a daemon that is enabled.

apt_install() {
	DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends "$@" </dev/null >"$STATE/apt" 2>&1 ||
		{ cat "$STATE/apt"; return 1; }
}

install_on_a_clean_debian() {
	[ -z "$(getent passwd irhorizon)" ]
	local begin=$EPOCHREALTIME
	apt_install /host/first.deb
	echo "apt-get install: $(since "$begin") s"
	dpkg -s irhorizon | grep -E '^(Status|Version|Architecture):'
	# Nothing is missing or changed but what a small image leaves out (path-exclude): pages to read.
	dpkg --verify irhorizon | grep -v ' /usr/share/\(doc\|man\)/' && return 1
	getent passwd irhorizon
	getent group i2c gpio dialout | cut -d: -f1 | paste -sd ' '
	! grep -iE 'warning|error' "$STATE/apt"
}

shipped_configuration() {
	nobody irhorizonctl validate
}

enable_is_the_users_choice() {
	[ "$(systemctl is-enabled irhorizond)" = disabled ]
	[ "$(systemctl is-active irhorizond)" = inactive ]
	# Nor does D-Bus start what is not enabled.
	refuted horizon Mode
	# The one file to edit: which bus. The endpoint is the machine outside.
	sed -i -e 's|/dev/i2c-1"|/dev/i2c-0"|' -e "s|^address = \"udpout:[^\"]*\"|address = \"udpout:10.0.2.2:$(</host/port)\"|" \
		/etc/irhorizon/irhorizon.toml
	irhorizonctl validate >/dev/null
	systemctl enable irhorizond 2>&1
	useradd --groups irhorizon pilot
}
