# shellcheck shell=bash
# The same tests without a guest, where this host's own kernel has the modules.

# Print what is missing to run natively; nothing if nothing is.
native_obstacle() {
	local module
	[ "$(id -u)" = 0 ] || { echo "not root"; return; }
	have modprobe || { echo "no modprobe (package kmod)"; return; }
	for module in i2c-dev i2c-stub gpio-sim; do
		modprobe -n -q "$module" || { echo "the kernel $(uname -r) has no module $module"; return; }
	done
	for module in i2c-dev gpio-sim; do
		modprobe -q "$module" || { echo "the module $module does not load"; return; }
	done
	own_fault_module
}

# i2c-fault is ours: build it for the running kernel and put it where modprobe
# finds it, anew whenever its source has changed.
own_fault_module() {
	local release headers hash kept into
	release=$(uname -r)
	headers=/lib/modules/$release/build
	hash=$(cat "$VM_SRC"/modules/i2c-fault/* | sha256sum | cut -c1-16)
	kept=$VM_CACHE/native/$release/i2c-fault-$hash.ko
	into=/lib/modules/$release/updates
	if [ ! -e "$headers/Makefile" ]; then
		modprobe -n -q i2c-fault || echo "no headers of the kernel $release to build i2c-fault with"
		return
	fi
	if [ ! -e "$kept" ]; then
		say "building i2c-fault for the kernel $release"
		local build=$VM_CACHE/native/$release/build
		rm -rf "$build"
		mkdir -p "$build"
		cp "$VM_SRC"/modules/i2c-fault/* "$build"
		quietly make -C "$headers" M="$build" CONFIG_DEBUG_INFO_BTF_MODULES= modules || { echo "i2c-fault does not build"; return; }
		mv "$build/i2c-fault.ko" "$kept"
		rm -rf "$build"
	fi
	if ! cmp -s "$kept" "$into/i2c-fault.ko"; then
		mkdir -p "$into"
		cp "$kept" "$into/i2c-fault.ko"
		depmod "$release"
	fi
	# Secure Boot, for one, may refuse it.
	if [ ! -d /sys/module/i2c_fault ]; then
		modprobe -q i2c-fault chip_addr=0x5a && rmmod i2c-fault || echo "i2c-fault does not load, see dmesg"
	fi
}

# Run the command on the host itself; 124 after LIMIT seconds.
native() {
	local share=$1 limit=$2
	shift 2
	export IRHORIZON_KERNEL_TESTS=1 IRHORIZON_SHARE=$share IRHORIZON_HOST=127.0.0.1
	timeout --foreground -k 3 "$limit" "$@" </dev/null
}
