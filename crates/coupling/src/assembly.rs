//! Assembly of the symmetric matrix G_ij = A_i F_ij (m²) of a mesh, in parallel.
//!
//! Each pair is computed once, so that reciprocity A_i F_ij = A_j F_ji holds exactly. Rows are cut into fixed runs of about equal numbers of pairs;
//! what the runs report is folded in their order, so that the number of threads changes no bit.

use crate::CouplingError;
use crate::form_factor::{Exchange, Method, PairIntegrator, Workspace};
use fredholm_linop::{PackedSymmetric, Storage};
use rayon::prelude::*;
use std::ops::{ControlFlow, Range};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Runs of rows: enough to balance the threads, few enough to keep their reports small.
const RUNS: usize = 192;
/// Pairs between two looks at the watch.
const LOOK: u64 = 256;

/// Called with the pairs done and the pairs in all; can stop the assembly.
pub type Watch<'a> = dyn Fn(u64, u64) -> ControlFlow<()> + Sync + 'a;

/// How many pairs each method computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MethodCounts {
    /// Pairs with one patch behind the other, or wholly behind one occluder.
    pub hidden: u64,
    /// Pairs by Gauss points on both patches.
    pub area_gauss: u64,
    /// Pairs by the contour integral.
    pub contour: u64,
    /// Pairs with exact shadows.
    pub clipped: u64,
    /// Pairs with sampled visibility.
    pub sampled: u64,
}

impl MethodCounts {
    fn add(&mut self, method: Method) {
        *match method {
            Method::Hidden => &mut self.hidden,
            Method::AreaGauss => &mut self.area_gauss,
            Method::Contour => &mut self.contour,
            Method::Clipped => &mut self.clipped,
            Method::Sampled => &mut self.sampled,
        } += 1;
    }

    fn merge(&mut self, other: &Self) {
        self.hidden += other.hidden;
        self.area_gauss += other.area_gauss;
        self.contour += other.contour;
        self.clipped += other.clipped;
        self.sampled += other.sampled;
    }
}

/// The assembled matrix and what is known of its errors.
#[derive(Clone, Debug)]
pub struct Assembled<S> {
    /// G_ij = A_i F_ij, m².
    pub matrix: PackedSymmetric<S>,
    /// Σ_j |error of G_ij| as estimated, m², per element.
    pub error: Vec<f64>,
    /// Largest estimated error of a form factor F_ij.
    pub largest: f64,
    /// Pairs per method.
    pub methods: MethodCounts,
}

/// Computes all pairs of `integrator`.
///
/// # Errors
/// No memory, or stopped by the watch: then there is no partial result.
pub fn assemble<S: Storage>(
    integrator: &PairIntegrator,
    watch: &Watch,
) -> Result<Assembled<S>, CouplingError> {
    let n = integrator.len();
    let mut packed = zeros::<S>(n)?;
    let progress = Progress::new(pairs(n), watch);
    let runs = cut(&mut packed, n);
    let reports: Vec<Report> = runs.into_par_iter().map(|run| run.fill(integrator, &progress)).collect();
    progress.finish()?;
    let mut total = Report::new(n);
    for report in &reports {
        total.merge(report);
    }
    let matrix = PackedSymmetric::new(n, packed)?;
    Ok(Assembled { matrix, error: total.error, largest: total.largest, methods: total.methods })
}

fn pairs(n: usize) -> u64 {
    let n = n as u64;
    n * n.saturating_sub(1) / 2
}

fn zeros<S: Storage>(n: usize) -> Result<Vec<S>, CouplingError> {
    let needed = PackedSymmetric::<S>::bytes(n);
    let mut packed = Vec::new();
    packed.try_reserve_exact(n * (n + 1) / 2).map_err(|_| CouplingError::Allocation { needed })?;
    packed.resize(n * (n + 1) / 2, S::from_f64(0.0));
    Ok(packed)
}

/// Consecutive rows of the packed lower triangle.
struct Run<'a, S> {
    rows: Range<usize>,
    entries: &'a mut [S],
}

/// Cuts the packed rows into runs of about equal numbers of entries.
fn cut<S>(mut packed: &mut [S], n: usize) -> Vec<Run<'_, S>> {
    let share = packed.len().div_ceil(RUNS);
    let mut runs = Vec::new();
    let mut start = 0;
    while start < n {
        let (mut end, mut count) = (start, 0);
        while end < n && count < share {
            end += 1;
            count += end;
        }
        let (entries, rest) = packed.split_at_mut(count);
        runs.push(Run { rows: start..end, entries });
        (packed, start) = (rest, end);
    }
    runs
}

impl<S: Storage> Run<'_, S> {
    fn fill(self, integrator: &PairIntegrator, progress: &Progress) -> Report {
        let mut report = Report::new(integrator.len());
        let mut work = Workspace::default();
        let mut rest = self.entries;
        for i in self.rows {
            if progress.state().is_break() {
                return report;
            }
            let (row, tail) = rest.split_at_mut(i + 1);
            rest = tail;
            for (j, entry) in row[..i].iter_mut().enumerate() {
                if report.count(progress).is_break() {
                    return report;
                }
                let exchange = integrator.exchange(i, j, &mut work);
                *entry = S::from_f64(exchange.value);
                report.add(i, j, &exchange, integrator.smaller_area(i, j));
            }
        }
        progress.advance(report.unseen);
        report
    }
}

/// What one run knows of its pairs.
struct Report {
    error: Vec<f64>,
    largest: f64,
    methods: MethodCounts,
    unseen: u64,
}

impl Report {
    fn new(n: usize) -> Self {
        Self { error: vec![0.0; n], largest: 0.0, methods: MethodCounts::default(), unseen: 0 }
    }

    fn count(&mut self, progress: &Progress) -> ControlFlow<()> {
        self.unseen += 1;
        if self.unseen < LOOK {
            return ControlFlow::Continue(());
        }
        progress.advance(std::mem::take(&mut self.unseen));
        progress.state()
    }

    fn add(&mut self, i: usize, j: usize, exchange: &Exchange, area: f64) {
        self.largest = self.largest.max(exchange.error / area);
        self.error[i] += exchange.error;
        self.error[j] += exchange.error;
        self.methods.add(exchange.method);
    }

    fn merge(&mut self, other: &Self) {
        self.error.iter_mut().zip(&other.error).for_each(|(a, b)| *a += b);
        self.largest = self.largest.max(other.largest);
        self.methods.merge(&other.methods);
    }
}

/// Counts pairs over all threads and asks the watch whether to go on.
struct Progress<'a> {
    done: AtomicU64,
    total: u64,
    stopped: AtomicBool,
    watch: &'a Watch<'a>,
}

impl<'a> Progress<'a> {
    fn new(total: u64, watch: &'a Watch<'a>) -> Self {
        Self { done: AtomicU64::new(0), total, stopped: AtomicBool::new(false), watch }
    }

    fn advance(&self, pairs: u64) {
        let done = self.done.fetch_add(pairs, Ordering::Relaxed) + pairs;
        if (self.watch)(done, self.total).is_break() {
            self.stopped.store(true, Ordering::Relaxed);
        }
    }

    fn state(&self) -> ControlFlow<()> {
        if self.stopped.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    fn finish(&self) -> Result<(), CouplingError> {
        if self.stopped.load(Ordering::Relaxed) {
            let done = self.done.load(Ordering::Relaxed);
            return Err(CouplingError::Interrupted { done, total: self.total });
        }
        Ok(())
    }
}
