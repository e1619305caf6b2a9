//! Image that counts the instructions of every control step over the rides of `rides.bin` and of every call of the
//! motor loop, with their stack use; then the instructions of some functions.
//!
//! Under `-icount shift=10` an instruction lasts 1.024 us, 172 counts of SysTick, so that a difference of counts is a
//! whole number of instructions. Instructions are not cycles: QEMU has no flash wait states and no multi-cycle
//! divisions.
#![no_std]
#![no_main]

use control::wire::{FRAME_BYTES, decode_frame};
use control::{Command, Plan, SensorFrame, State, step};
use core::fmt::{self, Display, Formatter};
use core::hint::black_box;
use core::sync::atomic::{Ordering, compiler_fence};
use cortex_m::Peripherals;
use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_semihosting::hprintln;
use firmware::board::Exit;
use firmware::board::functions::{self, ARGUMENTS};
use firmware::board::recording::{BLOCK, Recording};
use firmware::board::semihosting::exit;
use firmware::board::simulated_motor::SimulatedMotor;
use firmware::board::stack;
use firmware::failure;
use motor::example::EXAMPLE;
use motor::{Fault, Inputs, Mode, MotorCommand, Output};
use static_cell::ConstStaticCell;

static FRAMES: ConstStaticCell<[[u8; FRAME_BYTES]; BLOCK]> = ConstStaticCell::new([[0; FRAME_BYTES]; BLOCK]);

const RELOAD: u32 = 0x00ff_ffff;
const COUNTS_PER_INSTRUCTION: f32 = 168.0 * 1.024;

/// The step as the control task calls it: arguments by reference, result through memory.
#[inline(never)]
fn measured(plan: &Plan, state: &mut State, frame: &SensorFrame, command: &mut Option<Command>) {
    *command = Some(step(plan, state, frame));
}

#[inline(never)]
fn nothing(_: &Plan, _: &mut State, _: &SensorFrame, command: &mut Option<Command>) {
    black_box(command);
}

fn instructions(run: impl FnOnce()) -> u32 {
    let before = SYST::get_current();
    compiler_fence(Ordering::SeqCst);
    run();
    compiler_fence(Ordering::SeqCst);
    let counts = before.wrapping_sub(SYST::get_current()) & RELOAD;
    (counts as f32 / COUNTS_PER_INSTRUCTION + 0.5) as u32
}

#[inline(never)]
fn calling(call: &dyn Fn(usize, u32), which: usize, i: u32) -> u32 {
    instructions(|| call(which, i))
}

#[cortex_m_rt::entry]
fn main() -> ! {
    hprintln!("{}", firmware::identity!());
    failure::enable();
    let mut systick = Peripherals::take().expect("taken once").SYST;
    systick.set_clock_source(SystClkSource::Core);
    systick.set_reload(RELOAD);
    systick.clear_current();
    systick.enable_counter();

    let block = FRAMES.take();
    let mut recording = Recording::open();
    while let Some(mut ride) = recording.next_ride() {
        let (mut state, mut command) = (State::default(), None);
        let mut tally = Tally::default();
        loop {
            let frames = recording.next_block(&mut ride, block);
            if frames.is_empty() {
                break;
            }
            let top = stack::paint();
            for frame in frames {
                let frame = decode_frame(frame);
                let (plan, frame) = (black_box(&ride.plan), black_box(&frame));
                let around = instructions(|| nothing(plan, &mut state, frame, &mut command));
                let whole = instructions(|| measured(plan, &mut state, frame, &mut command));
                black_box(&command);
                tally.count(whole.saturating_sub(around));
            }
            tally.deep = tally.deep.max(stack::depth(top));
        }
        hprintln!("{}", tally);
    }
    let plan = EXAMPLE_ALIGNED.plan().expect("the example is a valid one");
    let mut turning = Tally::default();
    for (torque_nm, turns_s) in TURNS {
        let mut motor = Motor::new(&plan, turns_s);
        motor.run(&mut turning, TURNING, torque_nm, |_| ());
        assert!(
            motor.output.mode == Mode::Running,
            "{} mN m: {:?}",
            (1e3 * torque_nm) as i32,
            motor.output.faults
        );
    }
    hprintln!("motor {}", turning);
    let mut broken = Tally::default();
    for (fault, change) in FAULTS {
        let mut motor = Motor::new(&plan, 10.0);
        motor.run(&mut broken, BROKEN, 5.0, |_| ());
        motor.run(&mut broken, BROKEN, 5.0, change);
        assert!(motor.output.faults.has(fault), "{:?} but {:?}", fault, motor.output.faults);
    }
    hprintln!("motor {}", broken);
    functions::each(|name, call| {
        let count = |i| calling(call, 0, i).saturating_sub(calling(call, 1, i));
        let sum: u32 = (0..ARGUMENTS).map(count).sum();
        hprintln!("function {}, mean={}", name, (sum + ARGUMENTS / 2) / ARGUMENTS);
    });
    exit(Exit::Success)
}

