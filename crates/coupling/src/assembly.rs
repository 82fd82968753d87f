//! Assembly of the symmetric matrix G_ij = A_i F_ij (m²) of a mesh, in parallel.
//!
//! Each pair is computed once, so that reciprocity A_i F_ij = A_j F_ji holds exactly. The patches
//! are cut into panels of neighbours; a panel finds out what stands between its patches and those
//! before it, computes its pairs, and what it reports is folded in the order of the panels, so that
//! the number of threads changes no bit.

use crate::CouplingError;
use crate::form_factor::{Exchange, Method, PairIntegrator, STANDARD_ERRORS, Workspace};
use crate::occlusion::{Clusters, Panel, walk};
use crate::pair_sample::scattered;
use fredholm_linop::{PackedSymmetric, Quiet, Steps, Storage, Watch};
use rayon::prelude::*;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

/// Patches of a panel at most.
const PATCHES_OF_A_PANEL: usize = 32;
/// Pairs of a panel, roughly, when the time of all is to be found out.
const PAIRS_OF_A_SAMPLE: usize = 50_000;
/// Entries that wait for their place in the matrix at most, as far as a batch of panels can tell.
const MOST_WAITING_ENTRIES: usize = 1 << 20;
/// Panels of a batch for each thread, at least: enough to keep it busy until the last one of them
/// ends.
const OF_A_THREAD: usize = 8;

/// How many pairs each method computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MethodCounts {
    /// Pairs with one patch behind the other, or wholly behind one body.
    pub hidden: u64,
    /// Pairs by Gauss points along the edges.
    pub gauss: u64,
    /// Pairs by the contour integral of the parts that face each other.
    pub contour: u64,
    /// Pairs with exact shadows.
    pub clipped: u64,
    /// Pairs with sampled visibility.
    pub sampled: u64,
    /// Pairs with the visibility of segments.
    pub segments: u64,
}

impl MethodCounts {
    fn add(&mut self, method: Method) {
        *match method {
            Method::Hidden => &mut self.hidden,
            Method::Gauss => &mut self.gauss,
            Method::Contour => &mut self.contour,
            Method::Clipped => &mut self.clipped,
            Method::Sampled => &mut self.sampled,
            Method::Segments => &mut self.segments,
        } += 1;
    }

    fn merge(&mut self, other: &Self) {
        self.hidden += other.hidden;
        self.gauss += other.gauss;
        self.contour += other.contour;
        self.clipped += other.clipped;
        self.sampled += other.sampled;
        self.segments += other.segments;
    }

    fn sum(&self) -> u64 {
        self.hidden + self.gauss + self.contour + self.clipped + self.sampled + self.segments
    }
}

/// The assembled matrix and what is known of its errors.
#[derive(Clone, Debug)]
pub struct Assembled<S> {
    /// G_ij = A_i F_ij, m².
    pub matrix: PackedSymmetric<S>,
    /// Σ_j |error of G_ij| as estimated, m², per element; of errors that are independent between
    /// pairs, three times the root of the sum of their squares.
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
    watch: &dyn Watch,
) -> Result<Assembled<S>, CouplingError> {
    assembly(integrator, watch, Vec::new()).map(|(assembled, _)| assembled)
}

/// Seconds that [`assemble`] takes one thread, from panels in all parts of the mesh: the mean time
/// of their pairs, times the number of all. `spent` tells the seconds that the calling thread has
/// worked; panels are computed until `budget` (s) is spent, one at least.
pub fn assembly_seconds(integrator: &PairIntegrator, budget: f64, spent: &dyn Fn() -> f64) -> f64 {
    let n = integrator.len();
    let progress = Progress::new(pairs(n), &Quiet);
    let started = spent();
    let clusters = integrator.clusters();
    // One panel of the usual size takes minutes in a large scene.
    let panels = clusters.panels((PAIRS_OF_A_SAMPLE / n.max(1)).clamp(1, PATCHES_OF_A_PANEL));
    let prepared = spent();
    let mut done = 0;
    for panel in scattered(panels.len()).map(|at| panels[at]) {
        let strip = Strip::<f64>::compute(integrator, &clusters, panel, false, &progress);
        std::hint::black_box(strip.rows.len());
        done += clusters.nodes[panel].places.clone().map(|place| place as u64).sum::<u64>();
        if spent() - started > budget {
            break;
        }
    }
    let of_all = if done == 0 { 0.0 } else { pairs(n) as f64 / done as f64 };
    prepared - started + (spent() - prepared) * of_all
}

