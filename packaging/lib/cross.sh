# shellcheck shell=bash
# Rust for another architecture with what Debian has: its compiler, the other architecture's standard
# library out of a package that is only unpacked, its cross compiler to link.

# The name that Rust has for an architecture of Debian; nothing for one that we do not build for.
triple() {
    case $1 in
    amd64) echo x86_64-unknown-linux-gnu ;;
    arm64) echo aarch64-unknown-linux-gnu ;;
    armhf) echo armv7-unknown-linux-gnueabihf ;;
    esac
}

linker() {
    case $1 in
    amd64) echo x86_64-linux-gnu-gcc ;;
    arm64) echo aarch64-linux-gnu-gcc ;;
    armhf) echo arm-linux-gnueabihf-gcc ;;
    esac
}

# Debian's releases that have rustc-web's libraries: Debian 12 builds none for armhf.
suites() {
    case $1 in
    armhf) echo "trixie trixie-security" ;;
    *) echo "bookworm bookworm-security" ;;
    esac
}

# apt for ARCH with a state of its own, which touches nothing of this machine's.
private_apt() {
    local arch=$1 dir=$PACKAGING_CACHE/apt-$1
    shift
    apt-get -o APT::Architecture="$arch" -o APT::Architectures="$arch" -o Dir::State="$dir" \
        -o Dir::State::status="$dir/status" -o Dir::Cache="$dir/cache" -o Dir::Etc::sourcelist="$dir/sources.list" \
        -o Dir::Etc::sourceparts="$dir/parts" -o Dir::Etc::preferencesparts="$dir/parts" \
        -o APT::Sandbox::User=root -o Acquire::Languages=none -o Acquire::IndexTargets::deb::DEP-11::DefaultEnabled=false \
        "$@"
}

private_apt_update() {
    local arch=$1 dir=$PACKAGING_CACHE/apt-$1 suite place keyring=/usr/share/keyrings/debian-archive-keyring.gpg
    [ -e "$keyring" ] || die "no $keyring: apt-get install debian-archive-keyring"
    mkdir -p "$dir"/{lists/partial,cache/archives/partial,parts}
    : >"$dir/status"
    for suite in $(suites "$arch"); do
        place=debian
        [ "$suite" = "${suite%-security}" ] || place=debian-security
        echo "deb [signed-by=$keyring] ${IRHORIZON_DEBIAN_MIRROR:-http://deb.debian.org}/$place $suite main"
    done >"$dir/sources.list"
    quietly private_apt "$arch" update || say "not all package lists of $(suites "$arch") could be read, going on"
}

# The folder of the standard library for ARCH, of the version that rustc-web has here.
sysroot() {
    echo "$PACKAGING_CACHE/std-$1-$(/usr/bin/rustc --version | cut -d' ' -f2)"
}

# Sees to it that ARCH can be compiled for.
prepare_cross() {
    local arch=$1 machine into version
    machine=$(linker "$arch")
    machine=${machine%-gcc}
    need "$machine-gcc" "gcc-$machine"
    # The compiler only recommends what it links with.
    [ -e "/usr/$machine/lib/crt1.o" ] || missing+=("libc6-dev-$arch-cross")
    [ -x /usr/bin/rustc ] || missing+=(rustc-web)
    [ -x /usr/bin/cargo ] || missing+=(cargo-web)
    install_missing
    into=$(sysroot "$arch")
    [ ! -d "$into/usr/lib/rustlib/$(triple "$arch")/lib" ] || return 0
    version=${into##*-}
    say "fetching Rust's standard library $version for $arch"
    private_apt_update "$arch"
    rm -rf "$into" "$into.new"
    mkdir -p "$into.new"
    # The newest version of the same release of Rust.
    (cd "$into.new" && quietly private_apt "$arch" download "libstd-rust-web-dev=$version*") ||
        die "Debian ($(suites "$arch")) has no libstd-rust-web-dev $version for $arch: is rustc-web here the newest?"
    dpkg-deb -x "$into.new"/libstd-rust-web-dev_*.deb "$into.new"
    rm "$into.new"/*.deb
    mv "$into.new" "$into"
}

# cross_cargo ARCH ARGUMENT…: Debian's cargo, for ARCH.
cross_cargo() {
    local arch=$1 triple variable
    triple=$(triple "$arch")
    variable=${triple//-/_}
    shift
    env -u RUSTUP_TOOLCHAIN RUSTC=/usr/bin/rustc \
        "CARGO_TARGET_${variable^^}_LINKER=$(linker "$arch")" \
        "CARGO_TARGET_${variable^^}_RUSTFLAGS=--sysroot=$(sysroot "$arch")/usr" \
        /usr/bin/cargo "$1" --target "$triple" "${@:2}"
}
