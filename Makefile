# The two commands: `make demo` shows the daemon at work without hardware, `make test` runs everything.
.PHONY: demo test test-arm lint fuzz bench deb

demo:
	@[ -x target/release/irhorizond ] || echo "building: some minutes the first time"
	@cargo build --release --quiet
	@tests/demo

test:
	@tests/run

# The packages for arm64 and armhf as they are given out; `make test` has one for arm64, built quickly.
test-arm:
	@tests/arm/run

lint:
	cargo fmt --check
	cargo clippy --all-targets --quiet -- --deny warnings
	RUSTDOCFLAGS='--deny warnings' cargo doc --no-deps --quiet
	cargo clippy --test kernel --test accuracy --quiet -- --deny warnings

# Longer than `make test` does: make fuzz SECONDS=3600
fuzz:
	@fuzz/run $(SECONDS)

bench:
	@benches/run

deb:
	@packaging/build
