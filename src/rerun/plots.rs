//! Plots: the numbers that charts show, as curves.

pub(super) mod curves;
pub(super) mod means;
pub(super) mod outline;

use rerun::Scalars;

use self::curves::{Curves, Derived};
use self::means::Means;
use self::outline::Outline;
use super::identity::Identity;
use super::output::track::Track;
use super::output::{ComponentColumns, Output};
use super::role::Role;
use crate::physics::math;
use crate::telemetry::arrows::snapshot::Snapshot;
use crate::telemetry::fields::{
    FREE_PEG, NUTATION, NumberField, POSE, Plot, STATE, events, free_peg, nutation, pose,
    precession, state,
};
use crate::telemetry::{Message, Quantity, Topic};

/// The range before the first value.
const NO_VALUES: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

/// Sine of the inclination below which φ and ψ, and so their rates, are undefined as good as at the vertical itself: they
/// would be peaks that scale their charts.
const UPRIGHT: f64 = 0.02;

/// Numbers that are left out near the vertical.
const UNDEFINED_UPRIGHT: [NumberField; 6] = [
    state::PHI_DOT,
    state::PSI_DOT,
    nutation::PHI_DOT_MEAN,
    nutation::PSI_DOT_MEAN,
    precession::EXCESS,
    // It follows from ψ̇.
    precession::SLOW_ROOT,
];

/// The plots of each channel, in table order, and those that follow from several channels.
pub(super) struct Plots {
    fields: Vec<Vec<PlotTrack>>,
    derived: Vec<PlotTrack>,
    /// Whether the last state was near the vertical; never for differences.
    is_upright: bool,
    is_of_run: bool,
    /// The first value of Jellett's integral, kg m³/s.
    jellett: Option<f64>,
}

/// Curves of a chart.
struct PlotTrack {
    curves: Curves,
    numbers: Vec<NumberField>,
    quantities: Vec<Quantity>,
    track: Track<f64>,
    /// The least and the greatest value of each number; reversed infinite bounds before the first.
    ranges: Vec<[f64; 2]>,
    /// The course of all numbers together.
    outline: Outline,
    /// Time of the last row, ns.
    end_ns: u64,
}

impl Plots {
    /// Opens the `wanted` plots, and sends their names and colours.
    pub(super) fn new(wanted: impl Fn(Plot) -> bool, role: &Role, output: &mut Output) -> Self {
        let mut fields = Vec::new();
        for topic in Topic::all() {
            let mut tracks = Vec::new();
            for plot in Plot::all(topic) {
                if wanted(plot) {
                    tracks.push(PlotTrack::new(Curves::Field(plot), role, output));
                }
            }
            fields.push(tracks);
        }
        Self {
            fields,
            derived: Vec::new(),
            is_upright: false,
            jellett: None,
            is_of_run: matches!(role, Role::Alone | Role::Compared(..)),
        }
    }

    /// Opens the curves that follow from several channels, as far as a recording has these.
    pub(super) fn with_derived(
        mut self,
        identity: &Identity,
        role: &Role,
        output: &mut Output,
    ) -> Self {
        for curves in Derived::ALL.map(Curves::Derived) {
            if curves.is_in(identity) {
                self.derived.push(PlotTrack::new(curves, role, output));
            }
        }
        self
    }

    fn find(&self, curves: Curves) -> Option<&PlotTrack> {
        let tracks = match curves {
            Curves::Field(plot) => &self.fields[plot.topic().index()],
            Curves::Derived(_) => &self.derived,
        };
        tracks.iter().find(|track| track.curves == curves)
    }

    /// The quantities of curves that have values, each with its least and its greatest value.
    pub(super) fn ranges(&self, curves: Curves) -> impl Iterator<Item = (Quantity, [f64; 2])> {
        self.find(curves)
            .into_iter()
            .flat_map(|track| {
                let quantities = track.quantities.iter().copied();
                quantities.zip(track.ranges.iter().copied())
            })
            .filter(|(_, range)| *range != NO_VALUES)
    }

    /// The outline of curves, if they are among these.
    pub(super) fn outline(&self, curves: Curves) -> Option<&Outline> {
        Some(&self.find(curves)?.outline)
    }

    /// Adds a row without values to plots that end before this time, so that time axes extend to it.
    pub(super) fn extend_to(&mut self, time_ns: u64, output: &mut Output) {
        let plots = self.fields.iter_mut().flatten();
        for plot in plots.filter(|plot| plot.end_ns < time_ns) {
            // NaN is not drawn.
            let missing = std::iter::repeat_n(f64::NAN, plot.numbers.len());
            plot.track.push(output, time_ns, missing);
        }
    }

    /// Adds a row of the numbers of a message, mapped by `value`; skipped if it returns `None` for any.
    pub(super) fn write(
        &mut self,
        message: &Message<'_>,
        value: impl Fn(f64) -> Option<f64>,
        output: &mut Output,
    ) {
        if self.is_of_run {
            self.derive(message, output);
        }
        for plot in &mut self.fields[message.channel] {
            plot.write_fields(message, &value, self.is_upright, output);
        }
    }

