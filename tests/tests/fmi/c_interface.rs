//! The C interface, called as an importer does, without one.
#![allow(unsafe_code, non_snake_case, reason = "calls of a C interface")]

use fmi::{MODEL_FILE, Role, Setup, token};
use sim_host::commands;
use sim_host::fmu::{Part, model};
use sim_host::scenario::Scenario;
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::ptr::{null, null_mut};
use tempfile::TempDir;

type Instance = *mut c_void;
type Logger = unsafe extern "C" fn(*mut c_void, c_int, *const c_char, *const c_char);

unsafe extern "C" {
    fn fmi3InstantiateCoSimulation(
        name: *const c_char,
        token: *const c_char,
        resources: *const c_char,
        visible: u8,
        logging: u8,
        event_mode: u8,
        early_return: u8,
        intermediate: *const u32,
        intermediate_count: usize,
        environment: *mut c_void,
        logger: Logger,
        update: *const c_void,
    ) -> Instance;
    fn fmi3FreeInstance(instance: Instance);
    fn fmi3EnterInitializationMode(c: Instance, _: u8, _: f64, start: f64, _: u8, stop: f64) -> c_int;
    fn fmi3ExitInitializationMode(c: Instance) -> c_int;
    fn fmi3SetFloat64(c: Instance, vr: *const u32, n: usize, values: *const f64, m: usize) -> c_int;
    fn fmi3GetFloat64(c: Instance, vr: *const u32, n: usize, values: *mut f64, m: usize) -> c_int;
    fn fmi3GetFloat32(c: Instance, vr: *const u32, n: usize, values: *mut f32, m: usize) -> c_int;
    fn fmi3GetFMUState(c: Instance, state: *mut *mut c_void) -> c_int;
    fn fmi3SetFMUState(c: Instance, state: *mut c_void) -> c_int;
    fn fmi3FreeFMUState(c: Instance, state: *mut *mut c_void) -> c_int;
    fn fmi3DoStep(
        c: Instance,
        now: f64,
        step: f64,
        keep: u8,
        event: *mut u8,
        end: *mut u8,
        early: *mut u8,
        last: *mut f64,
    ) -> c_int;
}

/// An FMU's resources, and the lines of its instances' logs.
struct Bench {
    resources: TempDir,
    setup: Setup,
    token: CString,
    log: Vec<String>,
}

unsafe extern "C" fn logger(bench: *mut c_void, _: c_int, _: *const c_char, text: *const c_char) {
    // SAFETY: the environment is a bench that outlives its instances, the text ends with a zero byte.
    let (bench, text) = unsafe { (bench.cast::<Bench>().as_mut(), CStr::from_ptr(text)) };
    bench.expect("the environment").log.push(text.to_string_lossy().into_owned());
}

impl Bench {
    fn new(part: Part, scenario: &str) -> Box<Self> {
        let resolved = commands::Setup::new(&Scenario::from_toml(scenario).unwrap()).unwrap();
        let setup = model(part, &resolved).unwrap();
        let resources = TempDir::new().unwrap();
        let variables = setup.table().unwrap().fingerprint();
        let file =
            serde_json::to_vec(&serde_json::json!({ "model": &setup, "variables": variables })).unwrap();
        std::fs::write(resources.path().join(MODEL_FILE), &file).unwrap();
        Box::new(Self { resources, setup, token: CString::new(token(&file)).unwrap(), log: Vec::new() })
    }

    fn instance(&mut self, token: &CStr) -> Instance {
        let resources = CString::new(self.resources.path().to_str().unwrap()).unwrap();
        let environment: *mut Self = self;
        // SAFETY: every pointer is valid during the call; the bench outlives the instance.
        unsafe {
            fmi3InstantiateCoSimulation(
                c"one".as_ptr(),
                token.as_ptr(),
                resources.as_ptr(),
                0,
                1,
                0,
                0,
                null(),
                0,
                environment.cast(),
                logger,
                null(),
            )
        }
    }

    fn running(&mut self) -> Instance {
        let instance = self.instance(&self.token.clone());
        assert!(!instance.is_null(), "{:?}", self.log);
        // SAFETY: the instance has just been made.
        unsafe {
            assert_eq!(fmi3EnterInitializationMode(instance, 0, 0.0, 0.0, 0, 0.0), 0);
            assert_eq!(fmi3ExitInitializationMode(instance), 0);
        }
        instance
    }

    /// Value reference of a variable.
    fn reference(&self, name: &str) -> u32 {
        let table = self.setup.table().unwrap();
        table.variables().iter().position(|variable| variable.name == name).expect(name) as u32
    }
}

fn step(instance: Instance, k: u32) -> c_int {
    let (mut flags, mut last) = ([7_u8; 3], 0.0);
    let [event, end, early] = &mut flags;
    // SAFETY: a living instance and places for the results.
    let status = unsafe { fmi3DoStep(instance, f64::from(k) * 1e-3, 1e-3, 1, event, end, early, &mut last) };
    assert_eq!(flags, [0; 3]);
    if status == 0 {
        assert_eq!(last, (f64::from(k + 1) * 1e6).round() / 1e9);
    }
    status
}

fn get(instance: Instance, reference: u32) -> f64 {
    let mut value = f64::NAN;
    // SAFETY: a living instance, one reference, room for one value.
    assert_eq!(unsafe { fmi3GetFloat64(instance, &reference, 1, &mut value, 1) }, 0);
    value
}

const RIDE: &str = "[start]\nspeed_m_s = 4\nsteer_rate_rad_s = 3";

