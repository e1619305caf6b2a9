//! The functions of FMI 2.0 and 3.0 for co-simulation, over [`Instance`].
//!
//! No call panics across this border: a panic is caught, reported through the logger, and the instance refuses further calls.
#![allow(
    unsafe_code,
    non_snake_case,
    unreachable_pub,
    missing_docs,
    clippy::missing_safety_doc,
    clippy::too_many_arguments,
    reason = "a C interface: names, pointers and numbers of arguments are the standard's, which documents them. Only this \
              module of the crate has unsafe code: pointers that the standard says are valid for the call are read and written here"
)]

use crate::instance::{Instance, LogEntry, Snapshot};
use crate::variable::Kind;
use percent_encoding::percent_decode_str;
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::ptr::null_mut;
use std::slice;

/// Status numbers, the same in both versions.
const OK: c_int = 0;
const WARNING: c_int = 1;
const DISCARD: c_int = 2;
const ERROR: c_int = 3;

type Pointer = *mut c_void;
type Text = *const c_char;
/// `void logger(environment, instance name, status, category, message, ...)`: the message is a format.
type Logger2 = unsafe extern "C" fn(Pointer, Text, c_int, Text, Text, ...);
/// `void logger(environment, status, category, message)`.
type Logger3 = unsafe extern "C" fn(Pointer, c_int, Text, Text);

/// Where messages go.
enum Log {
    V2(Option<Logger2>, Pointer, CString),
    V3(Option<Logger3>, Pointer),
}

/// What the importer's pointer points to.
struct Handle {
    instance: Instance,
    log: Log,
    logs_events: bool,
    failed: bool,
}

impl Log {
    fn write(&self, status: c_int, text: &str) {
        let category = match status {
            ERROR => c"logStatusError",
            WARNING => c"logStatusWarning",
            _ => c"logEvents",
        };
        let message = |text: String| CString::new(text.replace('\0', " ")).unwrap_or_default();
        match self {
            Self::V2(Some(logger), environment, name) => {
                let format = message(text.replace('%', "%%"));
                // SAFETY: the importer's function, called as FMI 2.0 declares it, with texts that outlive the call.
                unsafe { logger(*environment, name.as_ptr(), status, category.as_ptr(), format.as_ptr()) }
            }
            Self::V3(Some(logger), environment) => {
                let text = message(text.into());
                // SAFETY: as above, for FMI 3.0.
                unsafe { logger(*environment, status, category.as_ptr(), text.as_ptr()) }
            }
            Self::V2(None, ..) | Self::V3(None, _) => {}
        }
    }
}

/// Acts on an instance; an error goes to its logger.
fn on(pointer: Pointer, act: impl FnOnce(&mut Handle) -> Result<(), String>) -> c_int {
    // SAFETY: the importer passes what an instantiation returned and has not freed it, from one thread at a time.
    let Some(handle) = (unsafe { pointer.cast::<Handle>().as_mut() }) else { return ERROR };
    if handle.failed {
        handle.log.write(ERROR, "the instance ended with an internal error");
        return ERROR;
    }
    match catch_unwind(AssertUnwindSafe(|| act(handle))) {
        Ok(Ok(())) => OK,
        Ok(Err(reason)) => {
            handle.log.write(ERROR, &reason);
            ERROR
        }
        Err(_) => {
            handle.failed = true;
            handle.log.write(ERROR, "internal error");
            ERROR
        }
    }
}

/// The elements at a pointer.
fn elements<'a, T>(at: *const T, count: usize) -> Result<&'a [T], String> {
    if count == 0 {
        return Ok(&[]);
    }
    if at.is_null() {
        return Err("a pointer is null".into());
    }
    // SAFETY: not null; the importer says that there are so many.
    Ok(unsafe { slice::from_raw_parts(at, count) })
}

