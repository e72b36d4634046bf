# shellcheck shell=bash
# The kernel as Debian ships it, unpacked into the cache: image, modules,
# headers to build against, and the two source files that become gpio-sim.

# Fill DIR (…/<version>) for PACKAGE (linux-image-<release>). DIR/release is
# written last and so says that the rest is whole.
unpack_kernel() {
	local dir=$1 package=$2
	local release=${package#linux-image-} debs=$1/debs version=${1##*/}
	local abi=${release%-amd64}
	[ -s "$dir/release" ] && return

	rm -rf "$dir"
	say "downloading Debian's kernel $version and its source (270 MB)"
	download "$debs" "$package=$version" "linux-headers-$release=$version" \
		"linux-headers-$abi-common=$version" "linux-kbuild-$abi=$version" "linux-source-6.12=$version"

	say "unpacking"
	local deb
	for deb in "$debs"/linux-{image,headers,kbuild}-*.deb; do
		dpkg-deb -x "$deb" "$dir/root"
	done
	# The headers name each other by absolute path.
	sed -i "s|/usr/src/|$dir/root/usr/src/|" "$dir/root/usr/src/linux-headers-$release/Makefile"
	dpkg-deb --fsys-tarfile "$debs"/linux-source-*.deb |
		tar -xO ./usr/src/linux-source-6.12.tar.xz |
		tar -xJ -C "$dir" --strip-components=1 \
			linux-source-6.12/drivers/gpio/gpio-sim.c linux-source-6.12/kernel/irq/irq_sim.c
	depmod -b "$dir/root" "$release"
	rm -rf "$debs"
	echo "$release" >"$dir/release"
}
