//! Why the axis moved: what friction did to the precession, and how φ̇ compared with the rates of regular precession.

use super::facts::Facts;
use super::pieces::Piece;
use super::story::{Chapter, PrecessionReport, StageReport};
use super::totals::Until;
use crate::analysis::phrase::{list, moment, pair, quantity, significant};
use crate::physics::kinematics::Tilt;
use crate::physics::math::sin_cos;
use crate::physics::top::Top;

/// The number of stages in the table.
const STAGES: usize = 6;
/// The greatest difference of the averaged φ̇ to a rate of regular precession, as a part of it, with which φ̇ keeps to
/// that rate. A mean over a nutation differs from the rate at the mean inclination by about the square of the ripple
/// over the inclination: this allows for a ripple of a fifth of it.
const NEAR: f64 = 0.05;
/// The terms of φ̈ are told, with four digits, if their integrals add up to its change to this part of the largest. No
/// tolerance holds for them, and near the vertical they are larger than anything that one holds for.
const CLOSED: f64 = 5e-4;
/// A change of φ̇ that is less than this part of what friction did to it is small beside it: four fifths and more have been
/// answered, and so it may be said that the answer keeps φ̇.
const SMALL: f64 = 0.2;
/// Beside what friction did to it, φ̇ has stayed as it was if it changed by less than this part: the θ̇ that cancels friction
/// is then that which keeps φ̇ to as much.
const STEADY: f64 = 0.05;
/// Shares of time are told only where a nutation has at least this many samples: fewer meet it at the same few phases.
const SAMPLES_PER_NUTATION: f64 = 8.0;

/// One of the two rates of regular precession.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Root {
    Slow,
    Fast,
}

impl Root {
    fn name(self) -> &'static str {
        match self {
            Self::Slow => "slow",
            Self::Fast => "fast",
        }
    }

    fn of(self, piece: &Piece) -> f64 {
        piece.regular.roots[usize::from(self == Self::Fast)]
    }

    /// The rate of regular precession at an inclination and an axial angular momentum.
    fn at_momentum(self, top: &Top, cos: f64, axial: f64) -> Option<f64> {
        let (transverse, gravity) = (top.transverse_moment, top.gravity_moment());
        let discriminant = axial * axial - 4.0 * transverse * cos * gravity;
        if discriminant < 0.0 {
            return None;
        }
        let half_sum = 0.5 * (axial + discriminant.sqrt().copysign(axial));
        let rate = match self {
            Self::Slow => gravity / half_sum,
            Self::Fast => half_sum / (transverse * cos),
        };
        Some(rate).filter(|rate| rate.is_finite())
    }
}

/// The inclination of regular precession with these angular momenta about the axis and the vertical, near `theta`.
fn regular_inclination(
    top: &Top,
    root: Root,
    [axial, vertical]: [f64; 2],
    theta: f64,
) -> Option<f64> {
    let excess = |theta: f64| {
        let (sin, cos) = sin_cos(theta);
        let rate = root.at_momentum(top, cos, axial)?;
        Some(top.transverse_moment * sin * sin * rate + axial * cos - vertical)
    };
    // Outward until the excess changes its sign, then halving.
    let mut width = 1e-3 * theta;
    while width < 0.5 * theta {
        let (mut low, mut high) = (theta - width, theta + width);
        let at_low = excess(low)?;
        if at_low * excess(high)? <= 0.0 {
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if at_low * excess(middle)? > 0.0 {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            return Some(0.5 * (low + high));
        }
        width *= 1.5;
    }
    None
}

impl Facts {
    fn top(&self) -> &Top {
        &self.scenario.model.top
    }

    /// The nutations during which the contact point slips and precession and spin can be told apart.
    fn nutations(&self) -> Vec<&Piece> {
        let end = self
            .pieces
            .totals
            .until
            .map_or(f64::INFINITY, |(_, time)| time);
        let pieces = self.pieces.pieces.iter();
        pieces
            .filter(|piece| piece.nutations > 0 && piece.to <= end)
            .collect()
    }

    /// The last of these nutations: which it is, if it is not the last of all.
    fn last_nutation(&self) -> &'static str {
        let pieces = self.pieces.pieces.iter();
        let all = pieces.filter(|piece| piece.nutations > 0).count();
        match self.pieces.totals.until {
            Some((Until::Vertical, _)) if self.nutations().len() < all => {
                "the last before the axis came within 0.01 rad of the vertical"
            }
            Some((Until::Stick, _)) if self.nutations().len() < all => {
                "the last before the contact point stuck"
            }
            _ => "the last",
        }
    }

    /// The rate of regular precession that the averaged φ̇ kept to, with the greatest difference, rad/s.
    fn followed(&self) -> Option<(Root, f64)> {
        let nutations = self.nutations();
        if nutations.is_empty() {
            return None;
        }
        [Root::Slow, Root::Fast].into_iter().find_map(|root| {
            let mut greatest = 0.0_f64;
            for piece in &nutations {
                let rate = root.of(piece);
                let difference = (piece.rates.phi - rate).abs();
                let is_near = difference <= NEAR * rate.abs();
                if !is_near {
                    return None;
                }
                greatest = greatest.max(difference);
            }
            Some((root, greatest))
        })
    }
}

