//! Ctrl-C and other signals during a call of the core.

use std::cell::{Cell, RefCell};

use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;

use crate::fork;

thread_local! {
    /// The exception that a signal handler raised during the current call.
    static RAISED: RefCell<Option<PyErr>> = const { RefCell::new(None) };
    /// The generation of this process, and whether this thread is the main one in it. A fork may change this.
    static IS_MAIN: Cell<(usize, bool)> = const { Cell::new((0, false)) };
}

/// Runs the handlers of the signals that have arrived. Returns true if one of them raised an exception, which
/// [`exception`] then returns. Python runs signal handlers on the main thread only.
pub fn handle_signals() -> bool {
    let (generation, is_main) = IS_MAIN.get();
    if generation == fork::generation() && !is_main {
        return false;
    }
    let raised = Python::try_attach(|py| {
        if generation != fork::generation() {
            IS_MAIN.set((fork::generation(), is_main_thread(py)?));
        }
        py.check_signals()
    });
    let Some(Err(error)) = raised else { return false };
    RAISED.set(Some(error));
    true
}

/// Returns the exception that ended the current call.
pub fn exception() -> PyErr {
    RAISED.take().unwrap_or_else(|| PyKeyboardInterrupt::new_err(()))
}

fn is_main_thread(py: Python<'_>) -> PyResult<bool> {
    let threading = py.import("threading")?;
    threading.call_method0("get_ident")?.eq(threading.call_method0("main_thread")?.getattr("ident")?)
}