/// Situation: a bicycle in 20 rides on four threads. Action: each instance is stepped 300 times, saved at 100 and restored at
/// 200. Must hold: all end in the same state as one that was never restored, having moved.
#[test]
fn saved_states_and_threads() {
    let rides = || {
        let mut bench = Bench::new(Part::Bicycle, RIDE);
        let roll = bench.reference("roll_rad");
        let instances: Vec<Instance> = (0..5).map(|_| bench.running()).collect();
        let mut ends = Vec::new();
        for (i, &instance) in instances.iter().enumerate() {
            let mut state = null_mut();
            for k in 0..300 {
                // SAFETY: a living instance and a place for its state.
                unsafe {
                    match k {
                        100 => assert_eq!(fmi3GetFMUState(instance, &mut state), 0),
                        200 if i > 0 => {
                            assert_eq!(fmi3SetFMUState(instance, state), 0);
                            (100..200).for_each(|k| assert_eq!(step(instance, k), 0));
                        }
                        _ => {}
                    }
                }
                assert_eq!(step(instance, k), 0);
            }
            ends.push(get(instance, roll));
            // SAFETY: freed once each.
            unsafe {
                assert_eq!(fmi3FreeFMUState(instance, &mut state), 0);
                fmi3FreeInstance(instance);
            }
            assert!(state.is_null());
        }
        assert_eq!(bench.log, [""; 0]);
        ends
    };
    let threads: Vec<_> = (0..4).map(|_| std::thread::spawn(rides)).collect();
    let ends: Vec<f64> = threads.into_iter().flat_map(|thread| thread.join().unwrap()).collect();
    assert!(ends.len() == 20 && ends.iter().all(|end| *end == ends[0]), "{ends:?}");
    assert!((1e-3..1.0).contains(&ends[0].abs()), "{}", ends[0]);
}

/// Situation: importers with mistakes. Action: null pointers, other types, references that do not exist, numbers that are
/// none, a step before the start. Must hold: an error with one line in the log, and the instance goes on; without an instance,
/// an error.
#[test]
fn mistakes_of_importers() {
    let mut bench = Bench::new(Part::Controller, "");
    assert!(bench.instance(c"another").is_null());
    assert!(
        bench.log[0].contains("belongs to the token") && bench.log[0].contains("another"),
        "{:?}",
        bench.log
    );
    let instance = bench.running();
    let speed = bench.reference("front_wheel_m_s");
    let last = bench.setup.table().unwrap().variables().len() as u32;
    bench.log.clear();
    let mut small = [0.0_f32];
    // SAFETY: null pointers are part of the test: they are refused.
    unsafe {
        for status in [
            fmi3SetFloat64(instance, null(), 1, &3.0, 1),
            fmi3SetFloat64(instance, &speed, 1, null(), 1),
            fmi3SetFloat64(instance, &speed, 1, &f64::NAN, 1),
            fmi3SetFloat64(instance, &speed, 1, [1.0, 2.0].as_ptr(), 2),
            fmi3SetFloat64(instance, &last, 1, &3.0, 1),
            fmi3GetFloat32(instance, &speed, 1, small.as_mut_ptr(), 1),
            fmi3GetFMUState(instance, null_mut()),
            fmi3SetFMUState(instance, null_mut()),
            fmi3EnterInitializationMode(instance, 0, 0.0, 0.0, 0, 0.0),
            step(instance, 3),
        ] {
            assert_eq!(status, 3);
        }
        assert_eq!(fmi3SetFloat64(null_mut(), &speed, 1, &3.0, 1), 3);
        assert_eq!(fmi3SetFloat64(instance, null(), 0, null(), 0), 0);
        assert_eq!(fmi3SetFloat64(instance, &speed, 1, &3.0, 1), 0);
    }
    assert_eq!(bench.log.len(), 10, "{:?}", bench.log);
    assert!(bench.log[2].contains("front_wheel_m_s = NaN"), "{:?}", bench.log);
    assert!(bench.log[4].contains(&last.to_string()), "{:?}", bench.log);
    assert_eq!((step(instance, 0), get(instance, speed)), (0, 3.0));
    // SAFETY: freed once.
    unsafe { fmi3FreeInstance(instance) };
}

/// Situation: the controller's declared parameters. Action: compare with the crate's own table. Must hold: the same names in the
/// same order, each with a start value inside its range, and the law.
#[test]
fn parameters_are_those_of_the_crate() {
    let bench = Bench::new(Part::Controller, "preset = 'product'");
    let table = bench.setup.table().unwrap();
    let of = |role| &table.variables()[table.of(role)];
    let known: Vec<String> =
        sim_host::parameters::list(&control::Config::product()).into_iter().map(|(name, _)| name).collect();
    let declared: Vec<&str> = of(Role::Parameter).iter().map(|variable| variable.name.as_str()).collect();
    let without_switches = declared.iter().filter(|name| known.iter().any(|known| known == *name));
    assert!(without_switches.eq(known.iter().filter(|name| *name != "rate_hz")), "{declared:?}");
    for extra in declared.iter().filter(|name| !known.iter().any(|known| known == *name)) {
        let number = extra.strip_suffix("_on").is_some_and(|number| declared.contains(&number));
        assert!(
            number || ["law", "law_slope", "start_engaged", "start_speed_m_s"].contains(extra),
            "{extra}"
        );
    }
    for variable in of(Role::Parameter).iter().chain(of(Role::Input)) {
        variable.check(variable.start).unwrap();
    }
}
