# shellcheck shell=bash
# Debian 12 with systemd as a disk, and the initrd that boots it with the kernel of tests/vm.

# The packages, one a word.
guest_packages() { sed 's/#.*//' "$SYSTEMD_SRC/packages.list" | xargs; }

# Prints the disk's path; builds it where it is not there. It is named by its packages.
image() {
	local hash disk size log
	hash=$(guest_packages | sha256sum | cut -c1-16)
	disk=$SYSTEMD_CACHE/debian-$hash.ext4
	if [ ! -e "$disk" ]; then
		say "building Debian 12 with $(guest_packages) (two minutes)"
		mkdir -p "$SYSTEMD_CACHE"
		log=$(mktemp)
		# For a user without rights, too: mmdebstrap makes a tar, fakeroot keeps its owners.
		mmdebstrap --quiet --variant=minbase --include="$(guest_packages | tr ' ' ,)" \
			--dpkgopt='path-exclude=/usr/share/man/*' --dpkgopt='path-exclude=/usr/share/locale/*' \
			--aptopt='Acquire::Languages "none"' \
			bookworm "$disk.tar" "${IRHORIZON_DEBIAN_MIRROR:-http://deb.debian.org}/debian" >"$log" 2>&1 ||
			{ tail -n 20 "$log" >&2; die "mmdebstrap failed; is there a way to the mirror?"; }
		size=$(($(stat -c %s "$disk.tar") / 1048576 + 300))
		rm -rf "$disk.tree"
		mkdir "$disk.tree"
		# shellcheck disable=SC2016 # the inner shell expands it
		fakeroot sh -ec 'tar -x --numeric-owner --exclude="./dev/*" -f "$1.tar" -C "$1.tree"
			mke2fs -q -t ext4 -d "$1.tree" "$1.new" "$2M"' - "$disk" "$size" >"$log" 2>&1 ||
			{ tail -n 20 "$log" >&2; die "cannot write the disk $disk"; }
		rm -rf "$disk.tree" "$disk.tar" "$log"
		mv "$disk.new" "$disk"
	fi
	echo "$disk"
}

# Prints the initrd's path for RIG of tests/vm; built anew when anything in it has changed.
initrd() {
	local rig=$1 kernel release hash out tree n=10 file
	kernel=$(dirname "$rig")
	release=$(<"$rig/release")
	hash=$(cat "$SYSTEMD_SRC"/guest/{init,irhorizon-checks.service} "$SYSTEMD_SRC/modules.list" "$SYSTEMD_SRC/lib/image.sh" | sha256sum | cut -c1-16)
	out=$SYSTEMD_CACHE/initrd-$release-$hash
	if [ ! -e "$out" ]; then
		mkdir -p "$SYSTEMD_CACHE"
		find "$SYSTEMD_CACHE" -name "initrd-*" -mtime +7 -delete
		tree=$(mktemp -d)
		mkdir -p "$tree"/{bin,modules,dev,root} "$tree/tree/$release/kernel"
		cp "$(command -v busybox)" "$tree/bin/busybox"
		ln -s busybox "$tree/bin/sh"
		cp "$SYSTEMD_SRC"/guest/{init,irhorizon-checks.service} "$tree"
		chmod 755 "$tree/init"
		module_files "$kernel/root" "$release" virtio_blk ext4 | while read -r file; do
			xz -dc "$file" >"$tree/modules/$n-$(basename "$file" .xz)"
			n=$((n + 1))
		done
		cp "$kernel/root/lib/modules/$release"/modules.{builtin,builtin.modinfo,order} "$tree/tree/$release"
		# shellcheck disable=SC2046 # a word for each module
		module_files "$kernel/root" "$release" $(sed 's/#.*//' "$SYSTEMD_SRC/modules.list") | while read -r file; do
			xz -dc "$file" >"$tree/tree/$release/kernel/$(basename "$file" .xz)"
		done
		mkdir -p "$tree/lib"
		ln -s ../tree "$tree/lib/modules"
		depmod -b "$tree" "$release"
		(cd "$tree" && find . | busybox cpio -o -H newc >"$out.new") 2>/dev/null || die "cannot write the initrd"
		rm -rf "$tree"
		mv "$out.new" "$out"
	fi
	echo "$out"
}
