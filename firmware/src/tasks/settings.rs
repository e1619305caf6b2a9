//! The configuration in use, the next one, and the one stored in flash with the offset of the motor's encoder.

use crate::telemetry::latest;
use crate::{board, heartbeat};
use ::control::{Config, Mode, Plan};
use core::cell::RefCell;
use embassy_futures::block_on;
use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use link::Store;
use link::alignment::{Alignment, Offset};
use link::record::InvalidRecord;
use link::store::{Found, NotStored, StoreBuffers};
use static_cell::{ConstStaticCell, StaticCell};

/// A plan for the controller.
struct Next {
    plan: Plan,
    /// Whether the controller uses it even while torque flows.
    at_once: bool,
}

/// The newest configuration and its plan.
struct Settings {
    /// `None` before the start.
    config: Option<Config>,
    /// Number of the configuration, counted from the start.
    number: u32,
    next: Option<Next>,
}

static SETTINGS: Mutex<CriticalSectionRawMutex, RefCell<Settings>> =
    Mutex::new(RefCell::new(Settings { config: None, number: 0, next: None }));

/// Whether torque can flow or does: no parameter can be changed then.
pub fn engaged() -> bool {
    latest().is_some_and(|t| t.command.mode.drives() || t.command.torque_nm != 0.0)
}

/// The newest configuration, in use or pending; the defaults before the start.
pub fn config() -> Config {
    SETTINGS.lock(|settings| settings.borrow().config.clone()).unwrap_or_else(Config::product)
}

/// Passes a plan to the controller, which restarts with it as soon as no torque flows, or at once.
pub fn queue_plan(plan: Plan, at_once: bool) {
    SETTINGS.lock(|settings| {
        let mut settings = settings.borrow_mut();
        settings.config = Some(plan.config().clone());
        settings.number = settings.number.wrapping_add(1);
        settings.next = Some(Next { plan, at_once });
    });
}

/// Sets `polarity_checked` in the configuration of this number after a passed polarity check; the controller has set
/// its own.
///
/// A newer configuration, in use or pending, has an unchecked calibration and stays unchanged.
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

/// The pending plan and its number, if a controller in this mode and with this last torque can use it.
pub(super) fn take_pending_plan(mode: Mode, torque_nm: f32) -> Option<(Plan, u32)> {
    SETTINGS.lock(|settings| {
        let mut settings = settings.borrow_mut();
        let next = settings.next.take_if(|next| next.at_once || !(mode.drives() || torque_nm != 0.0))?;
        Some((next.plan, settings.number))
    })
}

/// Stored parameters and encoder offset, with the store's work memory.
pub struct StoredConfig {
    /// Store in the board's flash; `None` if the board has none.
    store: Option<Store<board::Flash>>,
    buffers: &'static mut StoreBuffers,
    found: Found,
    offset: Option<Offset>,
}

impl StoredConfig {
    /// Opens the store in the board's flash.
    ///
    /// # Panics
    /// When called a second time.
    pub fn open() -> Self {
        static BUFFERS: ConstStaticCell<StoreBuffers> = ConstStaticCell::new(StoreBuffers::new());
        let store = board::flash().and_then(|(flash, range)| Store::new(flash, range));
        Self { store, buffers: BUFFERS.take(), found: Found::Nothing, offset: None }
    }

    /// Loads the stored configuration, or the defaults with `polarity_checked` cleared.
    async fn load(&mut self, defaults: &Config) -> Config {
        let Some(store) = &mut self.store else {
            let mut unchecked = defaults.clone();
            unchecked.calibration.polarity_checked = false;
            return unchecked;
        };
        let (config, found) = store.load(defaults, self.buffers).await;
        self.found = found;
        config
    }

    /// Result of loading.
    pub fn found(&self) -> &Found {
        &self.found
    }

    /// Chooses the encoder offset at start: the program's own, else the stored one of this motor.
    pub fn choose_offset(&mut self, program: Option<f32>, motor_id: u32) -> Offset {
        let stored = match &mut self.store {
            Some(store) => block_on(store.alignment(self.buffers)),
            None => Err(InvalidRecord::Unreadable),
        };
        *self.offset.insert(Offset::choose(program, stored, motor_id))
    }

    /// The chosen encoder offset; `None` on a board without encoder.
    pub fn offset(&self) -> Option<&Offset> {
        self.offset.as_ref()
    }

    /// Stores an alignment of the encoder. The chip can halt as in [`StoredConfig::save`].
    ///
    /// # Errors
    /// As of [`NotStored`].
    pub async fn save_alignment(&mut self, alignment: &Alignment) -> Result<(), NotStored> {
        let Some(store) = &mut self.store else { return Err(NotStored::Flash) };
        let _storing = Storing::begin();
        store.save_alignment(alignment, self.buffers).await
    }

    /// Stores a configuration. The chip can halt while the flash erases, so call this only while no torque flows.
    ///
    /// # Errors
    /// As of [`NotStored`].
    pub async fn save(&mut self, config: &Config) -> Result<(), NotStored> {
        let Some(store) = &mut self.store else { return Err(NotStored::Flash) };
        let _storing = Storing::begin();
        store.save(config, self.buffers).await
    }
}

/// Guard of a store: while it exists the motor's bridge is open, the watchdog's timeout extended and the supervision
/// suspended.
struct Storing {
    _board: board::StoreGuard,
}

impl Storing {
    fn begin() -> Self {
        let board = board::StoreGuard::begin();
        heartbeat::suspend(true);
        Self { _board: board }
    }
}

impl Drop for Storing {
    fn drop(&mut self) {
        heartbeat::suspend(false);
    }
}

/// The plan at start, from the stored configuration or the defaults. Sets the configuration in use.
///
/// # Panics
/// When called a second time.
#[inline(never)]
pub fn start(stored: &mut StoredConfig, defaults: &Config) -> &'static mut Plan {
    static PLAN: StaticCell<Plan> = StaticCell::new();
    let config = block_on(stored.load(defaults));
    SETTINGS.lock(|settings| settings.borrow_mut().config = Some(config.clone()));
    // A loaded configuration is valid; otherwise it is the defaults, which are constants.
    PLAN.init(config.plan().expect("a plan of the defaults"))
}