/// What changed φ̇ and, by friction, ψ̇.
pub(super) fn precession_report(facts: &Facts) -> Option<PrecessionReport> {
    let totals = &facts.pieces.totals;
    let (first, last) = (totals.first?, totals.last?);
    let ([gyroscopic, coriolis], [frictional, spin_frictional]) = totals.changes()?;
    if let (Some(gyroscopic), Some(coriolis)) = (gyroscopic, coriolis) {
        let change = last.rates[0] - first.rates[0];
        let missed = gyroscopic + coriolis + frictional - change;
        let sizes = [gyroscopic, coriolis, frictional, change].map(f64::abs);
        let largest = sizes.into_iter().fold(0.0, f64::max);
        if missed.abs() > CLOSED * largest + facts.floor(largest) {
            return None;
        }
    }
    Some(PrecessionReport {
        from: first.time,
        to: last.time,
        first: first.rates[0],
        last: last.rates[0],
        gyroscopic,
        coriolis,
        frictional,
        spin_first: first.rates[1],
        spin_last: last.rates[1],
        spin_frictional,
    })
}

/// The chapter on what friction did to φ̇.
pub(super) fn precession(facts: &Facts, report: &PrecessionReport) -> Option<Chapter> {
    let change = report.last - report.first;
    let friction = report.frictional;
    let span = match facts.pieces.totals.until {
        Some((Until::Vertical, _)) => {
            ", the last sample before the axis came within 0.01 rad of the vertical,"
        }
        Some((Until::Stick, _)) => ", the last sample before the contact point stuck,",
        None => "",
    };
    let span = format!(
        "From {} to {}{span}",
        moment(report.from),
        moment(report.to)
    );
    let mut sentences = Vec::new();
    let size = report.first.abs().max(report.last.abs()).max(change.abs());
    if friction.abs() <= facts.floor(size) {
        sentences.push(format!(
            "Nothing of friction is in the equation of the precession. {span} φ̇ {}.",
            facts.went([report.first, report.last], "rad/s")
        ));
    } else {
        let answer = match (report.gyroscopic, report.coriolis) {
            (Some(gyroscopic), Some(coriolis)) => format!(
                "The gyroscopic term added {} and the Coriolis term {}",
                quantity(gyroscopic, 4, "rad/s"),
                quantity(coriolis, 4, "rad/s"),
            ),
            _ => format!(
                "The gyroscopic and the Coriolis term together added {}",
                quantity(change - friction, 4, "rad/s")
            ),
        };
        let [first, last] = pair([report.first, report.last]);
        sentences.push(format!(
            "{span} friction by itself would have {}: that is the integral of its term in φ̈. {answer}, so that φ̇ \
             changed by {}, from {first} to {last} rad/s at single instants.",
            effect(facts, friction),
            quantity(change, 3, "rad/s"),
        ));
        let opposes = (change - friction) * friction < 0.0;
        if opposes && change.abs() < SMALL * friction.abs() {
            sentences.push(
                "Both are proportional to θ̇: they can answer only while the axis rises or sinks. Pushed in the sense of \
                 its precession or against it, a spinning top gives way at right angles."
                    .to_owned(),
            );
        }
    }
    if let [first, .., last] = facts.nutations().as_slice() {
        sentences.push(format!(
            "From the first nutation to {} the averaged φ̇ {}.",
            facts.last_nutation(),
            facts.went([first.rates.phi, last.rates.phi], "rad/s")
        ));
    }
    let spin = report.spin_frictional;
    if spin.abs() > facts.floor(report.spin_first.abs().max(report.spin_last.abs())) {
        sentences.push(format!(
            "Friction's term in ψ̈ amounts to {}; ψ̇ {}.",
            quantity(spin, 4, "rad/s"),
            facts.went([report.spin_first, report.spin_last], "rad/s")
        ));
    }
    Some(Chapter {
        heading: "What friction does to the precession",
        sentences,
        ..Chapter::default()
    })
}

