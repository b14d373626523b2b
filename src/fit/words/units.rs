//! Units of reports: the page shows angles in degrees, as its sliders and curves do.

use super::super::remedy::Interface;
use super::super::report::{Limit, Oddity, Report};
use std::borrow::Cow;

/// Degrees per radian.
const DEGREES: f64 = 180.0 / std::f64::consts::PI;

/// A report in the units of an interface.
pub(super) fn shown(report: &Report, interface: Interface) -> Cow<'_, Report> {
    match interface {
        Interface::Terminal | Interface::Python => Cow::Borrowed(report),
        Interface::Page => Cow::Owned(in_degrees(report.clone())),
    }
}

/// A report whose angles are in degrees.
fn in_degrees(mut report: Report) -> Report {
    for (at, estimate) in report.parameters.iter_mut().enumerate() {
        if estimate.unit != "rad" {
            continue;
        }
        "°".clone_into(&mut estimate.unit);
        estimate.start *= DEGREES;
        estimate.value *= DEGREES;
        estimate.sd = estimate.sd.map(|sd| sd * DEGREES);
        estimate.interval = estimate.interval.map(|ends| ends.map(|end| end * DEGREES));
        estimate.limit = estimate.limit.map(limit_in_degrees);
        for mode in &mut report.modes {
            mode.values[at] *= DEGREES;
            mode.sds[at] *= DEGREES;
        }
    }
    for signal in &mut report.signals {
        if signal.unit == "rad" {
            "°".clone_into(&mut signal.unit);
            signal.sigma *= DEGREES;
            signal.oddity = signal.oddity.map(oddity_in_degrees);
        }
    }
    report
}

fn limit_in_degrees(limit: Limit) -> Limit {
    match limit {
        Limit::Below(value) => Limit::Below(value * DEGREES),
        Limit::Above(value) => Limit::Above(value * DEGREES),
        Limit::AtBound | Limit::None => limit,
    }
}

fn oddity_in_degrees(oddity: Oddity) -> Oddity {
    match oddity {
        Oddity::Constant { value } => Oddity::Constant {
            value: value * DEGREES,
        },
        Oddity::OneValue { time, value } => Oddity::OneValue {
            time,
            value: value * DEGREES,
        },
    }
}
