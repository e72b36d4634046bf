# shellcheck shell=bash
# One life of the guest: boot it, pass on what it says, tell how it ended.

# Processes that must not outlive us.
children=()

reap_children() {
	[ ${#children[@]} = 0 ] || kill "${children[@]}" 2>/dev/null || true
	children=()
}

# Write what the guest is to do into WORK.
write_orders() {
	local work=$1 rig=$2 share=$3
	shift 3
	printf 'RIG=%q\nSHARE=%q\nRELEASE=%q\n' "$rig" "$share" "$(<"$rig/release")" >"$work/guest.env"
	{
		export -p
		printf 'unset DBUS_SESSION_BUS_ADDRESS DISPLAY\n'
		printf 'export IRHORIZON_KERNEL_TESTS=1 IRHORIZON_SHARE=%q IRHORIZON_HOST=10.0.2.2\n' "$share"
		printf 'cd %q || exit 125\n' "$PWD"
		printf 'exec'
		printf ' %q' "$@"
		printf '\n'
	} >"$work/command"
}

# Start QEMU; what it says of itself and the kernel's console are kept in WORK.
start_qemu() {
	local work=$1 rig=$2 share=$3 limit=$4
	timeout -k 3 "$limit" "${QEMU_BASE[@]}" "${QEMU_ACCEL[@]}" \
		-m "${IRHORIZON_VM_MEMORY:-1024}" \
		-kernel "$rig/vmlinuz" -initrd "$rig/initrd" \
		-append "console=ttyS0 quiet panic=-1 oops=panic mitigations=off audit=0 apparmor=0 norandmaps net.ifnames=0 irhorizon.work=$work" \
		-serial "file:$work/console" \
		-chardev file,id=out,path="$work/out" -device virtserialport,nr=1,chardev=out \
		-chardev file,id=err,path="$work/err" -device virtserialport,nr=2,chardev=err \
		-chardev file,id=state,path="$work/state" -device virtserialport,nr=3,chardev=state \
		-fsdev local,id=root,path=/,security_model=none,readonly=on,multidevs=remap \
		-device virtio-9p-pci,fsdev=root,mount_tag=root \
		-fsdev local,id=share,path="${share//,/,,}",security_model=none,multidevs=remap \
		-device virtio-9p-pci,fsdev=share,mount_tag=share \
		-netdev user,id=net -device virtio-net-pci,netdev=net,romfile= \
		</dev/null >"$work/qemu" 2>&1 &
	QEMU_PID=$!
}

# Kill QEMU if the guest has not come up after some time: a boot that gets
# nowhere is not worth the whole limit.
watch_boot() {
	local work=$1 nap
	trap 'kill "$nap"; exit' TERM
	sleep 60 &
	nap=$!
	wait "$nap"
	[ -s "$work/state" ] || kill "$QEMU_PID"
}

# Boot, print the command's output as it comes, and return its status; 124
# after LIMIT seconds; 125 if the guest died, 126 if it did not even come up.
guest() {
	local work=$1 rig=$2 share=$3 limit=$4 readers=() ended=0 status
	rm -f "$work"/{out,err,state,console}
	mkfifo "$work/out" "$work/err"
	: >"$work/state"
	cat "$work/out" &
	readers+=($!)
	cat "$work/err" >&2 &
	readers+=($!)
	choose_accel "$rig"
	start_qemu "$work" "$rig" "$share" "$limit"
	watch_boot "$work" >/dev/null 2>&1 &
	children=("$QEMU_PID" $! "${readers[@]}")

	wait "$QEMU_PID" || ended=$?
	# Wake the readers of pipes that QEMU perhaps never opened.
	: 3<>"$work/out" 4<>"$work/err"
	wait "${readers[@]}" 2>/dev/null || true
	reap_children

	status=$(sed -n 's/^exit //p' "$work/state")
	if [ -n "$status" ]; then
		return "$status"
	elif [ "$ended" = 124 ] || [ "$ended" = 137 ]; then
		explain "$work" "stopped the guest after $limit s (--timeout)"
		return 124
	elif [ -s "$work/state" ]; then
		explain "$work" "the guest died before the command ended (a panic of its kernel?)"
		return 125
	fi
	explain "$work" "the guest did not come up"
	return 126
}

explain() {
	say "$2"
	say "the last lines of QEMU and of the guest's console:"
	tail -n 5 "$1/qemu" >&2 || true
	tr -d '\r' <"$1/console" 2>/dev/null | { grep -m1 -E 'Kernel panic|BUG:|Oops' || true; } >&2
	tr -d '\r' <"$1/console" 2>/dev/null | tail -n 30 >&2 || true
}
