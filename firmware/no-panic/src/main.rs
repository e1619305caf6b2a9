//! Links only when no public entry of `control`, `motor` and `devices`, and none of `link` but the store, has a panic
//! path:
//! the panic handler calls a symbol that does not exist, and the linker drops the handler only if nothing can
//! reach it. Never run.
//!
//! Left out are printing a `ParamError` and a `Rejection`, as core's own printing of f32 has assertions, and the store,
//! which has those of `sequential-storage`.
#![no_std]
#![no_main]
#![allow(unsafe_code)]

use control::law::path_tracking::{self, PathTracking, PathTrackingState, TrackingInput};
use control::safety::guard::{self, GuardPlan, GuardState};
use control::safety::limiter::{self, LimiterPlan, LimiterState, TorqueRequest};
use control::sensors::latency::{Aligned, History, Latency};
use control::sensors::wheel_speed::{self, WheelPulses, WheelPulsesConfig, WheelPulsesState};
use control::{
    ActiveLimits, CAUSES, Causes, Command, Config, GainSchedule, Law, Mode, Plan, Sample, SensorFrame, State,
    wire,
};
use core::hint::black_box;
use devices::vesc6::{BOARD_TEMPERATURE, GATE_DRIVER, MOTOR, RIDER_NM, SHUNT, STEER_RAD, SUPPLY};
use devices::wheel::{self, WheelState};
use devices::{as5047, bmi160, drv8301};
use link::alignment::{ALIGNMENT_BYTES, Alignment, Offset};
use link::can::{Frame, Message as CanMessage, Motion};
use link::can_bit_timing::bit_timing;
use link::can_mailbox::{Counts, Mailbox};
use link::fault_log::{self, RING_BYTES};
use link::lockstep::{FromBoard, MAX_CHUNK, ToBoard};
use link::message::Message;
use link::page::PAGE_BYTES;
use link::report::config_hash;
use link::{Decoder, TxQueue, requests};
use motor::command_word::{self, Deadline};

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    unsafe extern "C" {
        fn there_is_a_panic_path() -> !;
    }
    // SAFETY: never executed; an image with this call in it does not link.
    unsafe { there_is_a_panic_path() }
}

/// Uses a result where the optimiser can't see it.
fn used<T>(value: T) {
    let _ = black_box(value);
}

/// The linker's entry: every public function, each with input the compiler can't see.
#[unsafe(no_mangle)]
pub extern "C" fn _start() -> ! {
    loop {
        let config = configured();
        used((config.law.gain(black_box(1.0_f32)), config.law.gain(black_box(1.0_f64))));
        used((config.law.validate(), config.limits.validate()));
        used((wire::encode_config(&config), wire::config_bytes_used()));
        used((black_box(Mode::Off).name(), black_box(Causes::all(&CAUSES)).iter().count()));
        limits(&config);
        let mut history = black_box(History::default());
        used(history.align(&black_box(Latency::default()), black_box(Aligned::default())));
        pulses_of_a_wheel();
        motor();
        offset();
        board();
        engineer(config.clone());
        if let Ok(plan) = black_box(config).plan() {
            run(&black_box(plan));
        }
    }
}

/// The limiter and the guard, each of anything.
fn limits(config: &Config) {
    let (table, rate) = (black_box(config.limits), black_box(config.rate_hz));
    let (mut limiter_state, mut guard) =
        (black_box(LimiterState::default()), black_box(GuardState::default()));
    let request = black_box(TorqueRequest {
        wanted_nm: 0.0,
        authority: 0.0,
        limp: false,
        speed_low_m_s: 0.0,
        speed_high_m_s: 0.0,
        steer_rad: None,
        steer_rate_rad_s: None,
        rider_torque_nm: None,
        elapsed_us: 0,
    });
    let (torque, acted) =
        limiter::step(&table, &LimiterPlan::new(&table, rate), &mut limiter_state, &request);
    used((acted.contains(black_box(ActiveLimits::RATE)), limiter_state.torque_nm()));
    let plan = GuardPlan::new(&table, rate);
    used(guard::check(&table, &plan, &mut guard, torque, black_box(true), &request));
    let (follow, mut following) =
        (black_box(PathTracking::default()), black_box(PathTrackingState::default()));
    used((
        follow.cross(),
        path_tracking::step(&follow, &mut following, &black_box(TrackingInput::default())),
    ));
}

/// The configurations a user can come by: made in code, from a table of any length, from bytes.
fn configured() -> Config {
    let table = GainSchedule::new(black_box::<&[(f32, f32)]>(&[(0.0, 1.0)]));
    match (wire::decode_config(&black_box([0; wire::CONFIG_BYTES])), table) {
        (Ok(config), _) => config,
        (Err(_), Ok(table)) => Config::thesis(Law::Table(table)),
        (Err(_), Err(_)) => black_box(Config::product()),
    }
}

fn run(plan: &Plan) {
    let mut state = State::default();
    for _ in 0..black_box(1000) {
        let frame = wire::decode_frame(&black_box([0; wire::FRAME_BYTES]));
        used((wire::encode_frame(&frame), SensorFrame::missing(), Sample::fresh(black_box(0.0))));
        let command = control::step(black_box(plan), black_box(&mut state), &frame);
        used((wire::encode_command(&command), wire::decode_causes(&black_box([0; wire::CAUSE_BYTES]))));
        let first = command.causes.iter().next();
        #[cfg(feature = "unwrap")]
        let first = Some(first.unwrap());
        used((first, state.torque_nm(), plan.config().rate_hz, plan.ticks_to_engage()));
    }
}

