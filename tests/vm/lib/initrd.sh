# shellcheck shell=bash
# The initrd: busybox, the modules that reach the host's files, guest/init.

make_initrd() {
	local rig=$1 release=$2 tree=$1/initrd.tree n=10 file
	mkdir -p "$tree"/{bin,modules,lower,upper,root,proc,sys,dev}
	cp "$(command -v busybox)" "$tree/bin/busybox"
	ln -s busybox "$tree/bin/sh"
	cp "$VM_SRC/guest/init" "$tree/init"
	cp "$VM_SRC/guest/main" "$tree/main"
	chmod 755 "$tree/init"
	# Numbered, so that init need only take them in the order of their names.
	module_files "$rig" "$release" 9pnet_virtio 9p overlay virtio_net | while read -r file; do
		cp "$file" "$tree/modules/$n-$(basename "$file")"
		n=$((n + 1))
	done
	(cd "$tree" && find . | busybox cpio -o -H newc >"$rig/initrd") 2>/dev/null ||
		die "cannot write the initrd"
	rm -rf "$tree"
}
