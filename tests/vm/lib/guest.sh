# shellcheck shell=bash
# One life of the guest: boot it, pass on what it says, tell how it ended.

# Write what the guest is to do into WORK.
write_orders() {
	local work=$1 rig=$2 share=$3
	shift 3
	{
		printf 'rig=%q\nshare=%q\nrelease=%q\n' "$rig" "$share" "$(<"$rig/release")"
	} >"$work/guest.env"
	{
		export -p
		printf 'export IRHORIZON_KERNEL_TESTS=1 IRHORIZON_SHARE=%q IRHORIZON_HOST=10.0.2.2\n' "$share"
		printf 'cd %q || exit 125\n' "$PWD"
		printf 'exec'
		printf ' %q' "$@"
		printf '\n'
	} >"$work/command"
}

# Boot; print the command's output as it comes; return its status, 124 after
# LIMIT seconds, 125 if the guest did not work.
guest() {
	local work=$1 rig=$2 share=$3 limit=$4
	mkfifo "$work/out" "$work/err"
	: >"$work/state"
	cat "$work/out" &
	local cats=($!)
	cat "$work/err" >&2 &
	cats+=($!)

	choose_accel "$rig"
	timeout -k 3 "$limit" "${qemu_base[@]}" -M q35 "${qemu_accel[@]}" \
		-m "${IRHORIZON_VM_MEMORY:-1024}" \
		-kernel "$rig/vmlinuz" -initrd "$rig/initrd" \
		-append "console=ttyS0 quiet panic=-1 oops=panic mitigations=off audit=0 apparmor=0 net.ifnames=0 irhorizon.work=$work" \
		-serial "file:$work/console" \
		-chardev file,id=out,path="$work/out" -device virtserialport,nr=1,chardev=out \
		-chardev file,id=err,path="$work/err" -device virtserialport,nr=2,chardev=err \
		-chardev file,id=state,path="$work/state" -device virtserialport,nr=3,chardev=state \
		-fsdev local,id=root,path=/,security_model=none,readonly=on,multidevs=remap \
		-device virtio-9p-pci,fsdev=root,mount_tag=root \
		-fsdev local,id=share,path="$share",security_model=none,multidevs=remap \
		-device virtio-9p-pci,fsdev=share,mount_tag=share \
		-netdev user,id=net -device virtio-net-pci,netdev=net,romfile= \
		</dev/null >"$work/qemu" 2>&1 &
	qemu_pid=$!

	# A boot that gets nowhere is not worth the whole limit.
	(
		sleep 90
		[ -s "$work/state" ] || kill "$qemu_pid"
	) >/dev/null 2>&1 &
	local watch=$! ended=0
	wait "$qemu_pid" || ended=$?
	kill "$watch" 2>/dev/null || true
	# Wake the readers of pipes that QEMU never opened.
	: 1<>"$work/out" 1<>"$work/err"
	wait "${cats[@]}" 2>/dev/null || true

	local status
	status=$(sed -n 's/^exit //p' "$work/state")
	if [ -n "$status" ]; then
		return "$status"
	fi
	if [ "$ended" = 124 ] || [ "$ended" = 137 ]; then
		explain "$work" "stopped the guest after $limit s (--timeout)"
		return 124
	fi
	if [ -s "$work/state" ]; then
		explain "$work" "the guest ended without the command's exit status: a kernel panic?"
	else
		explain "$work" "the guest did not boot"
	fi
	return 125
}

explain() {
	say "$2"
	say "the last of QEMU's and the guest's console:"
	tail -n 5 "$1/qemu" >&2 || true
	tr -d '\r' <"$1/console" 2>/dev/null | tail -n 40 >&2 || true
}
