//! The cells of a sweep as one process takes them: claimed one by one, column by column.

use super::claim::{Claim, DoneColumn};
use super::claims::Claims;
use super::unit::Unit;
use super::wait::{Reminder, Wait};
use super::{Cell, Folder, SweepError};
use std::collections::{BTreeMap, VecDeque};
use std::time::{Duration, Instant};

/// Time between looks at cells that others compute.
const LOOK: Duration = Duration::from_millis(500);

/// The next step of a thread.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Next {
    /// Compute the columns at some speeds of a cell.
    Columns(usize, Vec<usize>),
    /// Store a cell whose columns are all finished.
    Store(usize),
    /// Ask again.
    Again,
    /// Ask again after a while: others compute all that is left.
    Later,
    /// Nothing is left to be begun.
    Over,
}

/// A claimed cell and its finished columns.
struct UnderWay {
    claim: Claim,
    columns: Vec<DoneColumn>,
}

/// The state of a run.
pub(super) struct Queue<'a> {
    cells: &'a [&'a Cell],
    speeds: usize,
    folder: &'a Folder,
    claims: Claims,
    /// Cells to be tried, in order.
    open: VecDeque<usize>,
    /// Cells that others compute.
    elsewhere: VecDeque<usize>,
    looked: Instant,
    reminder: Reminder,
    /// Columns of claimed cells that no thread has begun.
    columns: VecDeque<(usize, usize)>,
    under_way: BTreeMap<usize, UnderWay>,
    /// Columns that need not be computed here, not yet counted as progress.
    given: usize,
    /// Cells found finished by others.
    pub(super) others: usize,
}

impl<'a> Queue<'a> {
    pub(super) fn new(cells: &'a [&'a Cell], speeds: usize, folder: &'a Folder) -> Self {
        Self {
            cells,
            speeds,
            folder,
            claims: folder.claims(),
            open: (0..cells.len()).collect(),
            elsewhere: VecDeque::new(),
            looked: Instant::now(),
            reminder: Reminder::default(),
            columns: VecDeque::new(),
            under_way: BTreeMap::new(),
            given: 0,
            others: 0,
        }
    }

    /// The next step of a thread, with at most as many columns as `together` states for their cell and the number of columns that
    /// are left. Looks at one cell at most, so that other threads don't wait long.
    pub(super) fn next(&mut self, together: impl Fn(&Cell, usize) -> usize) -> Result<Next, SweepError> {
        if let Some(&(cell, _)) = self.columns.front() {
            let left = self.columns.len() + self.speeds * self.open.len();
            let most = together(self.cells[cell], left);
            let same = self.columns.iter().take(most).take_while(|(of, _)| *of == cell).count();
            let speeds = self.columns.drain(..same).map(|(_, speed)| speed).collect();
            return Ok(Next::Columns(cell, speeds));
        }
        if let Some(cell) = self.open.pop_front() {
            return self.attempt(cell);
        }
        if self.elsewhere.is_empty() {
            return Ok(Next::Over);
        }
        if self.looked.elapsed() >= LOOK {
            self.looked = Instant::now();
            self.open = std::mem::take(&mut self.elsewhere);
        }
        Ok(Next::Later)
    }

    /// Claims a cell, unless it is finished or claimed by others.
    fn attempt(&mut self, cell: usize) -> Result<Next, SweepError> {
        let id = &self.cells[cell].id;
        if self.is_stored(id) {
            return Ok(self.found_stored());
        }
        let Some(claim) = self.claims.take(id)? else {
            self.elsewhere.push_back(cell);
            return Ok(Next::Again);
        };
        // Another process may have stored it before this claim.
        if self.is_stored(id) {
            self.claims.done(id);
            return Ok(self.found_stored());
        }
        let columns = claim.columns.clone();
        self.given += columns.len();
        let to_do = (0..self.speeds).filter(|speed| columns.iter().all(|column| column.speed != *speed));
        self.columns.extend(to_do.map(|speed| (cell, speed)));
        let whole = columns.len() == self.speeds;
        self.under_way.insert(cell, UnderWay { claim, columns });
        Ok(if whole { Next::Store(cell) } else { Next::Again })
    }

    fn is_stored(&self, id: &str) -> bool {
        // A damaged unit is computed again.
        matches!(self.folder.unit(id), Ok(Some(_)))
    }

    fn found_stored(&mut self) -> Next {
        self.others += 1;
        self.given += self.speeds;
        Next::Again
    }

    /// The wait for other processes, when it is time to tell of it.
    pub(super) fn wait(&mut self) -> Option<Wait> {
        if !self.under_way.is_empty() {
            self.reminder.over();
            return None;
        }
        if !self.reminder.is_due() {
            return None;
        }
        let left: Vec<usize> = self.open.iter().chain(&self.elsewhere).copied().collect();
        // One that can't be read is reported when it is tried again.
        let claim = |cell: &usize| self.claims.read(&self.cells[*cell].id).ok().flatten();
        let claims: Vec<Claim> = left.iter().filter_map(claim).collect();
        Some(Wait::new("cell", left.len(), self.speeds, &claims))
    }

    /// Takes a computed column; true if it is the last of its cell.
    pub(super) fn finished(&mut self, cell: usize, column: DoneColumn) -> bool {
        let Some(under_way) = self.under_way.get_mut(&cell) else { return false };
        under_way.columns.push(column);
        under_way.columns.len() == self.speeds
    }

    /// The result of a cell whose columns are all finished; `None` if it is not under way.
    pub(super) fn unit(&self, cell: usize) -> Option<Unit> {
        let mut columns = self.under_way.get(&cell)?.columns.clone();
        columns.sort_by_key(|column| column.speed);
        let Cell { id, config, scenario, .. } = self.cells[cell];
        Some(Unit::new(id, (config, scenario), columns))
    }

    /// A cell has been stored.
    pub(super) fn stored(&mut self, cell: usize) {
        self.under_way.remove(&cell);
        self.claims.done(&self.cells[cell].id);
    }

    /// Renews the claims.
    pub(super) fn renew(&mut self) -> Result<(), SweepError> {
        self.under_way
            .values_mut()
            .try_for_each(|cell| self.claims.renew(&mut cell.claim, cell.columns.clone()))
    }

    /// Gives up the cells under way; their number.
    pub(super) fn release(&mut self, error: Option<&SweepError>) -> usize {
        let under_way = std::mem::take(&mut self.under_way);
        let left = under_way.len() + self.open.len() + self.elsewhere.len();
        for cell in under_way.into_values() {
            self.claims.release(cell.claim, cell.columns, error.map(ToString::to_string));
        }
        left
    }

    /// Number of columns that need no computation here since the last call.
    pub(super) fn given(&mut self) -> usize {
        std::mem::take(&mut self.given)
    }
}