/// As [`assemble`], with the estimated error of every G_ij, m²: 8 bytes more a pair.
///
/// # Errors
/// As of [`assemble`].
pub fn assemble_with_errors<S: Storage>(
    integrator: &PairIntegrator,
    watch: &dyn Watch,
) -> Result<(Assembled<S>, PackedSymmetric<f64>), CouplingError> {
    let n = integrator.len();
    let (assembled, errors) = assembly(integrator, watch, zeros(n)?)?;
    Ok((assembled, PackedSymmetric::new(n, errors)?))
}

/// `errors` has room for those of all pairs, or none where nobody asks for them.
fn assembly<S: Storage>(
    integrator: &PairIntegrator,
    watch: &dyn Watch,
    errors: Vec<f64>,
) -> Result<(Assembled<S>, Vec<f64>), CouplingError> {
    let n = integrator.len();
    let mut packed = Packed { values: zeros::<S>(n)?, errors };
    let progress = Progress::new(pairs(n), watch);
    let clusters = integrator.clusters();
    let panels = clusters.panels(PATCHES_OF_A_PANEL);
    let mut total = Report::new(n);
    for batch in panels.chunks(batch(n)) {
        let keep = !packed.errors.is_empty();
        let compute = |&panel: &usize| Strip::compute(integrator, &clusters, panel, keep, &progress);
        for strip in batch.par_iter().map(compute).collect::<Vec<_>>() {
            strip.rows.iter().for_each(|row| packed.place(row));
            total.merge(&strip.report);
        }
    }
    progress.finish()?;
    total.methods.hidden += pairs(n) - total.methods.sum();
    let matrix = PackedSymmetric::new(n, packed.values)?;
    let (error, Report { largest, methods, .. }) = (total.errors(), total);
    Ok((Assembled { matrix, error, largest, methods }, packed.errors))
}

/// Bytes of the entries of `n` patches that wait for their place in the matrix at most, besides the
/// matrix; with or without their errors.
#[must_use]
pub fn waiting_bytes<S: Storage>(n: usize, errors: bool) -> u64 {
    // The last batch has the longest rows.
    let batch = pairs(n) - pairs(n.saturating_sub(PATCHES_OF_A_PANEL * batch(n)));
    let entry = size_of::<u32>() + size_of::<S>() + if errors { size_of::<f64>() } else { 0 };
    batch * entry as u64
}

