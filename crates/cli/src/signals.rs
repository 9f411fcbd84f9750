//! Signals: how a run is asked to stop, or to show what it has.
//!
//! A render that is asked to stop (Ctrl-C, SIGTERM) finishes its pass and writes its picture; asked a second time it quits
//! at once. SIGHUP asks for the picture so far, as with Mitsuba. Everything else, and a render that is still loading, has
//! nothing to save and quits at once. Quitting removes what is unfinished, so there are never half files.
//!
//! The crate `signal-hook` rather than `ctrlc`, because the latter does not tell SIGHUP from SIGTERM. On systems other than
//! Unix, nothing is installed, and the system ends the process.

use std::sync::atomic::{AtomicBool, Ordering};

/// The exit code of a render that was stopped early and whose picture is good: `EX_TEMPFAIL`, upon which schedulers retry.
pub(crate) const STOPPED: u8 = 75;

static WORKS_IN_PASSES: AtomicBool = AtomicBool::new(false);
static STOP: AtomicBool = AtomicBool::new(false);
static SHOW: AtomicBool = AtomicBool::new(false);

/// Begins to listen.
///
/// # Errors
/// The system refuses handlers or a thread.
#[cfg(unix)]
pub(crate) fn listen() -> std::io::Result<()> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    /// The exit code of a run that quit at once: 128 + SIGINT, as shells have it.
    const QUIT: i32 = 130;

    let mut signals = signal_hook::iterator::Signals::new([SIGINT, SIGTERM, SIGHUP])?;
    std::thread::Builder::new().name("signals".to_owned()).spawn(move || {
        for signal in signals.forever() {
            let has_passes = WORKS_IN_PASSES.load(Ordering::SeqCst);
            if has_passes && signal == SIGHUP {
                SHOW.store(true, Ordering::SeqCst);
            } else if !has_passes || STOP.swap(true, Ordering::SeqCst) {
                gonio_io::whole_file::discard_unfinished();
                signal_hook::low_level::exit(QUIT);
            }
        }
    })?;
    Ok(())
}

/// Nothing to listen to.
#[cfg(not(unix))]
pub(crate) fn listen() -> std::io::Result<()> {
    Ok(())
}

/// From now on, until the process ends, passes are finished before it stops: the caller asks [`stop`] after each.
pub(crate) fn work_in_passes() {
    WORKS_IN_PASSES.store(true, Ordering::SeqCst);
}

/// Whether the run is asked to stop.
pub(crate) fn stop() -> bool {
    STOP.load(Ordering::SeqCst)
}

/// Whether the run was asked to show what it has, since this was last asked.
pub(crate) fn show() -> bool {
    SHOW.swap(false, Ordering::SeqCst)
}