/// What friction would have done to φ̇ by itself. A precession that turned one way all along, by its means, is quickened
/// or slowed.
fn effect(facts: &Facts, friction: f64) -> String {
    let pieces = &facts.pieces.pieces;
    let turns =
        |sign: f64| !pieces.is_empty() && pieces.iter().all(|piece| sign * piece.rates.phi > 0.0);
    let size = quantity(friction.abs(), 4, "rad/s");
    if turns(friction) {
        format!("quickened the precession by {size}")
    } else if turns(-friction) {
        format!("slowed the precession by {size}")
    } else {
        format!("changed φ̇ by {}", quantity(friction, 4, "rad/s"))
    }
}

/// The chapter on the rates of regular precession, and what they make of θ.
pub(super) fn motion(facts: &Facts) -> Option<Chapter> {
    let mut sentences = roots(facts);
    sentences.extend(momenta(facts));
    sentences.extend(cancelling(facts));
    sentences.extend(shares(facts));
    let rows: Vec<_> = reports(facts);
    let is_fast = facts.followed().is_some_and(|(root, _)| root == Root::Fast);
    let table = (!rows.is_empty()).then(|| {
        let rows = rows.iter().map(|stage| row(facts, stage, is_fast));
        let rows = rows.collect();
        (header(is_fast), rows)
    });
    Some(Chapter {
        heading: "Why the axis moves",
        sentences,
        table,
        ..Chapter::default()
    })
}

/// Compares φ̇ with the rates of regular precession.
fn roots(facts: &Facts) -> Vec<String> {
    let top = facts.top();
    let start = Tilt::from_rates(facts.scenario.angles.theta, facts.scenario.rates);
    let quadratic = (top.transverse_moment - top.axial_moment) * start.cos;
    let nutations = facts.nutations();
    let is_known = |piece: &&&Piece| piece.regular.roots.iter().all(|root| root.is_finite());
    let known: Vec<_> = nutations.iter().filter(is_known).collect();
    let place = match (known.first(), known.last()) {
        (Some(first), Some(last)) => {
            let rates = |root: usize| {
                facts.went(
                    [first, last].map(|piece| piece.regular.roots[root]),
                    "rad/s",
                )
            };
            format!(
                "at the inclination and spin of the nutations, from the first to {}, the slow one {} and the fast \
                 one {}",
                facts.last_nutation(),
                rates(0),
                rates(1)
            )
        }
        _ => match top.precession_roots(&start) {
            Some(roots) => format!(
                "at the start {} and {}",
                quantity(roots.slow, 4, "rad/s"),
                quantity(roots.fast, 4, "rad/s")
            ),
            None => return vec![no_roots(top, &start, quadratic)],
        },
    };
    let signs = if quadratic > 0.0 {
        ["negative", "positive"]
    } else {
        ["positive", "negative"]
    };
    let mut sentences = vec![format!(
        "At two rates a top precesses regularly, without nodding: {place}. Friction's own term in θ̈ aside, θ̈ is {} between \
         them and {} outside.",
        signs[0], signs[1],
    )];
    sentences.extend(match (nutations.as_slice(), facts.followed()) {
        ([], _) => beginning(facts, &start, signs),
        (_, Some((root, greatest))) => {
            let size = nutations[0].rates.phi;
            let how = if greatest <= facts.floor(size) {
                "as exactly as the integration tells".to_owned()
            } else {
                format!("to {} at most", quantity(greatest, 2, "rad/s"))
            };
            let name = root.name();
            Some(format!(
                "Averaged over each {} φ̇ kept to the {name} rate, {how}.",
                match facts.last_nutation() {
                    "the last" => "nutation",
                    _ => "of these nutations",
                }
            ))
        }
        (_, None) => Some("Averaged over nutations φ̇ did not keep to either.".to_owned()),
    });
    sentences
}