/// Panels of a batch.
fn batch(n: usize) -> usize {
    (MOST_WAITING_ENTRIES / PATCHES_OF_A_PANEL / n.max(1)).max(OF_A_THREAD * rayon::current_num_threads())
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

/// The packed lower triangles on their way.
struct Packed<S> {
    values: Vec<S>,
    errors: Vec<f64>,
}

impl<S: Storage> Packed<S> {
    fn place(&mut self, row: &Row<S>) {
        let place = |j: u32| {
            let (row, column) = (row.patch.max(j) as usize, row.patch.min(j) as usize);
            row * (row + 1) / 2 + column
        };
        row.columns.iter().zip(&row.values).for_each(|(&j, value)| self.values[place(j)] = *value);
        row.columns.iter().zip(&row.errors).for_each(|(&j, error)| self.errors[place(j)] = *error);
    }
}

/// Exchanges of one patch with others before it; `errors` is empty where nobody asks for them.
struct Row<S> {
    patch: u32,
    columns: Vec<u32>,
    values: Vec<S>,
    errors: Vec<f64>,
}

/// The pairs of one panel.
struct Strip<S> {
    keep_errors: bool,
    rows: Vec<Row<S>>,
    report: Report,
}

impl<S: Storage> Strip<S> {
    fn compute(
        integrator: &PairIntegrator,
        clusters: &Clusters,
        panel: usize,
        keep_errors: bool,
        progress: &Progress,
    ) -> Self {
        let mut strip = Self { keep_errors, rows: Vec::new(), report: Report::new(integrator.len()) };
        if progress.state().is_break() {
            return strip;
        }
        let sight = integrator.sight(clusters);
        let mut found = walk(&sight, panel);
        let (mut work, mut exchanges) = (Workspace::default(), Vec::new());
        for (row, place) in clusters.nodes[panel].places.clone().enumerate() {
            if progress.state().is_break() {
                return strip;
            }
            strip.row(integrator, clusters.order[place], row, &mut found, (&mut work, &mut exchanges));
            progress.advance(place as u64);
        }
        strip
    }

    fn row(
        &mut self,
        integrator: &PairIntegrator,
        i: u32,
        row: usize,
        found: &mut Panel,
        (work, exchanges): (&mut Workspace, &mut Vec<Exchange>),
    ) {
        let mut columns = std::mem::take(&mut found.seen[row]);
        let wholly = columns.len();
        columns.extend(found.partly[row].iter().map(|(j, _)| *j));
        integrator.open_row(i as usize, &columns, work, exchanges);
        for (k, (_, list)) in found.partly[row].iter().enumerate() {
            let k = wholly + k;
            let pair = [i, columns[k]].map(|patch| patch as usize);
            exchanges[k] = integrator.behind(pair, &found.lists[list.clone()], exchanges[k], work);
        }
        for (&j, exchange) in columns.iter().zip(&*exchanges) {
            let area = integrator.smaller_area(i as usize, j as usize);
            self.report.add(i as usize, j as usize, exchange, area);
        }
        let values = exchanges.iter().map(|exchange| S::from_f64(exchange.value)).collect();
        let kept = if self.keep_errors { &exchanges[..] } else { &[] };
        let errors = kept.iter().map(Exchange::stated).collect();
        self.rows.push(Row { patch: i, columns, values, errors });
    }
}

/// What one panel knows of its pairs.
struct Report {
    /// Sums of errors, m².
    error: Vec<f64>,
    /// Sums of the squares of standard errors, m⁴.
    variance: Vec<f64>,
    largest: f64,
    methods: MethodCounts,
}

impl Report {
    fn new(n: usize) -> Self {
        Self { error: vec![0.0; n], variance: vec![0.0; n], largest: 0.0, methods: MethodCounts::default() }
    }

    fn add(&mut self, i: usize, j: usize, exchange: &Exchange, area: f64) {
        self.largest = self.largest.max(exchange.stated() / area);
        for row in [i, j] {
            self.error[row] += exchange.error;
            self.variance[row] += exchange.deviation * exchange.deviation;
        }
        self.methods.add(exchange.method);
    }

    /// The stated errors of all rows, m².
    fn errors(&self) -> Vec<f64> {
        let row = |(error, variance): (&f64, &f64)| error + STANDARD_ERRORS * variance.sqrt();
        self.error.iter().zip(&self.variance).map(row).collect()
    }

    fn merge(&mut self, other: &Self) {
        self.error.iter_mut().zip(&other.error).for_each(|(a, b)| *a += b);
        self.variance.iter_mut().zip(&other.variance).for_each(|(a, b)| *a += b);
        self.largest = self.largest.max(other.largest);
        self.methods.merge(&other.methods);
    }
}

/// Counts pairs over all threads and asks the watch whether to go on.
struct Progress<'a> {
    steps: Steps<'a>,
    stopped: AtomicBool,
}

impl<'a> Progress<'a> {
    fn new(total: u64, watch: &'a dyn Watch) -> Self {
        Self { steps: Steps::new(watch, total, "pairs"), stopped: AtomicBool::new(false) }
    }

    fn advance(&self, pairs: u64) {
        if self.steps.add(pairs).is_break() {
            self.stopped.store(true, Ordering::Relaxed);
        }
    }

    fn state(&self) -> ControlFlow<()> {
        if self.stopped.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    fn finish(&self) -> Result<(), CouplingError> {
        if self.stopped.load(Ordering::Relaxed) {
            let (done, total) = (self.steps.done(), self.steps.total());
            return Err(CouplingError::Interrupted { done, total });
        }
        Ok(())
    }
}
