//! Long computations: without the interpreter's lock, with progress, and stopped by Ctrl-C.

use crate::law::OwnFunction;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use sim_host::commands::Hooks;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// Interval between looks at signals and progress.
const EVERY: Duration = Duration::from_millis(50);

/// How a computation is run.
pub(crate) struct Options<'a, 'py> {
    /// Number of parts that are known at the start.
    pub(crate) parts: usize,
    /// Threads; `None` for one per core. A law that is a Python function and not compiled has one.
    pub(crate) threads: Option<usize>,
    /// Called with the numbers of finished and of all parts.
    pub(crate) progress: Option<&'a Bound<'py, PyAny>>,
    /// The law that is a function.
    pub(crate) law: Option<&'a OwnFunction>,
}

/// Runs `compute` on another thread and returns its result, and whether it was interrupted. Meanwhile the interpreter handles signals: an
/// exception of a handler, such as Ctrl-C's, or of `progress` stops the computation, which then returns what is finished.
///
/// # Errors
/// The exception of the law that is a function, or an exception other than that of Ctrl-C.
pub(crate) fn run<T: Send>(
    py: Python<'_>,
    options: &Options<'_, '_>,
    compute: impl FnOnce(Hooks) -> T + Send,
) -> PyResult<(T, bool)> {
    let (done, all) = (AtomicUsize::new(0), AtomicUsize::new(options.parts));
    let stop = AtomicBool::new(false);
    let law = options.law;
    let stopped = || stop.load(Ordering::Relaxed) || law.is_some_and(OwnFunction::failed);
    let interpreted = law.is_some_and(OwnFunction::interpreted);
    let pool = pool(if interpreted { Some(1) } else { options.threads })?;
    let (finished, ended) = channel();
    // Shared with the threads that wait for it, of which there is one at a time.
    let ended = Mutex::new(ended);
    let wait = || ended.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(EVERY);
    let mut exception = None;
    let result = std::thread::scope(|scope| {
        let (done, all) = (&done, &all);
        let pool = &pool;
        let stopped = &stopped;
        scope.spawn(move || {
            let hooks = Hooks {
                finished: &|| {
                    done.fetch_add(1, Ordering::Relaxed);
                },
                added: &|parts| {
                    all.fetch_add(parts, Ordering::Relaxed);
                },
                stop: stopped,
            };
            let computed = pool.install(|| {
                // Attached throughout: the calls of the law then cost no more than the calls.
                if interpreted { Python::attach(|_| compute(hooks)) } else { compute(hooks) }
            });
            // The receiver waits until the end.
            let _ = finished.send(computed);
        });
        loop {
            match py.detach(wait) {
                Ok(computed) => return Some(computed),
                Err(RecvTimeoutError::Disconnected) => return None,
                Err(RecvTimeoutError::Timeout) => {
                    if exception.is_none() {
                        exception = py.check_signals().and_then(|()| report(options, done, all)).err();
                        stop.store(exception.is_some(), Ordering::Relaxed);
                    }
                }
            }
        }
    });
    let computed =
        result.ok_or_else(|| pyo3::exceptions::PyRuntimeError::new_err("the computation failed"))?;
    if let Some(error) = law.and_then(OwnFunction::error) {
        return Err(error);
    }
    match exception.or_else(|| report(options, &done, &all).err()) {
        Some(error) if error.is_instance_of::<pyo3::exceptions::PyKeyboardInterrupt>(py) => {
            Ok((computed, true))
        }
        Some(error) => Err(error),
        None => Ok((computed, false)),
    }
}

fn report(options: &Options<'_, '_>, done: &AtomicUsize, all: &AtomicUsize) -> PyResult<()> {
    let numbers = (done.load(Ordering::Relaxed), all.load(Ordering::Relaxed));
    options.progress.map_or(Ok(()), |progress| progress.call1(numbers).map(drop))
}

fn pool(threads: Option<usize>) -> PyResult<ThreadPool> {
    let pool = ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build();
    pool.map_err(|error| pyo3::exceptions::PyRuntimeError::new_err(error.to_string()))
}