    /// Adds the curves that follow from a message of the run.
    fn derive(&mut self, message: &Message<'_>, output: &mut Output) {
        match message.topic() {
            STATE => self.is_upright = is_upright(state::THETA.of(message)),
            NUTATION => {
                let extremes = [nutation::THETA_MIN, nutation::THETA_MAX];
                self.is_upright = extremes.iter().any(|angle| is_upright(angle.of(message)));
            }
            POSE => {
                let spin = [pose::OMEGA_BODY.z().of(message)];
                self.write_derived(Derived::AxialRate, message.time_ns, &spin, output);
            }
            FREE_PEG => {
                let jellett = free_peg::JELLETT.of(message);
                let change = [jellett / *self.jellett.get_or_insert(jellett) - 1.0];
                self.write_derived(Derived::JellettChange, message.time_ns, &change, output);
            }
            _ => {}
        }
    }

    /// Marks the event of a message.
    pub(super) fn mark_event(&mut self, message: &Message<'_>, output: &mut Output) {
        let theta = [events::THETA.of(message)];
        self.write_derived(Derived::EventMarks, message.time_ns, &theta, output);
    }

    /// Adds the curves that follow from a sample.
    pub(super) fn write_snapshot(&mut self, snapshot: &Snapshot, output: &mut Output) {
        let horizontal = snapshot.horizontal_momentum().norm();
        let parts = [horizontal, snapshot.momentum.z];
        let along = [torque_along_horizontal(snapshot)];
        let time_ns = snapshot.time_ns;
        self.write_derived(Derived::MomentumParts, time_ns, &parts, output);
        self.write_derived(Derived::TorqueAlong, time_ns, &along, output);
    }

    /// Adds the means over a nutation.
    pub(super) fn write_means(&mut self, means: &Means, output: &mut Output) {
        for (derived, row) in &means.terms {
            self.write_derived(*derived, means.time_ns, row, output);
        }
    }

    /// Adds a row of curves that follow from several channels.
    fn write_derived(&mut self, derived: Derived, time_ns: u64, row: &[f64], output: &mut Output) {
        let mut tracks = self.derived.iter_mut();
        if let Some(track) = tracks.find(|track| track.curves == Curves::Derived(derived)) {
            track.write(time_ns, row, output);
        }
    }
}

/// The torque of friction along the horizontal part of the angular momentum, N m; 0 if that has no direction.
pub(super) fn torque_along_horizontal(snapshot: &Snapshot) -> f64 {
    let horizontal = snapshot.horizontal_momentum();
    match horizontal.try_normalize(0.0) {
        Some(direction) => direction.dot(&snapshot.friction_torque),
        // NaN stays NaN.
        None => 0.0 * snapshot.friction_torque.norm() * horizontal.norm(),
    }
}

/// Whether the Euler rates are left out at this inclination, rad.
fn is_upright(theta: f64) -> bool {
    math::sin(theta).abs() < UPRIGHT
}

impl PlotTrack {
    /// Empty curves; sends names and colours.
    fn new(curves: Curves, role: &Role, output: &mut Output) -> Self {
        let entity = role.entity(&curves.path());
        let numbers = match curves {
            Curves::Field(plot) => plot.numbers().collect(),
            Curves::Derived(_) => Vec::new(),
        };
        let quantities = curves.quantities();
        let width = quantities.len();
        output.send_static(entity.as_str(), &*curves.series(role));
        Self {
            curves,
            numbers,
            quantities,
            track: Track::new(entity, move |rows| columns(rows, width), output),
            ranges: vec![NO_VALUES; width],
            outline: Outline::new(),
            end_ns: 0,
        }
    }

    fn write_fields(
        &mut self,
        message: &Message<'_>,
        value: impl Fn(f64) -> Option<f64>,
        is_upright: bool,
        output: &mut Output,
    ) {
        let mut row = Vec::with_capacity(self.numbers.len());
        for number in &self.numbers {
            if is_upright && UNDEFINED_UPRIGHT.contains(number) {
                // Not drawn.
                row.push(f64::NAN);
                continue;
            }
            let Some(number) = value(number.of(message)) else {
                return;
            };
            row.push(number);
        }
        self.write(message.time_ns, &row, output);
    }

    fn write(&mut self, time_ns: u64, row: &[f64], output: &mut Output) {
        for (range, number) in self.ranges.iter_mut().zip(row) {
            // Both ignore NaN.
            *range = [range[0].min(*number), range[1].max(*number)];
            self.outline.add(time_ns, *number);
        }
        self.track.push(output, time_ns, row.iter().copied());
        self.end_ns = time_ns;
    }
}

/// The components of rows with this number of scalars.
pub(super) fn columns(numbers: &[f64], width: usize) -> ComponentColumns {
    let lengths = std::iter::repeat_n(width, numbers.len() / width);
    let scalars = Scalars::new(numbers.iter().copied());
    Ok(scalars.columns(lengths)?.collect())
}