/// The elements at a pointer, to be written.
fn elements_mut<'a, T>(at: *mut T, count: usize) -> Result<&'a mut [T], String> {
    if count == 0 {
        return Ok(&mut []);
    }
    if at.is_null() {
        return Err("a pointer is null".into());
    }
    // SAFETY: not null; the importer says that there is room for so many.
    Ok(unsafe { slice::from_raw_parts_mut(at, count) })
}

/// A text of the importer.
fn text<'a>(at: Text) -> Option<&'a CStr> {
    // SAFETY: if it is not null it is a text that ends with a zero byte.
    (!at.is_null()).then(|| unsafe { CStr::from_ptr(at) })
}

/// Writes one value to the place that the importer gives.
fn put<T>(at: *mut T, value: T) {
    // SAFETY: null or a place for such a value.
    if let Some(place) = unsafe { at.as_mut() } {
        *place = value;
    }
}

fn get<T>(
    pointer: Pointer,
    (references, count): (*const u32, usize),
    (values, room): (*mut T, usize),
    accepted: fn(Kind) -> bool,
    of: fn(f64) -> T,
) -> c_int {
    on(pointer, |handle| {
        let references = elements(references, count)?;
        let values = elements_mut(values, room)?;
        if references.len() != values.len() {
            return Err(format!("{count} value references, but room for {room} values"));
        }
        for (reference, value) in references.iter().zip(values) {
            *value = of(handle.instance.get(*reference, accepted)?);
        }
        Ok(())
    })
}

fn set<T: Copy>(
    pointer: Pointer,
    (references, count): (*const u32, usize),
    (values, given): (*const T, usize),
    accepted: fn(Kind) -> bool,
    of: fn(T) -> f64,
) -> c_int {
    on(pointer, |handle| {
        let references = elements(references, count)?;
        let values = elements(values, given)?;
        if references.len() != values.len() {
            return Err(format!("{count} value references, but {given} values"));
        }
        references
            .iter()
            .zip(values)
            .try_for_each(|(reference, value)| handle.instance.set(*reference, accepted, of(*value)))
    })
}

fn real(kind: Kind) -> bool {
    kind == Kind::Real
}
fn integer(kind: Kind) -> bool {
    kind == Kind::Integer
}
fn boolean(kind: Kind) -> bool {
    kind == Kind::Boolean
}
fn choice(kind: Kind) -> bool {
    matches!(kind, Kind::Choice(_))
}
fn integer_or_choice(kind: Kind) -> bool {
    integer(kind) || choice(kind)
}

/// An instance as the importer's pointer; null, and a line in the log, if it can't be made.
fn instantiate(log: Log, token: Text, resources: Option<PathBuf>, logs_events: bool) -> Pointer {
    let made = catch_unwind(|| {
        let token = text(token).ok_or("no instantiation token")?.to_string_lossy();
        let resources = resources.ok_or("no path of the resources")?;
        Instance::new(&token, &resources)
    });
    match made {
        Ok(Ok(instance)) => {
            Box::into_raw(Box::new(Handle { instance, log, logs_events, failed: false })).cast()
        }
        Ok(Err(reason)) => {
            log.write(ERROR, &reason);
            null_mut()
        }
        Err(_) => {
            log.write(ERROR, "internal error");
            null_mut()
        }
    }
}

fn free_instance(pointer: Pointer) {
    if !pointer.is_null() {
        // SAFETY: from `instantiate`, freed once.
        drop(unsafe { Box::from_raw(pointer.cast::<Handle>()) });
    }
}

fn log_events(pointer: Pointer, logs_events: bool) -> c_int {
    on(pointer, |handle| {
        handle.logs_events = logs_events;
        Ok(())
    })
}

fn terminate(pointer: Pointer) -> c_int {
    on(pointer, |handle| {
        handle.instance.terminate();
        Ok(())
    })
}

fn do_step(pointer: Pointer, now_s: f64, step_s: f64) -> c_int {
    on(pointer, |handle| {
        for entry in handle.instance.step(now_s, step_s)? {
            match entry {
                LogEntry::Warning(warning) => handle.log.write(WARNING, &warning),
                LogEntry::Event(event) if handle.logs_events => handle.log.write(OK, &event),
                LogEntry::Event(_) => {}
            }
        }
        Ok(())
    })
}