/// Result of counting.
#[derive(Default)]
struct Tally {
    steps: u32,
    sum: u64,
    max: u32,
    /// Largest stack depth \[bytes\].
    deep: u32,
}

impl Tally {
    fn count(&mut self, instructions: u32) {
        (self.steps, self.sum) = (self.steps + 1, self.sum + u64::from(instructions));
        self.max = self.max.max(instructions);
    }
}

impl Display for Tally {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self { steps, sum, max, deep } = *self;
        write!(f, "steps={} mean={} max={} stack={}", steps, sum / u64::from(steps.max(1)), max, deep)
    }
}

/// The example motor on a bench with a known encoder offset.
const EXAMPLE_ALIGNED: motor::Config = motor::Config {
    encoder: motor::encoder::EncoderConfig { offset_turns: Some(0.0), ..EXAMPLE.encoder },
    ..EXAMPLE
};

/// Requested torques \[N m\] and motor speeds \[turns/s\]: the handlebar at up to 14.5 rad/s, the last beyond the bus
/// voltage.
const TURNS: [(f32, f32); 6] = [(0.0, 0.0), (5.0, 0.1), (3.0, -10.0), (-7.0, 20.0), (2.0, 46.0), (7.0, 83.0)];
/// Calls per operating point, and before and after each fault.
const TURNING: u32 = 4000;
const BROKEN: u32 = 400;

/// A change of the inputs.
type Change = fn(&mut Inputs);

/// Injected faults.
const FAULTS: [(Fault, Change); 9] = [
    (Fault::CurrentSensor, |i| i.phases = motor::Phases::Three([f32::NAN; 3])),
    (Fault::OverCurrent, |i| i.phases = motor::Phases::Three([20.0, -10.0, -10.0])),
    (Fault::CurrentTracking, |i| i.phases = motor::Phases::Three([0.1, 0.1, -0.2])),
    (Fault::CurrentSum, |i| i.phases = motor::Phases::Three([4.0, 4.0, 4.0])),
    (Fault::BusLow, |i| i.bus_v = 10.0),
    (Fault::Hot, |i| i.temperature_c = 110.0),
    (Fault::EncoderLost, |i| i.angle_age_calls = u16::MAX),
    (Fault::EncoderRange, |i| i.angle_counts = u16::MAX),
    (Fault::Command, |i| i.command = MotorCommand::Torque(f32::NAN)),
];

/// Motor loop and simulated motor.
struct Motor<'a> {
    plan: &'a motor::Plan,
    state: motor::State,
    rotor: SimulatedMotor,
    output: Output,
}

impl<'a> Motor<'a> {
    /// Ready: the offsets of the current sensors are measured.
    fn new(plan: &'a motor::Plan, turns_s: f32) -> Self {
        let rotor = SimulatedMotor::new(plan, turns_s);
        let mut motor = Self { plan, state: motor::State::default(), rotor, output: Output::default() };
        for _ in 0..=EXAMPLE.zero.samples {
            motor.output = motor::step(plan, &mut motor.state, &motor.rotor.inputs(plan, MotorCommand::Off));
            motor.rotor.advance(plan, &motor.output);
        }
        motor
    }

    /// Runs a number of calls with changed inputs.
    fn run(&mut self, tally: &mut Tally, calls: u32, torque_nm: f32, change: Change) {
        let top = stack::paint();
        for _ in 0..calls {
            let mut inputs = self.rotor.inputs(self.plan, MotorCommand::Torque(torque_nm));
            change(&mut inputs);
            let (plan, inputs) = (black_box(self.plan), black_box(&inputs));
            let around = instructions(|| no_call(plan, &mut self.state, inputs, &mut self.output));
            let whole = instructions(|| called(plan, &mut self.state, inputs, &mut self.output));
            black_box(&self.output);
            tally.count(whole.saturating_sub(around));
            self.rotor.advance(plan, &self.output);
        }
        tally.deep = tally.deep.max(stack::depth(top));
    }
}

/// The call as the motor interrupt makes it.
#[inline(never)]
fn called(plan: &motor::Plan, state: &mut motor::State, inputs: &Inputs, output: &mut Output) {
    *output = motor::step(plan, state, inputs);
}

#[inline(never)]
fn no_call(_: &motor::Plan, _: &mut motor::State, _: &Inputs, output: &mut Output) {
    black_box(output);
}
