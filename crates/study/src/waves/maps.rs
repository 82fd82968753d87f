//! Maps of one component of E over the grid of a receiver.

use fredholm_mesh::Mesh;
use fredholm_report::{FieldMap, MapAxis, MapPlane, WaveRow};
use fredholm_scene::waves::{Layout, Places};

use super::model::Receiver;

const SYMBOLS: [&str; 3] = ["Ex", "Ey", "Ez"];
const FILE_NAMES: [&str; 3] = ["ex", "ey", "ez"];

/// The grid of a receiver, between the outlines of the bodies.
pub(super) struct Grid {
    columns: usize,
    axes: [MapAxis; 2],
    aspect: Option<f64>,
    outline: Vec<[(f64, f64); 2]>,
}

impl Grid {
    /// That of a receiver; none where its points are no grid.
    pub(super) fn of(receiver: &Receiver, mesh: &Mesh) -> Option<Self> {
        let Places::Near { layout: Layout::Grid(columns), points } = &receiver.places else { return None };
        let plane = MapPlane::of(points, *columns);
        // Points in a single line span no plane: they are counted.
        let counted = |label: &str, count: usize| MapAxis {
            label: label.to_owned(),
            from: 1.0,
            to: count.max(1) as f64,
        };
        let rows = points.len() / (*columns).max(1);
        let axes =
            plane.map_or_else(|| [counted("column", *columns), counted("row", rows)], |plane| plane.axes());
        Some(Self {
            columns: *columns,
            axes,
            aspect: plane.map(|plane| plane.aspect()),
            outline: plane.map_or_else(Vec::new, |plane| plane.outline(mesh)),
        })
    }

    /// Values of a component on it.
    pub(super) fn map<'a>(
        &'a self,
        title: &'a str,
        component: Component,
        values: &'a [[f64; 2]],
    ) -> FieldMap<'a> {
        FieldMap {
            title,
            quantity: (SYMBOLS[component.0], "V/m"),
            axes: self.axes.clone(),
            aspect: self.aspect,
            columns: self.columns,
            values,
            outline: &self.outline,
        }
    }
}

/// A component of E.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Component(usize);

impl Component {
    /// The one in which the total field has most power.
    pub(super) fn strongest(rows: &[&WaveRow]) -> Self {
        let power = |c: usize| rows.iter().map(|row| square(Self(c).of(row))).sum::<f64>();
        Self((0..3).max_by(|&a, &b| power(a).total_cmp(&power(b))).unwrap_or(0))
    }

    /// That of the total field at a point, V/m: real and imaginary part.
    pub(super) fn of(self, row: &WaveRow) -> [f64; 2] {
        let total = row.total();
        [total[2 * self.0], total[2 * self.0 + 1]]
    }

    /// As file names have it.
    pub(super) fn name(self) -> &'static str {
        FILE_NAMES[self.0]
    }
}

fn square([re, im]: [f64; 2]) -> f64 {
    re * re + im * im
}