/// Tells where φ̇ was at the start, of a run without nutations.
fn beginning(facts: &Facts, start: &Tilt, [between, outside]: [&str; 2]) -> Option<String> {
    let roots = facts.top().precession_roots(start)?;
    let phi = start.rates.phi;
    let (least, greatest) = if roots.slow < roots.fast {
        (roots.slow, roots.fast)
    } else {
        (roots.fast, roots.slow)
    };
    let (place, sign) = if phi < least {
        ("below both", outside)
    } else if phi > greatest {
        ("above both", outside)
    } else {
        ("between them", between)
    };
    Some(format!(
        "At the start φ̇ was {}, {place}: θ̈ was {sign}.",
        quantity(phi, 4, "rad/s")
    ))
}

/// Tells why there are no two rates of regular precession.
fn no_roots(top: &Top, start: &Tilt, quadratic: f64) -> String {
    let spin = top.axial_moment * start.rates.psi;
    if spin * spin < 4.0 * quadratic * top.gravity_moment() {
        "There is no real rate of regular precession at the start: the spin is too weak for θ̈ to vanish at any φ̇, so that \
         it is positive whatever the precession."
            .to_owned()
    } else {
        "There are no two rates of regular precession to compare φ̇ with.".to_owned()
    }
}

/// Tells how the angular momenta incline the axis: the averaged motion is a regular precession that adjusts to them.
fn momenta(facts: &Facts) -> Vec<String> {
    let (Some((root, _)), nutations) = (facts.followed(), facts.nutations()) else {
        return Vec::new();
    };
    let known = nutations
        .iter()
        .filter(|piece| piece.momenta.iter().all(|momentum| momentum.is_finite()));
    let known: Vec<_> = known.collect();
    let [first, .., last] = known.as_slice() else {
        return Vec::new();
    };
    let about = |index: usize, axis: &str| {
        let momenta = [first, last].map(|piece| piece.momenta[index]);
        format!("that about {axis} {}", facts.went(momenta, "kg m²/s"))
    };
    let told = [about(0, "the symmetry axis"), about(1, "the vertical")];
    let mut sentences = vec![format!("Of the angular momentum, {}.", list(&told))];
    let inclination =
        |piece: &Piece| regular_inclination(facts.top(), root, piece.momenta, piece.theta);
    if let (Some(begun), Some(ended)) = (inclination(first), inclination(last)) {
        sentences.push(format!(
            "From the first nutation to {} the inclination of regular precession at the {} rate with these momenta \
             {}, and that of the axis, averaged, {}.",
            facts.last_nutation(),
            root.name(),
            facts.went([begun, ended], "rad"),
            facts.went([first.theta, last.theta], "rad"),
        ));
    }
    sentences
}

