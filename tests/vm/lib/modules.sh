# shellcheck shell=bash
# Modules: building ours, and gathering what the guest needs.

# Build the module in DIR (a Kbuild folder) against HEADERS.
build_module() {
	local dir=$1 headers=$2 cc=gcc
	have x86_64-linux-gnu-gcc-12 && cc=x86_64-linux-gnu-gcc-12 # what Debian built its kernel with
	# Without type information (BTF), which needs pahole where the headers bring a vmlinux.
	quietly make -C "$headers" M="$dir" CC="$cc" CONFIG_DEBUG_INFO_BTF_MODULES= modules ||
		die "the module in $dir does not build against $headers"
}

# Put NAME.ko into OUT, built from the folder modules/NAME of the work tree;
# kept by a hash of its sources, so that an edit rebuilds it and nothing else.
cached_module() {
	local name=$1 kernel=$2 out=$3 release hash kept
	release=$(<"$kernel/release")
	hash=$(cat "$VM_SRC/modules/$name"/* | sha256sum | cut -c1-16)
	kept=$kernel/built/$name-$hash.ko
	if [ ! -e "$kept" ]; then
		say "building $name"
		local build=$kernel/build/$name
		rm -rf "$build"
		mkdir -p "$build" "$kernel/built"
		cp "$VM_SRC/modules/$name"/* "$build"
		if [ -x "$build/sources" ]; then
			"$build/sources" "$kernel" "$build" || die "cannot make the sources of $name"
		fi
		build_module "$build" "$kernel/root/usr/src/linux-headers-$release"
		cp "$build/$name.ko" "$kept.new"
		mv "$kept.new" "$kept"
		rm -rf "$build"
	fi
	cp "$kept" "$out/$name.ko"
}

# The files that modprobe would load for the modules named, in load order.
module_files() {
	local root=$1 release=$2 name
	shift 2
	for name; do
		modprobe -d "$root" -S "$release" --show-depends "$name" | sed -n 's/^insmod \([^ ]*\).*/\1/p' ||
			die "Debian's kernel has no module $name"
	done | awk '!seen[$0]++'
}

# A module tree in RIG for modprobe: those of modules.list decompressed, and ours.
module_tree() {
	local kernel=$1 rig=$2 release tree file names
	release=$(<"$kernel/release")
	tree=$rig/lib/modules/$release
	mkdir -p "$tree/kernel" "$tree/updates"
	cp "$kernel/root/lib/modules/$release"/modules.{builtin,builtin.modinfo,order} "$tree"
	mapfile -t names < <(sed 's/#.*//' "$VM_SRC/modules.list" | xargs -n1)
	module_files "$kernel/root" "$release" "${names[@]}" | while read -r file; do
		xz -dc "$file" >"$tree/kernel/$(basename "$file" .xz)"
	done
	cached_module gpio-sim "$kernel" "$tree/updates"
	cached_module i2c-fault "$kernel" "$tree/updates"
	depmod -b "$rig" "$release"
}
