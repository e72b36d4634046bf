//! The live horizon in the terminal.
//!
//! - `picture`: the whole picture, a pure function of what was seen.
//! - `horizon`: sky over ground; `instruments`: ladder, bank scale, aircraft on it.
//! - `canvas`: dots, eight to a cell.
//! - `panel`: the readouts beside it.
//! - `palette`: colours, or none.
//! - `live`: the terminal and the daemon at its other end.
//! - [`print`]: one picture as text.

mod canvas;
mod horizon;
mod instruments;
mod live;
mod palette;
mod panel;
mod picture;
mod print;

pub use live::command;
pub use palette::Palette;
pub use picture::{Seen, draw};
pub use print::{ansi, text};
