//! What goes wrong in flight, over many seeds: how soon it is seen, how rightly it is named, and how far off the
//! attitudes are that are given meanwhile.
//!
//! - `heard`: a flight through `Horizon`, heard in several ways; `flown`: without aiding and with rates and GPS, under one
//!   of six skies;
//! - `event`: the events, with what is asked of each;
//! - `outcome`: what became of one in one flight;
//! - `quiet`: flights in which nothing goes wrong;
//! - `report`: distributions, and what is reached of what is asked.

pub mod event;
pub mod flown;
pub mod heard;
pub mod outcome;
pub mod quiet;
pub mod report;
