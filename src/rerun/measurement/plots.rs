//! Plots of measured values over the run that was fitted to them.

use rerun::components::MarkerShape;
use std::sync::Arc;

use crate::rerun::entity::FIT_REPORT;
use crate::rerun::measurement::{MeasuredSignal, Measurement};
use crate::rerun::output::Output;
use crate::rerun::output::track::Track;
use crate::rerun::palette::{GREEN, GREY, ORANGE, PALE, SKY};
use crate::rerun::plots::columns;
use crate::rerun::style::{self, LineStyle};
use crate::telemetry::Message;
use crate::telemetry::supplement::{FIT_DATA, FIT_RESIDUAL};

/// Half width of the band in which 95 % of the values are expected, σ.
const BAND: f64 = 2.0;

/// A curve, or points, of a signal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::rerun) enum Series {
    /// The fitted values.
    Measured,
    /// The values that were held out.
    HeldOut,
    /// The run.
    Fitted,
    /// The run ± 2σ.
    Band,
    /// Residuals of the fitted values.
    Residual,
    /// Residuals of the values that were held out.
    HeldOutResidual,
    /// Zero and ± 2σ.
    Bounds,
}

impl Series {
    /// The curves in a chart of the values.
    pub(in crate::rerun) const VALUES: [Self; 4] =
        [Self::Band, Self::Fitted, Self::Measured, Self::HeldOut];
    /// The curves in a chart of the residuals.
    pub(in crate::rerun) const RESIDUALS: [Self; 3] =
        [Self::Bounds, Self::Residual, Self::HeldOutResidual];

    /// The entity for a signal with this path.
    pub(in crate::rerun) fn entity(self, path: &str) -> String {
        match self {
            Self::Measured => format!("{FIT_DATA}{path}"),
            Self::HeldOut => format!("{FIT_DATA}{path}/held_out"),
            Self::Fitted => format!("/fit/curve{path}"),
            Self::Band => format!("/fit/curve{path}/band"),
            Self::Residual => format!("{FIT_RESIDUAL}{path}"),
            Self::HeldOutResidual => format!("{FIT_RESIDUAL}{path}/held_out"),
            Self::Bounds => format!("{FIT_RESIDUAL}{path}/bounds"),
        }
    }

    /// Sends names and colours for a signal with this number of values, and opens the rows.
    fn open(self, path: &str, count: usize, output: &mut Output) -> Track<f64> {
        let entity = self.entity(path);
        // Viewers list equal names once.
        let styles: &[LineStyle] = match self {
            Self::Measured => &[("measured", ORANGE, 0.0)],
            Self::Residual => &[("fitted", ORANGE, 0.0)],
            Self::HeldOut | Self::HeldOutResidual => &[("held out", GREEN, 0.0)],
            Self::Fitted => &[("best fit", SKY, 1.8)],
            Self::Band => &[("±2σ", PALE, 1.0), ("±2σ", PALE, 1.0)],
            Self::Bounds => &[("±2σ", SKY, 1.2), ("0", GREY, 0.7), ("±2σ", SKY, 1.2)],
        };
        match self {
            Self::Fitted | Self::Band | Self::Bounds => {
                output.send_static(entity.as_str(), &style::lines(styles));
            }
            Self::Measured | Self::HeldOut | Self::Residual | Self::HeldOutResidual => {
                let points = points(styles[0], count);
                output.send_static(
                    entity.as_str(),
                    &style::marks(&[points], MarkerShape::Circle),
                );
            }
        }
        let width = styles.len();
        Track::new(entity, move |rows| columns(rows, width), output)
    }
}

/// Number of values of a signal up to which they are large.
const FEW: usize = 400;

/// Sizes of few and of many values.
const SIZES: [f32; 2] = [2.2, 1.4];

/// Opacity of many values (0 to 255).
const FAINT: u32 = 0xA0;

/// The points of a signal with this number of values. Viewers draw points over lines: many large ones would hide the curve.
fn points((name, color, _): LineStyle, count: usize) -> LineStyle {
    if count > FEW {
        (name, color & !0xFF | FAINT, SIZES[1])
    } else {
        (name, color, SIZES[0])
    }
}

/// The curves of the run, as far as it was measured.
pub(in crate::rerun) struct Measured {
    measurement: Arc<Measurement>,
    curves: Vec<FittedCurve>,
}

/// The curve of the run for a signal.
struct FittedCurve {
    fitted: Track<f64>,
    band: Track<f64>,
    /// Index of the last measured value that is not later than the run.
    place: usize,
}

impl Measured {
    /// Sends the measured values and the report.
    pub(in crate::rerun) fn new(measurement: &Arc<Measurement>, output: &mut Output) -> Self {
        output.send_static(FIT_REPORT, &measurement.document());
        let mut curves = Vec::new();
        for (signal, path) in measurement.signals.iter().zip(measurement.paths()) {
            let count = signal.values.len();
            send_values(signal, &path, output);
            curves.push(FittedCurve {
                fitted: Series::Fitted.open(&path, count, output),
                band: Series::Band.open(&path, count, output),
                place: 0,
            });
        }
        Self {
            measurement: Arc::clone(measurement),
            curves,
        }
    }

    /// Adds the fields of a message that were measured.
    pub(in crate::rerun) fn write(&mut self, message: &Message<'_>, output: &mut Output) {
        for (signal, curve) in self.measurement.signals.iter().zip(&mut self.curves) {
            if signal.field.topic() == message.topic() {
                curve.write(signal, message, output);
            }
        }
    }
}

impl FittedCurve {
    fn write(&mut self, signal: &MeasuredSignal, message: &Message<'_>, output: &mut Output) {
        let time_ns = message.time_ns;
        let later = signal.values.get(self.place + 1..).unwrap_or_default();
        self.place += later.iter().take_while(|v| v.time_ns <= time_ns).count();
        let value = signal.field.of(message);
        self.fitted.push(output, time_ns, [value]);
        if let Some(measured) = signal.values.get(self.place) {
            let half = BAND * measured.sigma;
            self.band
                .push(output, time_ns, [value - half, value + half]);
        }
    }
}

/// Sends the values of a signal and their residuals.
fn send_values(signal: &MeasuredSignal, path: &str, output: &mut Output) {
    let count = signal.values.len();
    for (value_series, residual_series, is_held_out) in [
        (Series::Measured, Series::Residual, false),
        (Series::HeldOut, Series::HeldOutResidual, true),
    ] {
        let mut part = signal
            .values
            .iter()
            .filter(|v| v.is_held_out == is_held_out)
            .peekable();
        if part.peek().is_none() {
            continue;
        }
        let values = value_series.open(path, count, output);
        let residuals = residual_series.open(path, count, output);
        for value in part {
            values.push(output, value.time_ns, [value.value]);
            residuals.push(output, value.time_ns, [value.residual]);
        }
    }
    let bounds = Series::Bounds.open(path, count, output);
    for value in signal
        .values
        .first()
        .into_iter()
        .chain(signal.values.last())
    {
        bounds.push(output, value.time_ns, [-BAND, 0.0, BAND]);
    }
}
