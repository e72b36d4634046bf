//! The noise that standard deviations assume of the sensors.

/// Noise of one pair's signal, K rms: two sensors of 0.08 K.
pub const PAIR_NOISE_K: f64 = 0.113;