fn get_state(pointer: Pointer, state: *mut Pointer) -> c_int {
    on(pointer, |handle| {
        // SAFETY: a place for a pointer, which is null or a state of `get_state`.
        let place = unsafe { state.as_mut() }.ok_or("a pointer is null")?;
        let saved = handle.instance.save();
        // SAFETY: as above.
        match unsafe { place.cast::<Snapshot>().as_mut() } {
            Some(old) => *old = saved,
            None => *place = Box::into_raw(Box::new(saved)).cast(),
        }
        Ok(())
    })
}

fn saved<'a>(state: Pointer) -> Result<&'a Snapshot, String> {
    // SAFETY: null or a state of `get_state` or `deserialize` that has not been freed.
    unsafe { state.cast::<Snapshot>().as_ref() }.ok_or_else(|| "no state".into())
}

fn set_state(pointer: Pointer, state: Pointer) -> c_int {
    on(pointer, |handle| handle.instance.restore(saved(state)?))
}

fn free_state(pointer: Pointer, state: *mut Pointer) -> c_int {
    on(pointer, |_| {
        // SAFETY: null or a place with a pointer, which is null or a state that has not been freed.
        if let Some(place) = unsafe { state.as_mut() }
            && !place.is_null()
        {
            // SAFETY: as above.
            drop(unsafe { Box::from_raw(place.cast::<Snapshot>()) });
            *place = null_mut();
        }
        Ok(())
    })
}

fn state_size(pointer: Pointer, state: Pointer, size: *mut usize) -> c_int {
    on(pointer, |handle| {
        put(size, handle.instance.serialize(saved(state)?)?.len());
        Ok(())
    })
}

fn serialize(pointer: Pointer, state: Pointer, bytes: *mut u8, size: usize) -> c_int {
    on(pointer, |handle| {
        let state = handle.instance.serialize(saved(state)?)?;
        let room = elements_mut(bytes, size)?;
        let needed = state.len();
        room.get_mut(..needed)
            .ok_or(format!("{size} bytes are too few: the state has {needed}"))?
            .copy_from_slice(&state);
        Ok(())
    })
}

fn deserialize(pointer: Pointer, bytes: *const u8, size: usize, state: *mut Pointer) -> c_int {
    on(pointer, |handle| {
        let read = handle.instance.deserialize(elements(bytes, size)?)?;
        put(state, Box::into_raw(Box::new(read)).cast());
        Ok(())
    })
}

/// The folder of a URI `file:/...`, `file:///...` or `file://localhost/...`.
fn folder_of(uri: &str) -> Option<PathBuf> {
    let rest = uri.strip_prefix("file:")?;
    let rest = rest.strip_prefix("//localhost").or(rest.strip_prefix("//")).unwrap_or(rest);
    let path = percent_decode_str(rest).decode_utf8().ok()?;
    // A drive's letter follows the slash on Windows.
    let drive = path.strip_prefix('/').filter(|rest| rest.as_bytes().get(1) == Some(&b':'));
    Some(Path::new(drive.unwrap_or(&path)).into())
}

/// Functions for what the models do not have: they are refused by name.
macro_rules! refused {
    ($($name:ident($($arg:ident: $type:ty),*);)*) => {
        $(
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn $name(instance: Pointer, $($arg: $type),*) -> c_int {
                $(let _ = $arg;)*
                on(instance, |_| Err(concat!(stringify!($name), ": the model has nothing of the kind").into()))
            }
        )*
    };
}

/// Getters and setters for types that no variable has: every call is an error.
macro_rules! untyped {
    ($($get:ident $set:ident $type:ty;)*) => {
        refused! {
            $(
                $get(_vr: *const u32, _n: usize, _values: *mut $type, _m: usize);
                $set(_vr: *const u32, _n: usize, _values: *const $type, _m: usize);
            )*
        }
    };
}

mod fmi2;
mod fmi3;
