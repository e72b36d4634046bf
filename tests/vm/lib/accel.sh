# shellcheck shell=bash
# KVM or emulation. /dev/kvm may be there and useless, so a trial decides, once
# for each running kernel.

QEMU_BASE=(
	qemu-system-x86_64 -nodefaults -no-user-config -display none -no-reboot -M q35
	-device "virtio-serial-pci,max_ports=4"
)

trial_boot() {
	local rig=$1 state
	state=$(mktemp)
	(timeout -k 1 15 "${QEMU_BASE[@]}" -accel kvm -cpu host -m 256 \
		-kernel "$rig/vmlinuz" -initrd "$rig/initrd" \
		-append "console=ttyS0 quiet panic=-1 irhorizon.trial" \
		-chardev file,id=state,path="$state" -device virtserialport,nr=3,chardev=state \
		</dev/null || true) >/dev/null 2>&1
	grep -q up "$state"
	local verdict=$?
	rm -f "$state"
	return $verdict
}

# Set QEMU_ACCEL, QEMU's options of accelerator and processors, for RIG.
choose_accel() {
	local rig=$1 verdict=no file
	file=$VM_CACHE/kvm-$(uname -r)
	if [ -w /dev/kvm ]; then
		if [ ! -s "$file" ]; then
			say "trying whether KVM works here"
			trial_boot "$rig" && verdict=yes
			echo "$verdict" >"$file"
		fi
		verdict=$(<"$file")
	fi
	local cpus=2
	if [ -n "${VM_COUNT:-}" ]; then
		QEMU_ACCEL=(-accel tcg,thread=single -cpu max -icount "shift=0,sleep=off" -smp 1)
		return
	elif [ "$verdict" = yes ]; then
		QEMU_ACCEL=(-accel kvm -cpu host)
	else
		QEMU_ACCEL=(-accel "tcg,thread=multi" -cpu max)
		# Emulation before 8.1 can run stale code on the second processor when
		# the kernel patches itself: a panic in one boot of some forty.
		qemu_at_least 8 1 || cpus=1
	fi
	QEMU_ACCEL+=(-smp "${IRHORIZON_VM_CPUS:-$cpus}")
}

qemu_at_least() {
	local version
	version=$(qemu-system-x86_64 --version | sed -n 's/.*version \([0-9]*\)\.\([0-9]*\).*/\1 \2/p')
	[ "${version% *}" -gt "$1" ] || { [ "${version% *}" -eq "$1" ] && [ "${version#* }" -ge "$2" ]; }
}
