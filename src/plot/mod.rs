//! Drawings as SVG. Pure: numbers in, text out, the same text for the same numbers.
//!
//! - `svg`: the few elements that are drawn; `style`: colours and dashes that do without colour too.
//! - [`axis`]: from a quantity to the paper, with ticks at round numbers.
//! - [`envelope`]: a long series in bounded room; `spans`: what held from when to when.
//! - `chart`: a panel with axes, curves, bands and a legend beside it.
//! - [`flight`]: a replayed flight over time; `strip`: its modes and faults as bars.
//! - [`residuals`]: its errors against a reference.
//! - [`report`]: figures 6 to 9 of MECSE-2-2007.

pub mod axis;
mod chart;
pub mod envelope;
pub mod flight;
pub mod report;
pub mod residuals;
mod spans;
mod strip;
mod style;
mod svg;
