//! The irhorizonctl binary: a shim over the library.

fn main() {}
