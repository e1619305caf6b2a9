//! Debounce of the rider's switch, and age of samples.

use control::sensors::frame::MISSING;
use devices::age::Age;
use devices::switch::Switch;
use devices::vesc6::SWITCH_TICKS;

/// Situation: a contact that bounces for 9 ms at each change. Must hold: one change, 20 ms after it has settled, in
/// both directions.
#[test]
fn contact_bounce_is_no_press() {
    let mut switch = Switch::default();
    let bounces = [true, false, true, true, false, true, false, true, false];
    assert!(bounces.iter().all(|closed| !switch.step(*closed, SWITCH_TICKS)));
    let pressed = (1..100).find(|_| switch.step(true, SWITCH_TICKS));
    assert_eq!(pressed, Some(20));
    assert!(bounces.iter().all(|open| switch.step(!open, SWITCH_TICKS)));
    let released = (1..100).find(|_| !switch.step(false, SWITCH_TICKS));
    assert_eq!(released, Some(20));
}

/// Situation: a sensor without samples, then with one, then without for 70 000 periods. Must hold: missing, fresh,
/// older by one each period, and finally missing again rather than fresh.
#[test]
fn ages_rise_and_do_not_wrap() {
    let mut age = Age::default();
    assert_eq!(age.step(false), MISSING);
    assert_eq!(age.step(true), 0);
    assert_eq!((age.step(false), age.step(false)), (1, 2));
    (0..70_000).for_each(|_| _ = age.step(false));
    assert_eq!(age.now(), MISSING);
    assert_eq!(age.step(true), 0);
}
