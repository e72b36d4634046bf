//! What an endpoint tells of: the newest frame's words.

use crate::attitude::Attitude;
use crate::fault::ActiveFault;
use crate::head::Head;
use crate::state::{Moment, Snapshot};
use std::sync::Arc;

/// What is told, copied out of the shared state: a few words and the list of faults.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Seen {
    /// The attitude, and of which frame.
    pub moment: Moment,
    /// The contrast, K.
    pub contrast_k: Option<f64>,
    /// Who names what faults speak of.
    pub head: Arc<Head>,
    /// What speaks against it.
    pub faults: Vec<ActiveFault>,
    /// What was learnt of the trim beyond the configured one, rad.
    pub trim: Attitude,
    /// The yaw that goes out beside the attitude, rad, from another source: not of the snapshot, the caller's to set.
    pub yaw: Option<f32>,
}

impl Seen {
    /// Takes in a snapshot; allocates only when there are more faults than ever before.
    pub fn copy(&mut self, snapshot: &Snapshot) {
        let estimate = &snapshot.estimate;
        self.moment = snapshot.moment();
        self.contrast_k = estimate.contrast_k;
        self.trim = estimate.trim;
        self.head = Arc::clone(&snapshot.head);
        self.faults.clone_from(&estimate.faults);
    }
}
