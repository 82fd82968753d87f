//! The one limit on the memory of a run, for every command.

use std::fmt;
use std::path::Path;
use std::sync::OnceLock;

use super::machine::Machine;
use crate::error::{Error, ErrorKind};
use crate::size::Bytes;
use crate::threads::cores;

/// Share of what the machine has left that is used where nothing is asked for: the rest keeps it
/// usable.
const SHARE_OF_FREE_MEMORY: f64 = 0.8;
/// Limit where the system does not tell what is available.
const LIMIT_UNTOLD: u128 = 4 << 30;
/// Address space that a thread sets aside: its stack with what guards it, and its part of the
/// runtime.
const BYTES_OF_A_THREAD: u128 = 3 << 20;
/// Share of a limit on the address space that threads may set aside.
const SET_ASIDE: u128 = 4;
/// Addresses without which no run begins: reading a scene, and threads.
const LEAST_SPACE: Bytes = Bytes(16 << 20);
/// Threads that a limited address space makes room for at most, where the machine has fewer cores.
const MOST_THREADS: u128 = 16;

/// What sets the limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Bound {
    /// `--memory`.
    Asked,
    /// What the machine has left.
    Available,
    /// The control group.
    Group,
    /// `ulimit -v`.
    AddressSpace,
    /// `ulimit -d`.
    Data,
    /// Nothing that is known.
    Fallback,
}

/// The most that this process may hold, and why.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limit {
    pub(super) bytes: Bytes,
    pub(super) bound: Bound,
    /// Addresses that may be set aside besides, where their number is limited.
    pub(super) spare: Option<u128>,
}

/// The machine as it was when the process first asked: what the run itself takes must not lower its
/// limit.
fn machine() -> &'static Machine {
    static MACHINE: OnceLock<Machine> = OnceLock::new();
    MACHINE.get_or_init(|| Machine::read(Path::new("/")))
}

/// The limit in force, where so much is asked for.
pub(crate) fn limit(asked: Option<Bytes>) -> Limit {
    machine().limit(asked)
}

/// Whether `ulimit -v` is in force.
#[must_use]
pub fn addresses_are_limited() -> bool {
    machine().address_space.is_some()
}

/// Threads of which the stacks leave most of a limited address space to the data.
pub(crate) fn allowance() -> usize {
    machine().threads()
}

/// Refuses to begin where so few addresses are left that the smallest scene could not be read.
pub(crate) fn room_to_begin() -> Result<(), Error> {
    let left = Bytes(machine().address_space.unwrap_or(u128::MAX));
    if left >= LEAST_SPACE {
        return Ok(());
    }
    let message = format!("ulimit -v leaves {left}, and {LEAST_SPACE} are the least to begin with");
    Err(Error::new(ErrorKind::Resources, format!("{message}; raise it")))
}

/// The limit in force, where it is less than was asked for.
#[must_use]
pub fn less_than_asked(asked: Bytes) -> Option<Limit> {
    Some(limit(Some(asked))).filter(|limit| limit.bytes < asked)
}

impl Machine {
    fn limit(&self, asked: Option<Bytes>) -> Limit {
        let ceiling = self.bounds(1.0).min_by_key(|limit| limit.bytes);
        let found = match asked {
            Some(bytes) if ceiling.is_none_or(|ceiling| bytes <= ceiling.bytes) => {
                Limit { bytes, bound: Bound::Asked, spare: None }
            }
            _ => self.least(asked.map_or(SHARE_OF_FREE_MEMORY, |_| 1.0)),
        };
        let addresses = self.bounds(1.0).find(|limit| limit.bound == Bound::AddressSpace);
        let spare = |all: Limit| all.bytes.0.saturating_sub(found.bytes.0);
        Limit { spare: addresses.map(spare), ..found }
    }

    /// The least bound, with a share of what is available.
    fn least(&self, share: f64) -> Limit {
        let fallback = Limit { bytes: Bytes(LIMIT_UNTOLD), bound: Bound::Fallback, spare: None };
        self.bounds(share).min_by_key(|limit| limit.bytes).unwrap_or(fallback)
    }

    /// Everything that bounds the memory of this process, which holds some already.
    fn bounds(&self, share: f64) -> impl Iterator<Item = Limit> {
        // Of the address space a part is set aside that is never touched; how much of it is not
        // known before.
        let aside = |left: u128| left - (left / SET_ASIDE).min(self.threads() as u128 * BYTES_OF_A_THREAD);
        let bounds = [
            (self.available.map(|left| (left as f64 * share) as u128), Bound::Available),
            (self.group, Bound::Group),
            (self.address_space.map(aside), Bound::AddressSpace),
            (self.data, Bound::Data),
        ];
        let resident = self.resident;
        let limit = move |(left, bound): (Option<u128>, Bound)| {
            Some(Limit { bytes: Bytes(left? + resident), bound, spare: None })
        };
        bounds.into_iter().filter_map(limit)
    }

