# shellcheck shell=bash
# The kernel as Debian ships it, unpacked into the cache: image, modules,
# headers to build against, and the source files that modules of ours are made of.

# Download into the cache the newest kernel that apt knows. Fails if it cannot.
# Sets kernel, its folder …/<version>; release is what the kernel calls itself.
fetch_kernel() {
	local package version abi
	package=$(kernel_package)
	version=$(package_version "$package")
	release=${package#linux-image-}
	abi=${release%-amd64}
	kernel=$VM_CACHE/$version
	[ ! -s "$kernel/release" ] || return 0
	rm -rf "$kernel"
	say "downloading Debian's kernel $version and its source (270 MB)"
	download "$kernel/debs" "$package=$version" "linux-headers-$release=$version" \
		"linux-headers-$abi-common=$version" "linux-kbuild-$abi=$version" "linux-source-6.12=$version"
}

# Unpack what was downloaded. DIR/release, written last, says that all is whole.
unpack_kernel() {
	local dir=$1 release=$2 deb
	[ ! -s "$dir/release" ] || return 0
	say "unpacking"
	for deb in "$dir/debs"/linux-{image,headers,kbuild}-*.deb; do
		dpkg-deb -x "$deb" "$dir/root"
	done
	# The headers name each other by absolute path.
	sed -i "s|/usr/src/|$dir/root/usr/src/|" "$dir/root/usr/src/linux-headers-$release/Makefile"
	unpack_sources "$dir/debs" "$dir"
	depmod -b "$dir/root" "$release"
	rm -rf "$dir/debs"
	echo "$release" >"$dir/release"
}

# Take from the package linux-source-6.12 in DEBS into DIR what becomes gpio-sim and, for arm64, i2c-stub.
unpack_sources() {
	local debs=$1 dir=$2
	dpkg-deb --fsys-tarfile "$debs"/linux-source-*.deb |
		tar -xO ./usr/src/linux-source-6.12.tar.xz |
		tar -xJ -C "$dir" --strip-components=1 linux-source-6.12/drivers/gpio/gpio-sim.c \
			linux-source-6.12/drivers/i2c/i2c-stub.c linux-source-6.12/kernel/irq/irq_sim.c
}
