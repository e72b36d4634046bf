//! What D-Bus may ask of the daemon.

use crate::config::Loaded;
use crate::ctl::view::Endpoint;
use crate::dbus::{Control, ServiceInfo};
use crate::mavlink::switchboard::Switchboard;
use signal_hook::consts::SIGHUP;
use signal_hook::low_level::raise;
use std::mem;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};

/// The daemon as the D-Bus service sees it.
pub struct Desk {
    info: Mutex<Arc<ServiceInfo>>,
    mavlink: Arc<Switchboard>,
    /// Who waits for the outcome of a reload.
    waiting: Mutex<Vec<SyncSender<Result<(), String>>>>,
}

impl Desk {
    /// For a daemon that runs with `loaded`.
    pub fn new(loaded: &Loaded, mavlink: Arc<Switchboard>) -> Self {
        Self { info: Mutex::new(info(loaded)), mavlink, waiting: Mutex::default() }
    }

    /// A new configuration holds.
    pub fn configure(&self, loaded: &Loaded) {
        *self.info.lock().unwrap_or_else(PoisonError::into_inner) = info(loaded);
    }

    /// Does `reload` and tells its outcome to those who had asked before it began. Who asks meanwhile waits for the
    /// next one: this one may have read the configuration already.
    pub fn answer(&self, reload: impl FnOnce() -> Result<(), String>) {
        let askers = mem::take(&mut *self.waiting.lock().unwrap_or_else(PoisonError::into_inner));
        let outcome = reload();
        for asker in askers {
            let _ = asker.try_send(outcome.clone());
        }
    }
}

fn info(loaded: &Loaded) -> Arc<ServiceInfo> {
    Arc::new(ServiceInfo::new(&loaded.settings))
}

impl Control for Desk {
    fn info(&self) -> Arc<ServiceInfo> {
        Arc::clone(&self.info.lock().unwrap_or_else(PoisonError::into_inner))
    }

    fn endpoints(&self) -> Vec<Endpoint> {
        self.mavlink.endpoints()
    }

    /// The same way as `systemctl reload`: a hangup to ourselves, seen by the main thread.
    fn reload(&self) -> Receiver<Result<(), String>> {
        let (asker, outcome) = sync_channel(1);
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner).push(asker);
        if let Err(e) = raise(SIGHUP) {
            self.answer(|| Err(format!("the daemon could not be told to reload: {e}")));
        }
        outcome
    }
}

/// The same for a change that was asked for by MAVLink.
pub fn hang_up() {
    if let Err(e) = raise(SIGHUP) {
        log::error!("the daemon could not be told of a change: {e}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Settings;
    use signal_hook::flag::register;
    use std::sync::mpsc::TryRecvError;

    #[test]
    fn who_asks_during_a_reload_is_told_of_the_next_one() {
        // Without a handler the hangup would end the tests.
        register(SIGHUP, Arc::default()).unwrap();
        let settings = Settings::default();
        let mavlink = Arc::new(Switchboard::sending(settings.clone()));
        let loaded = Loaded { settings, text: String::new(), files: Vec::new(), warnings: Vec::new() };
        let desk = Desk::new(&loaded, mavlink);
        let (first, mut second) = (desk.reload(), None);
        desk.answer(|| {
            second = Some(desk.reload());
            Ok(())
        });
        let second = second.unwrap();
        assert_eq!((first.try_recv(), second.try_recv()), (Ok(Ok(())), Err(TryRecvError::Empty)));
        desk.answer(|| Err("line 3".into()));
        assert_eq!(second.try_recv(), Ok(Err("line 3".into())));
    }
}
