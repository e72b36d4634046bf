# shellcheck shell=bash
# Debian's kernel packages: which there are, and how to fetch them. Nothing of
# the kernel is installed. Where the host's own apt does not know the kernel
# (Ubuntu, another Debian), a private apt state asks Debian's mirror instead.

vm_metapackage=linux-image-6.12-amd64
vm_mirror=${IRHORIZON_DEBIAN_MIRROR:-http://deb.debian.org}
apt_options=()

kernel_package() {
	apt-cache "${apt_options[@]}" depends "$vm_metapackage" 2>/dev/null |
		sed -n 's/^ *Depends: \(linux-image-6\.12[^ ]*-amd64\)$/\1/p'
}

package_version() {
	apt-cache "${apt_options[@]}" show --no-all-versions "$1" | sed -n 's/^Version: //p'
}

# Set apt_options for a state of our own under DIR that knows only bookworm.
private_apt() {
	local dir=$1 keyring=/usr/share/keyrings/debian-archive-keyring.gpg
	[ -e "$keyring" ] || as_root apt-get install -y debian-archive-keyring >&2 ||
		die "no $keyring: install the package debian-archive-keyring"
	mkdir -p "$dir"/{lists/partial,cache/archives/partial,parts}
	: >"$dir/status"
	printf 'deb [signed-by=%s] %s/%s main\n' \
		"$keyring" "$vm_mirror" 'debian bookworm' \
		"$keyring" "$vm_mirror" 'debian-security bookworm-security' >"$dir/sources.list"
	apt_options=(
		-o APT::Architecture=amd64 -o APT::Architectures=amd64
		-o Dir::State="$dir" -o Dir::State::lists="$dir/lists" -o Dir::State::status="$dir/status"
		-o Dir::Cache="$dir/cache"
		-o Dir::Etc::sourcelist="$dir/sources.list" -o Dir::Etc::sourceparts="$dir/parts"
		-o Dir::Etc::preferencesparts="$dir/parts" -o APT::Sandbox::User=
	)
	retry quietly apt-get "${apt_options[@]}" update
}

# See to it that apt knows the kernel; with "update", ask the mirror first.
find_kernel() {
	if { [ "${1:-}" = update ] && [ ${#apt_options[@]} = 0 ]; } || [ -z "$(kernel_package)" ]; then
		retry quietly as_root apt-get update || say "apt-get update failed, going on with what apt knows"
	fi
	if [ -z "$(kernel_package)" ]; then
		say "this host's apt does not know $vm_metapackage; asking $vm_mirror"
		private_apt "$VM_CACHE/apt" || die "cannot read Debian's package lists from $vm_mirror"
	fi
	[ -n "$(kernel_package)" ] || die "no mirror has $vm_metapackage; name one that has in IRHORIZON_DEBIAN_MIRROR"
}

# Download packages into DIR.
download() {
	local dir=$1
	shift
	mkdir -p "$dir"
	(cd "$dir" && retry quietly apt-get "${apt_options[@]}" download -o APT::Sandbox::User=root "$@")
}
