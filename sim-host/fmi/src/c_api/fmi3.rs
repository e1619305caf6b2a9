//! FMI 3.0: `fmi3Functions.h`.

use super::*;

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetVersion() -> Text {
    c"3.0".as_ptr()
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetDebugLogging(
    c: Pointer,
    on: u8,
    _n: usize,
    _categories: *const Text,
) -> c_int {
    log_events(c, on != 0)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateCoSimulation(
    _name: Text,
    token: Text,
    resources: Text,
    _visible: u8,
    logging: u8,
    _event_mode: u8,
    _early_return: u8,
    _intermediate: *const u32,
    _intermediate_count: usize,
    environment: Pointer,
    logger: Option<Logger3>,
    _update: Pointer,
) -> Pointer {
    let folder = text(resources).map(|path| PathBuf::from(path.to_string_lossy().into_owned()));
    instantiate(Log::V3(logger, environment), token, folder, logging != 0)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateModelExchange(
    _name: Text,
    _token: Text,
    _resources: Text,
    _visible: u8,
    _logging: u8,
    environment: Pointer,
    logger: Option<Logger3>,
) -> Pointer {
    Log::V3(logger, environment).write(ERROR, "the FMU is for co-simulation, not for model exchange");
    null_mut()
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateScheduledExecution(
    _name: Text,
    _token: Text,
    _resources: Text,
    _visible: u8,
    _logging: u8,
    environment: Pointer,
    logger: Option<Logger3>,
    _clock: Pointer,
    _lock: Pointer,
    _unlock: Pointer,
) -> Pointer {
    Log::V3(logger, environment).write(ERROR, "the FMU is for co-simulation, not for scheduled execution");
    null_mut()
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeInstance(c: Pointer) {
    free_instance(c);
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EnterInitializationMode(
    c: Pointer,
    _: u8,
    _: f64,
    start: f64,
    _: u8,
    _stop: f64,
) -> c_int {
    on(c, |handle| {
        handle.instance.set_start(start)?;
        handle.instance.enter()
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3ExitInitializationMode(c: Pointer) -> c_int {
    on(c, |handle| handle.instance.exit())
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3Terminate(c: Pointer) -> c_int {
    terminate(c)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3Reset(c: Pointer) -> c_int {
    on(c, |handle| handle.instance.reset())
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetFloat64(
    c: Pointer,
    vr: *const u32,
    n: usize,
    values: *mut f64,
    m: usize,
) -> c_int {
    get(c, (vr, n), (values, m), real, |x| x)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetInt32(
    c: Pointer,
    vr: *const u32,
    n: usize,
    values: *mut i32,
    m: usize,
) -> c_int {
    get(c, (vr, n), (values, m), integer, |x| x as i32)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetInt64(
    c: Pointer,
    vr: *const u32,
    n: usize,
    values: *mut i64,
    m: usize,
) -> c_int {
    get(c, (vr, n), (values, m), choice, |x| x as i64)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetBoolean(
    c: Pointer,
    vr: *const u32,
    n: usize,
    values: *mut u8,
    m: usize,
) -> c_int {
    get(c, (vr, n), (values, m), boolean, |x| u8::from(x != 0.0))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetFloat64(
    c: Pointer,
    vr: *const u32,
    n: usize,
    values: *const f64,
    m: usize,
) -> c_int {
    set(c, (vr, n), (values, m), real, |x| x)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetInt32(
    c: Pointer,
    vr: *const u32,
    n: usize,
    values: *const i32,
    m: usize,
) -> c_int {
    set(c, (vr, n), (values, m), integer, f64::from)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetInt64(
    c: Pointer,
    vr: *const u32,
    n: usize,
    values: *const i64,
    m: usize,
) -> c_int {
    set(c, (vr, n), (values, m), choice, |x| x as f64)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetBoolean(
    c: Pointer,
    vr: *const u32,
    n: usize,
    values: *const u8,
    m: usize,
) -> c_int {
    set(c, (vr, n), (values, m), boolean, |x| f64::from(u8::from(x != 0)))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetFMUState(c: Pointer, state: *mut Pointer) -> c_int {
    get_state(c, state)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetFMUState(c: Pointer, state: Pointer) -> c_int {
    set_state(c, state)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeFMUState(c: Pointer, state: *mut Pointer) -> c_int {
    free_state(c, state)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SerializedFMUStateSize(c: Pointer, state: Pointer, size: *mut usize) -> c_int {
    state_size(c, state, size)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SerializeFMUState(
    c: Pointer,
    state: Pointer,
    bytes: *mut u8,
    size: usize,
) -> c_int {
    serialize(c, state, bytes, size)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3DeserializeFMUState(
    c: Pointer,
    bytes: *const u8,
    size: usize,
    state: *mut Pointer,
) -> c_int {
    deserialize(c, bytes, size, state)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3DoStep(
    c: Pointer,
    now: f64,
    step: f64,
    _no_set_state_prior: u8,
    event_needed: *mut u8,
    terminate: *mut u8,
    early_return: *mut u8,
    last_time: *mut f64,
) -> c_int {
    [event_needed, terminate, early_return].into_iter().for_each(|flag| put(flag, 0));
    let status = do_step(c, now, step);
    on(c, |handle| {
        put(last_time, handle.instance.time_s());
        Ok(())
    });
    status
}

untyped! {
    fmi3GetFloat32 fmi3SetFloat32 f32;
    fmi3GetInt8 fmi3SetInt8 i8;
    fmi3GetUInt8 fmi3SetUInt8 u8;
    fmi3GetInt16 fmi3SetInt16 i16;
    fmi3GetUInt16 fmi3SetUInt16 u16;
    fmi3GetUInt32 fmi3SetUInt32 u32;
    fmi3GetUInt64 fmi3SetUInt64 u64;
    fmi3GetString fmi3SetString Text;
}

refused! {
    fmi3EnterEventMode();
    fmi3EnterConfigurationMode();
    fmi3ExitConfigurationMode();
    fmi3EnterContinuousTimeMode();
    fmi3EnterStepMode();
    fmi3EvaluateDiscreteStates();
    fmi3GetBinary(_vr: *const u32, _n: usize, _sizes: *mut usize, _values: *mut Pointer, _m: usize);
    fmi3SetBinary(_vr: *const u32, _n: usize, _sizes: *const usize, _values: *const Pointer, _m: usize);
    fmi3GetClock(_vr: *const u32, _n: usize, _values: *mut u8);
    fmi3SetClock(_vr: *const u32, _n: usize, _values: *const u8);
    fmi3GetNumberOfVariableDependencies(_vr: u32, _count: *mut usize);
    fmi3GetVariableDependencies(_vr: u32, _a: *mut usize, _b: *mut u32, _c: *mut usize, _d: *mut c_int, _n: usize);
    fmi3GetDirectionalDerivative(_z: *const u32, _nz: usize, _v: *const u32, _nv: usize, _dv: *const f64, _n: usize, _dz: *mut f64, _m: usize);
    fmi3GetAdjointDerivative(_z: *const u32, _nz: usize, _v: *const u32, _nv: usize, _dz: *const f64, _n: usize, _dv: *mut f64, _m: usize);
    fmi3GetOutputDerivatives(_vr: *const u32, _n: usize, _orders: *const i32, _values: *mut f64, _m: usize);
    fmi3GetIntervalDecimal(_vr: *const u32, _n: usize, _intervals: *mut f64, _qualifiers: *mut c_int);
    fmi3GetIntervalFraction(_vr: *const u32, _n: usize, _counters: *mut u64, _resolutions: *mut u64, _qualifiers: *mut c_int);
    fmi3GetShiftDecimal(_vr: *const u32, _n: usize, _shifts: *mut f64);
    fmi3GetShiftFraction(_vr: *const u32, _n: usize, _counters: *mut u64, _resolutions: *mut u64);
    fmi3SetIntervalDecimal(_vr: *const u32, _n: usize, _intervals: *const f64);
    fmi3SetIntervalFraction(_vr: *const u32, _n: usize, _counters: *const u64, _resolutions: *const u64);
    fmi3SetShiftDecimal(_vr: *const u32, _n: usize, _shifts: *const f64);
    fmi3SetShiftFraction(_vr: *const u32, _n: usize, _counters: *const u64, _resolutions: *const u64);
    fmi3UpdateDiscreteStates(_a: *mut u8, _b: *mut u8, _c: *mut u8, _d: *mut u8, _e: *mut u8, _f: *mut f64);
    fmi3CompletedIntegratorStep(_no_set: u8, _event: *mut u8, _terminate: *mut u8);
    fmi3SetTime(_time: f64);
    fmi3SetContinuousStates(_values: *const f64, _n: usize);
    fmi3GetContinuousStateDerivatives(_values: *mut f64, _n: usize);
    fmi3GetEventIndicators(_values: *mut f64, _n: usize);
    fmi3GetContinuousStates(_values: *mut f64, _n: usize);
    fmi3GetNominalsOfContinuousStates(_values: *mut f64, _n: usize);
    fmi3GetNumberOfEventIndicators(_count: *mut usize);
    fmi3GetNumberOfContinuousStates(_count: *mut usize);
    fmi3ActivateModelPartition(_clock: u32, _time: f64);
}
