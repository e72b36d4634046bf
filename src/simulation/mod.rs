//! A made-up flight under a made-up sky, in place of the hardware.
