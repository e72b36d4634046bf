# shellcheck shell=bash
# Host packages, by apt, and only those whose command is missing.

# command=package
VM_NEEDS=(
	qemu-system-x86_64=qemu-system-x86
	busybox=busybox-static
	modprobe=kmod
	xz=xz-utils
	gcc=gcc
	make=make
	ip=iproute2
	dbus-daemon=dbus
	python3=python3
)

have() { PATH=$PATH:/usr/sbin:/sbin command -v "$1" >/dev/null; }

missing_packages() {
	local need
	for need in "${VM_NEEDS[@]}"; do
		have "${need%%=*}" || echo "${need##*=}"
	done
	# busybox must be the static one: it runs before there is a libc.
	if have busybox && [ -n "$(find "$(command -v busybox)" -size -1000k)" ]; then
		echo busybox-static
	fi
	# The kernel's build tools (objtool, modpost) are linked to libelf.
	compgen -G '/usr/lib/*/libelf.so.1' >/dev/null || echo libelf1
}

as_root() {
	if [ "$(id -u)" = 0 ]; then
		"$@"
	else
		sudo -n "$@"
	fi
}

install_packages() {
	local missing
	mapfile -t missing < <(missing_packages)
	[ ${#missing[@]} -gt 0 ] || return 0
	have apt-get || die "missing: ${missing[*]} (names of Debian's packages); there is no apt here, install them by hand"
	if [ "$(id -u)" != 0 ] && ! sudo -n true 2>/dev/null; then
		die "missing: ${missing[*]}; as root run: apt-get install --no-install-recommends ${missing[*]}"
	fi
	say "installing ${missing[*]}"
	export DEBIAN_FRONTEND=noninteractive
	quietly as_root apt-get -o DPkg::Lock::Timeout=600 install -y --no-install-recommends "${missing[@]}" && return
	retry quietly as_root apt-get update || say "apt-get update failed, going on with what apt knows"
	retry quietly as_root apt-get -o DPkg::Lock::Timeout=600 install -y --no-install-recommends "${missing[@]}" ||
		die "apt could not install: ${missing[*]}"
}
