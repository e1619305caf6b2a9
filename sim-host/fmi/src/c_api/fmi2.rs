//! FMI 2.0: `fmi2Functions.h`.

use super::*;

/// `fmi2CallbackFunctions`.
#[repr(C)]
pub struct Callbacks2 {
    logger: Option<Logger2>,
    allocate: Pointer,
    free: Pointer,
    step_finished: Pointer,
    environment: Pointer,
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetTypesPlatform() -> Text {
    c"default".as_ptr()
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetVersion() -> Text {
    c"2.0".as_ptr()
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetDebugLogging(
    c: Pointer,
    on: c_int,
    _n: usize,
    _categories: *const Text,
) -> c_int {
    log_events(c, on != 0)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Instantiate(
    name: Text,
    kind: c_int,
    guid: Text,
    resources: Text,
    callbacks: *const Callbacks2,
    _visible: c_int,
    logging: c_int,
) -> Pointer {
    // SAFETY: null or the importer's structure.
    let callbacks = unsafe { callbacks.as_ref() };
    let (logger, environment) =
        callbacks.map_or((None, null_mut()), |given| (given.logger, given.environment));
    let log = Log::V2(logger, environment, text(name).map(CStr::to_owned).unwrap_or_default());
    if kind != 1 {
        log.write(ERROR, "the FMU is for co-simulation, not for model exchange");
        return null_mut();
    }
    let folder = text(resources).and_then(|uri| folder_of(&uri.to_string_lossy()));
    instantiate(log, guid, folder, logging != 0)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeInstance(c: Pointer) {
    free_instance(c);
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetupExperiment(
    c: Pointer,
    _: c_int,
    _: f64,
    start: f64,
    _: c_int,
    _stop: f64,
) -> c_int {
    on(c, |handle| handle.instance.set_start(start))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2EnterInitializationMode(c: Pointer) -> c_int {
    on(c, |handle| handle.instance.enter())
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2ExitInitializationMode(c: Pointer) -> c_int {
    on(c, |handle| handle.instance.exit())
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Terminate(c: Pointer) -> c_int {
    terminate(c)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Reset(c: Pointer) -> c_int {
    on(c, |handle| handle.instance.reset())
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetReal(c: Pointer, vr: *const u32, n: usize, values: *mut f64) -> c_int {
    get(c, (vr, n), (values, n), real, |x| x)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetInteger(c: Pointer, vr: *const u32, n: usize, values: *mut i32) -> c_int {
    get(c, (vr, n), (values, n), integer_or_choice, |x| x as i32)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetBoolean(c: Pointer, vr: *const u32, n: usize, values: *mut c_int) -> c_int {
    get(c, (vr, n), (values, n), boolean, |x| c_int::from(x != 0.0))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetReal(c: Pointer, vr: *const u32, n: usize, values: *const f64) -> c_int {
    set(c, (vr, n), (values, n), real, |x| x)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetInteger(c: Pointer, vr: *const u32, n: usize, values: *const i32) -> c_int {
    set(c, (vr, n), (values, n), integer_or_choice, f64::from)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetBoolean(c: Pointer, vr: *const u32, n: usize, values: *const c_int) -> c_int {
    set(c, (vr, n), (values, n), boolean, |x| f64::from(u8::from(x != 0)))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetFMUstate(c: Pointer, state: *mut Pointer) -> c_int {
    get_state(c, state)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetFMUstate(c: Pointer, state: Pointer) -> c_int {
    set_state(c, state)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeFMUstate(c: Pointer, state: *mut Pointer) -> c_int {
    free_state(c, state)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializedFMUstateSize(c: Pointer, state: Pointer, size: *mut usize) -> c_int {
    state_size(c, state, size)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializeFMUstate(
    c: Pointer,
    state: Pointer,
    bytes: *mut u8,
    size: usize,
) -> c_int {
    serialize(c, state, bytes, size)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DeSerializeFMUstate(
    c: Pointer,
    bytes: *const u8,
    size: usize,
    state: *mut Pointer,
) -> c_int {
    deserialize(c, bytes, size, state)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DoStep(c: Pointer, now: f64, step: f64, _no_set_state_prior: c_int) -> c_int {
    do_step(c, now, step)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetRealStatus(c: Pointer, kind: c_int, value: *mut f64) -> c_int {
    // 2: the time of the last successful step.
    if kind != 2 {
        return DISCARD;
    }
    on(c, |handle| {
        put(value, handle.instance.time_s());
        Ok(())
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetBooleanStatus(_c: Pointer, kind: c_int, value: *mut c_int) -> c_int {
    // 3: whether the simulation is to be ended.
    if kind != 3 {
        return DISCARD;
    }
    put(value, 0);
    OK
}

refused! {
    fmi2GetString(_vr: *const u32, _n: usize, _values: *mut Text);
    fmi2SetString(_vr: *const u32, _n: usize, _values: *const Text);
    fmi2GetDirectionalDerivative(_z: *const u32, _nz: usize, _v: *const u32, _nv: usize, _dv: *const f64, _dz: *mut f64);
    fmi2SetRealInputDerivatives(_vr: *const u32, _n: usize, _order: *const c_int, _values: *const f64);
    fmi2GetRealOutputDerivatives(_vr: *const u32, _n: usize, _order: *const c_int, _values: *mut f64);
    fmi2CancelStep();
    fmi2GetStatus(_kind: c_int, _value: *mut c_int);
    fmi2GetIntegerStatus(_kind: c_int, _value: *mut i32);
    fmi2GetStringStatus(_kind: c_int, _value: *mut Text);
}
