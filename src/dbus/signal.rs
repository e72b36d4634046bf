//! One PropertiesChanged for all that changed.

use super::horizon::{Horizon, lock};
use super::{HORIZON, PATH};
use crate::attitude::Mode;
use crate::fault::FaultKind;
use std::collections::BTreeMap;
use std::time::{Duration, Instant};
use zbus::{Connection, Variant};

/// What was signalled last, and when the next is due.
#[derive(Default)]
pub(super) struct Signalled {
    values: Vec<(&'static str, Variant<'static>)>,
    mode: Mode,
    faults: Vec<FaultKind>,
    due: Option<Instant>,
}

impl Signalled {
    /// Sends one PropertiesChanged for all that changed, when it is due within `early` or the mode or the faults
    /// have changed.
    pub async fn signal(&mut self, connection: &Connection, horizon: &Horizon, early: Duration) -> zbus::Result<()> {
        let now = Instant::now();
        let soon = now + early;
        let update = {
            let live = lock(&horizon.live);
            let estimate = &live.snapshot.estimate;
            let kinds = || estimate.faults.iter().map(|f| f.kind);
            let urgent = self.mode != estimate.mode || !kinds().eq(self.faults.iter().copied());
            if !urgent && self.due.is_some_and(|due| soon < due) {
                return Ok(());
            }
            self.mode = estimate.mode;
            self.faults.clear();
            self.faults.extend(kinds());
            live.info.update
        };
        // Steps of the period keep the rate; after a pause it starts anew.
        self.due = Some(match self.due {
            Some(due) if due <= soon && soon < due + update => due + update,
            Some(due) if soon < due => due,
            _ => now + update,
        });
        let values: Vec<_> = horizon.signalled().into();
        let changed: BTreeMap<&str, &Variant<'_>> = values
            .iter()
            .enumerate()
            .filter(|(i, (_, value))| self.values.get(*i).is_none_or(|(_, old)| !same(old, value)))
            .map(|(_, (name, value))| (*name, value))
            .collect();
        if !changed.is_empty() {
            const PROPERTIES: &str = "org.freedesktop.DBus.Properties";
            let body = (HORIZON, &changed, &[] as &[&str]);
            connection.emit_signal(None::<&str>, PATH, PROPERTIES, "PropertiesChanged", &body).await?;
        }
        self.values = values;
        Ok(())
    }
}

/// Whether a client sees no difference: NaN is the same as NaN.
fn same(a: &Variant<'_>, b: &Variant<'_>) -> bool {
    match (a, b) {
        (Variant::F64(a), Variant::F64(b)) => a.to_bits() == b.to_bits(),
        _ => a == b,
    }
}
