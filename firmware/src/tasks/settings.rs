//! The configuration: the one the controller runs with, the next one on its way to it, the one in flash. Beside that in
//! flash, the offset of the motor's encoder.

use super::latest;
use crate::{board, heartbeat};
use ::control::{Config, Mode, Plan};
use core::cell::RefCell;
use embassy_futures::block_on;
use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use link::Store;
use link::alignment::{Alignment, Offset};
use link::store::{Found, InvalidRecord, NotStored, Room};
use static_cell::{ConstStaticCell, StaticCell};

/// A plan that the controller has not taken yet.
struct Next {
    plan: Plan,
    /// Whatever the controller is doing.
    at_once: bool,
}

/// What is in force, or about to be.
struct Settings {
    /// `None` before the first was offered.
    config: Option<Config>,
    /// Which one that is, counted from the start.
    number: u32,
    next: Option<Next>,
}

static SETTINGS: Mutex<CriticalSectionRawMutex, RefCell<Settings>> =
    Mutex::new(RefCell::new(Settings { config: None, number: 0, next: None }));

/// Whether torque may flow, or does: nothing may be changed then.
pub fn engaged() -> bool {
    latest().is_some_and(|t| t.command.mode.drives() || t.command.torque_nm != 0.0)
}

/// The configuration in force, or about to be; the defaults before the first was offered.
pub fn config() -> Config {
    SETTINGS.lock(|settings| settings.borrow().config.clone()).unwrap_or_else(Config::product)
}

/// The controller begins anew with this plan as soon as no torque flows, or at once.
pub fn offer(plan: Plan, at_once: bool) {
    SETTINGS.lock(|settings| {
        let mut settings = settings.borrow_mut();
        settings.config = Some(plan.config().clone());
        settings.number = settings.number.wrapping_add(1);
        settings.next = Some(Next { plan, at_once });
    });
}

/// Remembers that the polarity check was passed with the configuration of this number; the controller itself knows already.
///
/// Another one that came since, taken by the controller or not, has a calibration that nobody checked.
pub(super) fn polarity_passed(number: u32) {
    SETTINGS.lock(|settings| {
        let mut settings = settings.borrow_mut();
        if settings.number == number
            && let Some(config) = settings.config.as_mut()
        {
            config.calibration.polarity_checked = true;
        }
    });
}

/// The plan that is offered and its number, if a controller in this mode may take it.
pub(super) fn take(mode: Mode) -> Option<(Plan, u32)> {
    SETTINGS.lock(|settings| {
        let mut settings = settings.borrow_mut();
        let next = settings.next.take_if(|next| next.at_once || !mode.drives())?;
        Some((next.plan, settings.number))
    })
}

/// The stored parameters and encoder's offset, and what they are worked on in.
pub struct StoredConfig {
    /// The flash's pages; `None` if the board has none.
    store: Option<Store<board::Flash>>,
    room: &'static mut Room,
    found: Found,
    offset: Option<Offset>,
}

impl StoredConfig {
    /// In the board's flash.
    ///
    /// # Panics
    /// When called a second time.
    pub fn open() -> Self {
        static ROOM: ConstStaticCell<Room> = ConstStaticCell::new(Room::new());
        let store = board::flash().and_then(|(flash, range)| Store::new(flash, range));
        Self { store, room: ROOM.take(), found: Found::Nothing, offset: None }
    }

    /// The stored configuration, or the defaults with the polarity check not passed.
    async fn load(&mut self, defaults: &Config) -> Config {
        let Some(store) = &mut self.store else {
            let mut unchecked = defaults.clone();
            unchecked.calibration.polarity_checked = false;
            return unchecked;
        };
        let (config, found) = store.load(defaults, self.room).await;
        self.found = found;
        config
    }

    /// What was found at the start.
    pub fn found(&self) -> &Found {
        &self.found
    }

    /// The offset of the encoder to begin with: the program's own, else that stored with this motor.
    pub fn choose_offset(&mut self, program: Option<f32>, motor_id: u32) -> Offset {
        let stored = match &mut self.store {
            Some(store) => block_on(store.alignment(self.room)),
            None => Err(InvalidRecord::Unreadable),
        };
        *self.offset.insert(Offset::choose(program, stored, motor_id))
    }

    /// The offset that was chosen at the start; `None` on a board without encoder.
    pub fn offset(&self) -> Option<&Offset> {
        self.offset.as_ref()
    }

    /// Stores an alignment of the encoder. The chip may stand still as of [`StoredConfig::save`].
    ///
    /// # Errors
    /// As of [`NotStored`].
    pub async fn save_alignment(&mut self, alignment: &Alignment) -> Result<(), NotStored> {
        let Some(store) = &mut self.store else { return Err(NotStored::Flash) };
        store.save_alignment(alignment, self.room).await
    }

    /// Stores a configuration. The chip may stand still for as long as the flash erases, so only while no torque flows.
    ///
    /// # Errors
    /// As of [`NotStored`].
    pub async fn save(&mut self, config: &Config) -> Result<(), NotStored> {
        let Some(store) = &mut self.store else { return Err(NotStored::Flash) };
        heartbeat::suspend(true);
        let stored = store.save(config, self.room).await;
        heartbeat::suspend(false);
        stored
    }
}

/// The plan to start with: of the stored configuration, or of the defaults. It is also what is in force.
///
/// # Panics
/// When called a second time.
#[inline(never)]
pub fn start(stored: &mut StoredConfig, defaults: &Config) -> &'static mut Plan {
    static PLAN: StaticCell<Plan> = StaticCell::new();
    let config = block_on(stored.load(defaults));
    SETTINGS.lock(|settings| settings.borrow_mut().config = Some(config.clone()));
    // What a store gives passes: else it gave the defaults, which are the program's own.
    PLAN.init(config.plan().expect("a plan of the defaults"))
}