/// Pulses of a wheel, any number of them at any time.
fn pulses_of_a_wheel() {
    let config = black_box(WheelPulsesConfig::default());
    used(wheel_speed::step(
        &config,
        &mut black_box(WheelPulsesState::default()),
        &black_box(WheelPulses::default()),
        black_box(1),
    ));
}

/// The current loop, with any input.
fn motor() {
    used(black_box(motor::example::EXAMPLE).motor_id());
    let Ok(plan) = black_box(motor::example::EXAMPLE).plan() else { return };
    let mut state = black_box(motor::State::default());
    let phases = black_box(motor::Phases::Three([0.0; 3]));
    for command in
        black_box([motor::MotorCommand::Off, motor::MotorCommand::Align, motor::MotorCommand::Torque(1.0)])
    {
        let (angle_counts, angle_age_calls) = (black_box(0), black_box(0));
        let (bus_v, temperature_c) = (black_box(24.0), black_box(20.0));
        let inputs = motor::Inputs { phases, bus_v, angle_counts, angle_age_calls, temperature_c, command };
        used(motor::step(&plan, &mut state, &inputs));
    }
}

/// The parts of a board, with any values.
fn board() {
    let counts = black_box(0_u16);
    used((SHUNT.ampere(counts), SUPPLY.volt(counts), BOARD_TEMPERATURE.celsius(counts)));
    used((STEER_RAD.value(counts), RIDER_NM.value(counts), black_box(as5047::Line::default()).step(counts)));
    used(bmi160::sample(black_box(0), &black_box([0; bmi160::BURST])));
    let settings = black_box(GATE_DRIVER);
    used((settings.control1(), settings.control2(), drv8301::Status(counts, counts).names().count()));
    used(black_box(devices::fault_pin::FaultPin::default()).step(black_box(true)));
    used(
        black_box(devices::rotor_speed::RotorSpeedCheck::default())
            .step(black_box(None), MOTOR.motor.turns_s_at(black_box(8.5))),
    );
    used(devices::silicon::has_prefetch(counts, counts));
    used(drv8301::data(black_box(drv8301::Register::Status1), counts).map(drv8301::is_present));
    let command = command_word::command(command_word::word(command_word::command(black_box(0))));
    used(black_box(Deadline::default()).step(black_box(1), command, counts));
    let (mut switch, mut wheel) =
        (black_box(devices::switch::Switch::default()), black_box(WheelState::default()));
    used((switch.step(black_box(true), counts), devices::ticks::ticks(black_box(1), black_box(2))));
    used(wheel::step(&black_box(WheelPulsesConfig::default()), &mut wheel, black_box(None), black_box(1)));
    can();
}

/// Frames on CAN, with anything in them, and the bits they are made of.
fn can() {
    let timing = bit_timing(black_box(0), black_box(0));
    used(timing.map(|timing| timing.sample_point()));
    let frame = black_box(Frame { identifier: 0, bytes: [0; 8] });
    used(CanMessage::of(&frame).map(|message| message.frame()));
    let sensors = wire::decode_frame(&black_box([0; wire::FRAME_BYTES]));
    let calibration = black_box(Config::product()).calibration.plan();
    let (torque_nm, gain_nm_s_rad) = black_box((0.0, 0.0));
    let (limits, mode, causes) = black_box((ActiveLimits::default(), Mode::Off, Causes::NONE));
    let command = Command { torque_nm, gain_nm_s_rad, limits, mode, causes };
    used(CanMessage::Motion(Motion::of(&calibration, &sensors, &command)).frame());
    let mailbox = black_box(Mailbox { empty: true, completed: true, acknowledged: true });
    used(black_box(Counts::default()).step(mailbox));
}

/// The encoder's offset, of any bytes.
fn offset() {
    let found = Alignment::decode(&black_box([0; ALIGNMENT_BYTES])).ok();
    used(found.map(|(number, alignment)| alignment.encode(number)));
    let stored = black_box(Ok(found.map(|(_, alignment)| alignment)));
    used(Offset::choose(black_box(None), stored, black_box(0)).turns());
}

/// The engineer's line: any bytes in, any requests, and all output; the stored faults; the loop's chunks.
fn engineer(mut config: Config) {
    let (mut decoder, mut sender) = (Decoder::default(), TxQueue::<1024, 1024>::new(1));
    let (mut ring, mut chunk) = (black_box([0; RING_BYTES]), black_box([0; MAX_CHUNK]));
    used((fault_log::start(&mut ring), fault_log::noted(&ring)));
    let bytes = black_box([0_u8; 64]);
    let mut bytes = &bytes[..];
    while !bytes.is_empty() {
        let Some(received) = decoder.take(&mut bytes) else { continue };
        match requests::request(&received) {
            Ok((sequence, request)) => {
                let mut room = [0; PAGE_BYTES];
                let engaged = black_box(false);
                let answer = requests::answer(&Config::product(), &mut config, engaged, &request, &mut room);
                used(sender.answer(&answer.unwrap_or(request), sequence));
                if let Message::Fault(fault) = request {
                    fault_log::note(&mut ring, &fault);
                }
                if let Message::Telemetry(telemetry) = request {
                    sender.step(&telemetry);
                }
            }
            Err(wrong) => {
                let (sequence, answer) = wrong.answer();
                used(sender.answer(&answer, sequence));
            }
        }
    }
    fault_log::faults(&ring).for_each(|fault| sender.send(&Message::Fault(fault)));
    fault_log::clear(&mut ring);
    while let Some(byte) = sender.next_byte() {
        used(byte);
    }
    used((decoder.dropped(), sender.dropped(), config_hash(&config)));
    if let Some(board) = FromBoard::decode(&black_box([0; 64])) {
        used(board.encode(&mut chunk));
    }
    if let Some(host) = ToBoard::decode(&black_box([0; 64])) {
        used(host.encode(&mut chunk));
    }
}