/// Compares the θ̇ that friction demands with the θ̇ that there was.
fn cancelling(facts: &Facts) -> Option<String> {
    let (_, report) = (facts.followed()?, precession_report(facts)?);
    let nutations: Vec<Piece> = facts.nutations().into_iter().copied().collect();
    let whole = Piece::together(&nutations)?;
    let change = nutations.last()?.rates.phi - nutations.first()?.rates.phi;
    let friction = whole.friction * whole.duration();
    let is_small = change.abs() < STEADY * friction.abs();
    if !is_small || report.frictional.abs() <= facts.floor(report.first) {
        return None;
    }
    let demanded = Some(whole.regular.demanded).filter(|rate| rate.is_finite())?;
    Some(format!(
        "For the gyroscopic and Coriolis terms of φ̈ to cancel friction's, θ̇ has to be {} on average; it was {}.",
        quantity(demanded, 4, "rad/s"),
        quantity(whole.rates.theta, 4, "rad/s"),
    ))
}

/// Tells what nodding does at single instants.
fn shares(facts: &Facts) -> Option<String> {
    let (root, _) = facts.followed()?;
    let totals = &facts.pieces.totals;
    let shortest = facts
        .nutations()
        .iter()
        .map(|piece| piece.duration())
        .fold(f64::INFINITY, f64::min);
    let is_resolved = shortest >= SAMPLES_PER_NUTATION * totals.step()?;
    if totals.rooted == 0 || !is_resolved {
        return None;
    }
    let percent = |count: u64| significant(100.0 * count as f64 / totals.rooted as f64, 3);
    let above = totals.above[usize::from(root == Root::Fast)];
    let shares = if percent(totals.rising) == percent(above) {
        format!(", and θ̈ negative, for {} % of the time", percent(above))
    } else {
        format!(
            " for {} % of the time, and θ̈ negative for {} % of it",
            percent(above),
            percent(totals.rising)
        )
    };
    Some(format!(
        "At single instants the nodding hides this: φ̇ was above the {} rate{shares}.",
        root.name(),
    ))
}

/// Means over the stages of the table.
pub(super) fn reports(facts: &Facts) -> Vec<StageReport> {
    let stages = facts.pieces.in_stages(STAGES);
    stages.iter().map(report).collect()
}

fn report(stage: &Piece) -> StageReport {
    let known = |value: f64| Some(value).filter(|value| value.is_finite());
    let [slow, fast] = stage.regular.roots;
    StageReport {
        from: stage.from,
        to: stage.to,
        nutations: stage.nutations,
        theta: stage.theta,
        theta_dot: stage.rates.theta,
        theta_dot_demanded: known(stage.regular.demanded),
        phi_dot: stage.rates.phi,
        slow_root: known(slow),
        fast_root: known(fast),
        psi_dot: stage.rates.psi,
    }
}

fn header(is_fast: bool) -> Vec<String> {
    [
        "time [s]",
        "nutations",
        "θ [rad]",
        "θ̇ [rad/s]",
        "θ̇ demanded",
        "φ̇ [rad/s]",
        if is_fast { "fast rate" } else { "slow rate" },
        "ψ̇ [rad/s]",
    ]
    .map(str::to_owned)
    .to_vec()
}

fn row(facts: &Facts, stage: &StageReport, is_fast: bool) -> Vec<String> {
    let duration = stage.to - stage.from;
    let theta_dot = facts.or_zero(stage.theta_dot * duration, stage.theta) / duration;
    let rates = [stage.phi_dot, stage.psi_dot];
    let size = rates[0].abs().max(rates[1].abs());
    let [phi_dot, psi_dot] = rates.map(|rate| facts.or_zero(rate, size));
    let known = |value: Option<f64>, digits| {
        value.map_or("–".to_owned(), |value| significant(value, digits))
    };
    let root = if is_fast {
        stage.fast_root
    } else {
        stage.slow_root
    };
    vec![
        format!("{:.2} to {:.2}", stage.from, stage.to),
        stage.nutations.to_string(),
        significant(stage.theta, 4),
        significant(theta_dot, 3),
        known(stage.theta_dot_demanded, 3),
        significant(phi_dot, 5),
        known(root, 5),
        significant(psi_dot, 5),
    ]
}