    fn threads(&self) -> usize {
        let room =
            |left: u128| (left / SET_ASIDE / BYTES_OF_A_THREAD).clamp(1, MOST_THREADS.max(cores() as u128));
        let most = self.address_space.map_or(u128::MAX, room);
        usize::try_from(most).unwrap_or(usize::MAX)
    }
}

impl fmt::Display for Limit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let why = match self.bound {
            Bound::Asked => "--memory",
            Bound::Available => "what the machine has left",
            Bound::Group => "what the control group has left",
            Bound::AddressSpace => "what ulimit -v leaves",
            Bound::Data => "what ulimit -d leaves",
            Bound::Fallback => "the system does not tell what is left",
        };
        write!(f, "{} ({why})", self.bytes)
    }
}

impl Limit {
    /// What addresses that are set aside and hardly touched take of the limit: nothing where
    /// their number is not limited.
    pub(crate) fn counted(self, aside: u128) -> u128 {
        self.spare.map_or(0, |spare| aside.saturating_sub(spare))
    }

    /// The most that the process may hold.
    #[must_use]
    pub fn bytes(self) -> Bytes {
        self.bytes
    }

    /// How to get more.
    pub(super) fn help(self) -> &'static str {
        match self.bound {
            Bound::Asked | Bound::Fallback => "allow more with --memory",
            Bound::Available => "end other programs, or allow more with --memory",
            Bound::Group => "raise the limit of the control group",
            Bound::AddressSpace => "raise ulimit -v",
            Bound::Data => "raise ulimit -d",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GIB: u128 = 1 << 30;

    fn of(limit: Limit) -> (u128, Bound) {
        (limit.bytes.0, limit.bound)
    }

    #[test]
    fn the_least_of_all_bounds_counts() {
        let free = Machine { available: Some(10 * GIB), ..Machine::default() };
        assert_eq!(of(free.limit(None)), (8 * GIB, Bound::Available));
        assert_eq!(of(free.limit(Some(Bytes(9 * GIB)))), (9 * GIB, Bound::Asked));
        assert_eq!(of(free.limit(Some(Bytes(11 * GIB)))), (10 * GIB, Bound::Available));
        let grouped = Machine { group: Some(3 * GIB), resident: 5, ..free };
        assert_eq!(of(grouped.limit(None)), (3 * GIB + 5, Bound::Group));
        assert_eq!(of(grouped.limit(Some(Bytes(4 * GIB)))), (3 * GIB + 5, Bound::Group));
        assert_eq!(of(grouped.limit(Some(Bytes(GIB)))), (GIB, Bound::Asked));
        let data = Machine { data: Some(GIB), ..grouped };
        assert_eq!(of(data.limit(None)), (GIB + 5, Bound::Data));
        assert_eq!(of(Machine::default().limit(None)), (LIMIT_UNTOLD, Bound::Fallback));
    }

    #[test]
    fn addresses_that_are_set_aside_count_where_they_are_limited() {
        let free = Machine { available: Some(10 * GIB), ..Machine::default() };
        assert_eq!(free.limit(None).counted(100 * GIB), 0);
        let tight = Machine { address_space: Some(2 * GIB), ..free };
        assert_eq!(tight.limit(None).counted(GIB), GIB);
        let asked = tight.limit(Some(Bytes(GIB)));
        let spare = tight.limit(None).bytes.0 - GIB;
        assert_eq!((asked.counted(spare), asked.counted(GIB)), (0, GIB - spare));
    }

    #[test]
    fn threads_set_aside_at_most_a_part_of_the_address_space() {
        let machine = |space: u128| Machine { address_space: Some(space), ..Machine::default() };
        assert_eq!(Machine::default().threads(), usize::MAX);
        assert_eq!(
            (machine(GIB).threads(), machine(GIB / 8).threads(), machine(GIB / 1024).threads()),
            (cores().max(16), 10, 1)
        );
        let aside = cores().max(16) as u128 * BYTES_OF_A_THREAD;
        assert_eq!(of(machine(GIB).limit(None)), (GIB - aside, Bound::AddressSpace));
        assert_eq!(machine(GIB / 256).limit(None).bytes, Bytes(GIB / 256 * 3 / 4));
    }
}
