//! The chapters about a free peg: where it slid, hopped and rolled, why the axis rises and stops rising, what it all cost.

use super::facts::Facts;
use super::pieces::Piece;
use super::story::{Chapter, chapter};
use crate::analysis::course::{CourseReport, Doing, PegCourse, PegReport, Spell};
use crate::analysis::phrase::{duration, length, list, moment, pair, quantity, significant, span};
use crate::physics::friction::{Friction, FrictionLaw};
use crate::physics::kinematics::Tilt;
use crate::physics::math::sin_cos;
use crate::physics::top::Top;
use crate::run::scenario::Scenario;
use crate::run::simulation::{EventKind, StopReason};
use crate::telemetry::fields::FREE_PEG;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Flights with no more than this many nutations between them are hops of one series.
const APART: f64 = 2.0;
/// Nutations are small, as the theory of their growth has it, if the normal force differs from the weight, and the slip from
/// the motion of the peg's surface, which the theory has along the line of nodes, by no more than this part: what the theory
/// leaves out is of the order of its square.
const SMALL: f64 = 0.2;
/// The most series that are told one by one.
const SERIES: usize = 12;

/// Some spells that belong together.
#[derive(Clone, Debug, PartialEq)]
struct Series {
    doing: Doing,
    from: f64,
    to: f64,
    /// The spells in which the peg does it: hops, or slips in rolling.
    spells: Vec<Spell>,
}

impl Series {
    fn of(spell: &Spell) -> Self {
        Self {
            doing: spell.doing,
            from: spell.from,
            to: spell.to,
            spells: vec![*spell],
        }
    }

    fn count(&self) -> u64 {
        self.spells.len() as u64
    }
}

impl Facts {
    fn end(&self) -> f64 {
        self.course.stop_time()
    }

    fn spells(&self) -> Vec<Spell> {
        let peg = self.course.peg.as_ref();
        peg.map_or_else(Vec::new, |peg| peg.spells(self.end()))
    }

    /// How long a nutation takes at a time, s.
    fn nutation_at(&self, time: f64) -> f64 {
        let nutations = || {
            self.pieces
                .pieces
                .iter()
                .filter(|piece| piece.nutations > 0)
        };
        let before = nutations().rfind(|piece| piece.from <= time);
        let one = before.or_else(|| nutations().next());
        one.map_or(0.0, |piece| piece.duration() / piece.nutations as f64)
    }

    /// The spells with the hops that follow one another as one, and likewise what rolls and slips by turns.
    fn series(&self) -> Vec<Series> {
        let spells = self.spells();
        let mut series: Vec<Series> = Vec::new();
        for (index, spell) in spells.iter().enumerate() {
            let before = index.checked_sub(1).map(|before| spells[before]);
            let apart = APART * self.nutation_at(spell.from);
            // A flight that goes on after a short slide, and rolling that goes on after one.
            let is_short = before.is_some_and(|slide| {
                slide.doing == Doing::Slides && slide.duration() <= apart && index >= 2
            });
            let count = series.len();
            if is_short
                && count >= 2
                && series[count - 2].doing == spell.doing
                && spell.doing != Doing::Slides
            {
                series.pop();
                if let Some(last) = series.last_mut() {
                    last.to = spell.to;
                    last.spells.push(*spell);
                }
            } else {
                series.push(Series::of(spell));
            }
        }
        series
    }
}

/// What the top and its peg do, as verbs for the title.
pub(super) fn verbs(facts: &Facts) -> Option<String> {
    let peg = facts.course.peg.as_ref()?;
    let mut verbs: Vec<String> = Vec::new();
    let series = facts.series();
    for series in &series {
        let verb = match series.doing {
            Doing::Slides => "slides".to_owned(),
            Doing::Rolls => "rolls".to_owned(),
            Doing::Flies => flying(facts, peg, series),
        };
        verbs.push(verb);
    }
    if verbs.len() > 6 {
        let middle = verbs.len() - 5;
        verbs.splice(3..verbs.len() - 2, [format!("so on {middle} times more")]);
    }
    verbs.extend(end_on_table(facts).map(|(_, verb, _)| verb.to_owned()));
    (!verbs.is_empty()).then(|| format!("its peg {}", list(&verbs)))
}

/// What ends a run on the table, if that happened: the time, s, a verb for the title, and what the peg did.
fn end_on_table(facts: &Facts) -> Option<(f64, &'static str, &'static str)> {
    let ends = [
        (
            EventKind::Jam,
            "jams",
            "the peg jammed: no force of the table keeps it out of it",
        ),
        (
            EventKind::Pivot,
            "pivots",
            "the contact point came to rest under an axis that turned about the vertical only: rolling resistance held it",
        ),
    ];
    let events = &facts.course.events;
    ends.into_iter().find_map(|(kind, verb, told)| {
        let event = events.iter().find(|event| event.name == kind.name())?;
        Some((event.time, verb, told))
    })
}

/// What a peg does that is in the air again and again.
fn flying(facts: &Facts, peg: &PegCourse, series: &Series) -> String {
    let impacts = impacts_in(peg, series.from, series.to).unwrap_or(0);
    // What ends in the air may not have touched the table.
    let least = u64::from(series.to < facts.end());
    match (series.count(), impacts.max(least)) {
        (1, 0) => "flies".to_owned(),
        (1, 1) => "hops".to_owned(),
        (1, impacts) => format!("bounces {}", times(impacts)),
        (hops, _) => format!("hops {}", times(hops)),
    }
}

/// How often something is done.
pub(super) fn times(count: u64) -> String {
    match count {
        1 => "once".to_owned(),
        2 => "twice".to_owned(),
        _ => format!("{count} times"),
    }
}

/// How many impacts there are from one time to another, the last included, if they are recorded.
fn impacts_in(peg: &PegCourse, from: f64, to: f64) -> Option<u64> {
    let within = |time: f64| time >= from && time <= to;
    let hits = peg.known_impacts()?.iter().filter(|hit| within(hit.time));
    Some(hits.count() as u64)
}

/// Tells of the impacts that interrupt no flight: of a peg that is thrown onto the table, and stays there.
fn thrown_down(peg: &PegCourse, series: &[Series]) -> Option<String> {
    let is_in = |series: &Series, time: f64| {
        series.doing == Doing::Flies && series.from <= time && time <= series.to
    };
    let mut alone = peg
        .known_impacts()?
        .iter()
        .filter(|hit| !series.iter().any(|series| is_in(series, hit.time)));
    let first = alone.next()?;
    let more = match alone.count() as u64 {
        0 => String::new(),
        more => format!(", and {} more", times(more)),
    };
    Some(format!(
        "At {} the peg hit the table at {}{more}, without leaving it.",
        moment(first.time),
        quantity(first.speed, 3, "m/s")
    ))
}

/// The chapter on what the peg did.
pub(super) fn course(facts: &Facts) -> Option<Chapter> {
    let peg = facts.course.peg.as_ref()?;
    let series = facts.series();
    let tell = |series: &Series| told(facts, peg, series);
    let mut sentences: Vec<String> = if series.len() > SERIES {
        let (first, last) = (&series[..SERIES / 2], &series[series.len() - SERIES / 2..]);
        let left_out = series.len() - SERIES;
        let middle = format!(
            "So it went on by turns, {left_out} times more, until {}.",
            moment(last[0].from)
        );
        let first = first.iter().map(tell);
        first.chain([middle]).chain(last.iter().map(tell)).collect()
    } else {
        series.iter().map(tell).collect()
    };
    sentences.splice(0..0, thrown_down(peg, &series));
    let end = end_on_table(facts);
    sentences.extend(end.map(|(time, _, told)| format!("At {} {told}.", moment(time))));
    sentences.extend(peg.travelled.map(|(_, farthest)| {
        format!(
            "The point of contact was never farther than {} from where it began, in any sample.",
            quantity(farthest, 3, "m")
        )
    }));
    let chapter = chapter("What the peg did", sentences)?;
    Some(Chapter {
        is_list: true,
        ..chapter
    })
}

fn told(facts: &Facts, peg: &PegCourse, series: &Series) -> String {
    let Series {
        doing, from, to, ..
    } = *series;
    let span = span(from, to);
    let is_last = to >= facts.end() && !facts.is_cut;
    match doing {
        Doing::Slides => format!("{span} the peg slid."),
        Doing::Rolls => {
            let first = series.spells[0];
            let begins = if first.theta.is_finite() {
                format!(", at first inclined by {}", quantity(first.theta, 4, "rad"))
            } else {
                String::new()
            };
            let slips = match series.count() - 1 {
                0 => String::new(),
                1 => " It slipped once in between.".to_owned(),
                slips => format!(" It slipped {slips} times in between."),
            };
            let end = if is_last { ", to the end," } else { "" };
            format!("{span}{end} the peg rolled{begins}.{slips}")
        }
        Doing::Flies => flight(facts, peg, series, is_last),
    }
}

/// Tells of a flight, or a series of hops.
fn flight(facts: &Facts, peg: &PegCourse, series: &Series, is_last: bool) -> String {
    let Series { from, to, .. } = *series;
    let span = span(from, to);
    let peaks = peg.peaks.iter().filter(|(_, at)| *at >= from && *at <= to);
    let highest = peaks.map(|(height, _)| *height).fold(f64::NAN, f64::max);
    let height = if highest.is_finite() {
        format!(
            ", {} above the table in the highest sample",
            length(highest)
        )
    } else if facts.has(FREE_PEG) {
        ", so briefly that no sample shows it".to_owned()
    } else {
        String::new()
    };
    let impacts = impacts_in(peg, from, to).unwrap_or(0);
    let hops = series.count();
    let mut told = if hops == 1 {
        format!("{span} the peg was in the air{height}.")
    } else {
        let aloft: f64 = series.spells.iter().map(Spell::duration).sum();
        let longest = series.spells.iter().map(Spell::duration);
        let nutations = facts
            .pieces
            .pieces
            .iter()
            .filter(|piece| piece.nutations == 1 && piece.from < to && piece.to > from)
            .count() as u64;
        let once = if hops > 2 && nutations.abs_diff(hops) <= 1 {
            ", once a nutation"
        } else {
            ""
        };
        format!(
            "{span} the peg hopped {}{once}: it was in the air for {} in all, {} at a time at most{height}.",
            times(hops),
            duration(aloft),
            duration(longest.fold(0.0, f64::max)),
        )
    };
    if impacts > hops {
        let fastest = peg
            .impacts
            .iter()
            .filter(|hit| hit.time >= from && hit.time <= to)
            .map(|hit| hit.speed)
            .fold(0.0, f64::max);
        told.push_str(&format!(
            " It bounced: there were {impacts} impacts, at {} at most.",
            quantity(fastest, 3, "m/s")
        ));
    }
    let has_landed = {
        let mut events = facts.course.events.iter();
        events.any(|event| event.name == EventKind::Landing.name() && event.time >= to)
    };
    if is_last {
        told.push_str(if has_landed {
            " It landed as the run ended."
        } else {
            " It had not come to stay on the table when the run ended."
        });
    }
    told
}

/// The chapter on why the axis moves.
pub(super) fn motion(facts: &Facts) -> Option<Chapter> {
    let peg = facts.course.peg.as_ref()?;
    let mut sentences = exchange(facts, peg);
    sentences.extend(growth(facts));
    sentences.extend(inversion(facts, peg));
    sentences.extend(end_of_slip(facts, peg));
    chapter("Why the axis moves", sentences)
}

/// The nutations in which the peg slides all along.
fn sliding(facts: &Facts) -> Vec<&Piece> {
    let spells = facts.spells();
    let slides: Vec<&Spell> = spells
        .iter()
        .filter(|spell| spell.doing == Doing::Slides)
        .collect();
    let nutations = facts.pieces.pieces.iter();
    nutations
        .filter(|piece| piece.nutations == 1)
        .filter(|piece| {
            let holds = |spell: &&&Spell| spell.from <= piece.from && piece.to <= spell.to;
            slides.iter().find(holds).is_some()
        })
        .collect()
}

/// Tells how friction exchanges angular momentum about the axis for such about the vertical.
fn exchange(facts: &Facts, peg: &PegCourse) -> Vec<String> {
    let top = &facts.scenario.model.top;
    let nutations = facts.pieces.pieces.iter();
    let known: Vec<_> = nutations
        .filter(|piece| piece.nutations == 1 && piece.momenta.iter().all(|m| m.is_finite()))
        .collect();
    let ([first, .., last], Some([_, drift])) = (known.as_slice(), peg.jellett) else {
        return Vec::new();
    };
    let momenta = [0, 1].map(|index| [first, last].map(|piece| piece.momenta[index]));
    let [axial, vertical] = momenta.map(|momenta| facts.went(momenta, "kg m²/s"));
    let mut sentences = vec![format!(
        "About the centre of mass, from the first nutation to the last, the angular momentum along the symmetry axis \
         {axial}, that about the vertical {vertical}."
    )];
    let changed = |[first, last]: [f64; 2]| last - first;
    let is_clear = momenta.iter().all(|momenta| {
        let size = momenta[0].abs().max(momenta[1].abs());
        changed(*momenta).abs() > facts.floor(size)
    });
    if is_clear && drift <= jellett_floor(facts, peg) {
        sentences.push(format!(
            "A force at the point of contact can only exchange one for the other, {} kg m²/s of the latter for each of the \
             former: that is −l/R, because Jellett's integral l L_n + R L_z′ stays.",
            significant(-top.center_distance / top.peg_radius, 4),
        ));
    }
    sentences
}

/// Tells how the nutation grew while the peg slid for the first time, and what theory says of it.
fn growth(facts: &Facts) -> Vec<String> {
    let spells = facts.spells();
    // A tippe top leaves upright for other reasons.
    let is_tippe = facts.scenario.model.top.center_distance < 0.0;
    let slide = spells
        .first()
        .filter(|spell| spell.doing == Doing::Slides && !is_tippe);
    let Some(slide) = slide else {
        return Vec::new();
    };
    let pieces: Vec<_> = sliding(facts)
        .into_iter()
        .filter(|piece| piece.to <= slide.to && piece.swing.is_finite())
        .collect();
    let greatest = pieces
        .iter()
        .max_by(|one, other| one.swing.total_cmp(&other.swing));
    let (Some(first), Some(greatest)) = (pieces.first(), greatest) else {
        return Vec::new();
    };
    let size = first.rates.psi.abs();
    if greatest.swing - first.swing <= facts.floor(size) || first.swing <= facts.floor(size) {
        return Vec::new();
    }
    let weight = facts.scenario.model.top.weight();
    let [least, most] = greatest.contact.loads.map(|load| load / weight);
    let [begun, ended] = pair([first.swing, greatest.swing]);
    let mut told = vec![format!(
        "While the peg slid first, the amplitude of θ̇ grew from {begun} rad/s in the first nutation to {ended} rad/s in that \
         from {} on: the nodding moves the centre of mass up and down, so that the normal force and friction with it change \
         in step; in samples of that nutation the normal force was between {} and {} times the weight.",
        moment(greatest.from),
        significant(least, 3),
        significant(most, 3),
    )];
    let small = pieces.iter().take_while(|piece| is_small(facts, piece));
    let small: Vec<&Piece> = small.copied().collect();
    if let ([begun, .., ended], Some(predicted)) =
        (small.as_slice(), predicted_growth(facts, &small))
        && let measured = significant(ended.swing / begun.swing, 3)
        // What three digits don't show is not told.
        && measured != significant(1.0, 3)
    {
        told.push(format!(
            "As long as the normal force kept to the weight, and the slip to the motion of the peg's surface, within a fifth, \
             until {}, it became {} times as large; the theory of small nutations under Coulomb friction has {} times.",
            moment(ended.to),
            measured,
            significant(predicted, 3)
        ));
    }
    told
}

/// Whether a nutation is as the theory of their growth has it: the normal force keeps to the weight, and the slip to what spin
/// and precession make of it, to which nodding and the motion of the centre of mass add little.
fn is_small(facts: &Facts, piece: &Piece) -> bool {
    let top = &facts.scenario.model.top;
    let [least, most] = piece.contact.loads.map(|load| load / top.weight());
    let (_, cos) = sin_cos(piece.theta);
    let nodding = (top.peg_radius + top.center_distance * cos).abs() * piece.swing;
    let (slip, surface) = (piece.contact.slip, surface_speed(top, piece));
    let moving = slip * slip - 2.0 * piece.contact.along * surface + surface * surface;
    let most_added = SMALL * slip;
    1.0 - least <= SMALL
        && most - 1.0 <= SMALL
        && nodding <= most_added
        && moving <= most_added * most_added
}

/// How fast spin and precession make the surface of the peg run over the table, along the line of nodes, m/s.
fn surface_speed(top: &Top, piece: &Piece) -> f64 {
    let (sin, _) = sin_cos(piece.theta);
    (top.peg_radius * piece.rates.psi - top.center_distance * piece.rates.phi) * sin
}

/// The coefficient of a friction force that is the same multiple of the normal force at any slip, without other losses.
fn constant_coefficient(friction: &Friction) -> Option<f64> {
    match friction.law {
        FrictionLaw::Coulomb { k } if !friction.has_losses() && k > 0.0 => Some(k),
        _ => None,
    }
}

/// By what factor small nutations grow through some in which the peg slides under Coulomb friction along the line of nodes: at
/// the rate `(k/2) [M l s (l + R c) L_n/(A A_θ) − (M g/|v|)(R + l c)²/A_θ]` with `A_θ = A + M l² s²`.
fn predicted_growth(facts: &Facts, pieces: &[&Piece]) -> Option<f64> {
    let k = constant_coefficient(&facts.scenario.model.friction)?;
    let top = &facts.scenario.model.top;
    let (mass, l, radius, central) = (
        top.mass,
        top.center_distance,
        top.peg_radius,
        top.central_moment(),
    );
    // From the middle of the first nutation to that of the last.
    let rate = |piece: &Piece| {
        let (sin, cos) = sin_cos(piece.theta);
        let rocking = central + mass * l * l * sin * sin;
        let height = radius + l * cos;
        let momentum = piece.momenta[0] * surface_speed(top, piece).signum();
        let driven = mass * l * sin * (l + radius * cos) * momentum / (central * rocking);
        let damped = top.weight() / piece.contact.slip * height * height / rocking;
        0.5 * k * (driven - damped)
    };
    let exponent: f64 = pieces
        .windows(2)
        .map(|pair| {
            let middles = [0, 1].map(|i| 0.5 * (pair[i].from + pair[i].to));
            0.5 * (rate(pair[0]) + rate(pair[1])) * (middles[1] - middles[0])
        })
        .sum();
    let factor = crate::physics::math::exp(exponent);
    factor.is_finite().then_some(factor)
}

/// Tells why the slip ended, or that nothing can end it.
fn end_of_slip(facts: &Facts, peg: &PegCourse) -> Vec<String> {
    let friction = &facts.scenario.model.friction;
    let spells = facts.spells();
    let Some(last) = spells.last() else {
        return Vec::new();
    };
    let mut sentences = Vec::new();
    if !friction.is_set_valued_at_rest() || friction.is_none() {
        if last.doing == Doing::Slides && !friction.is_none() {
            sentences.push(
                "This law has no force at rest: a contact point that hardly slips is hardly held, so that the peg does not \
                 come to roll."
                    .to_owned(),
            );
        }
        return sentences;
    }
    let first_roll = spells
        .iter()
        .position(|spell| spell.doing == Doing::Rolls && spell.from > 0.0);
    if let Some(at) = first_roll
        && spells[at - 1].doing == Doing::Slides
    {
        sentences.extend(steady_sliding(facts, &spells[at]));
    }
    if last.doing == Doing::Rolls {
        sentences.extend(rolling(facts, peg));
    } else if last.doing == Doing::Slides && is_timed_out(facts) {
        sentences.push(format!(
            "At {}, when the run ended, the peg still slid: whether and where it comes to roll this run does not tell.",
            moment(facts.end())
        ));
    }
    sentences
}

/// Whether the run ended because its time was over.
fn is_timed_out(facts: &Facts) -> bool {
    let reason = facts.course.report().stop_reason;
    reason.as_deref() == Some(StopReason::Duration.name())
}

/// Tells how steady sliding comes to its end.
fn steady_sliding(facts: &Facts, roll: &Spell) -> Option<String> {
    let k = constant_coefficient(&facts.scenario.model.friction)?;
    let top = &facts.scenario.model.top;
    let before = facts
        .pieces
        .pieces
        .iter()
        .rfind(|piece| piece.nutations == 1 && !piece.rolls && piece.to <= roll.from)?;
    let axial = before.momenta[0];
    let psi = roll.rates[1];
    let slow = top.gravity_moment() / axial;
    let surface = top.peg_radius * psi - top.center_distance * slow;
    let sine = (k * axial / (top.mass * top.center_distance * surface)).abs();
    let turned = turned_until(facts, roll.from)?;
    let begun = "The peg's surface runs over the table at (Rψ̇ − lφ̇) sin θ. Friction turns with the precession and drives the centre \
         of mass round a circle, in steady sliding at k g/φ̇; where the two are equal nothing slips any more. With φ̇ = \
         M g l/L_n that is so at sin θ = k L_n/[M l (Rψ̇ − lφ̇)]";
    if turned < TAU {
        return Some(format!(
            "{begun}. Here the force had turned by {} only when the peg came to roll, inclined by {}: the sliding had not \
             become steady.",
            quantity(turned, 3, "rad"),
            quantity(roll.theta, 4, "rad"),
        ));
    }
    // Without it, as where the numbers are not finite, the sliding can't come to its end so.
    let is_reached = sine < 1.0;
    is_reached.then(|| {
        format!(
            "{begun}, here at θ = {}; the peg came to roll at {}, at θ = {}.",
            quantity(
                crate::physics::math::atan2(sine, (1.0 - sine * sine).sqrt()),
                3,
                "rad"
            ),
            moment(roll.from),
            quantity(roll.theta, 4, "rad"),
        )
    })
}

/// By how much the precession has turned from the first nutation to a time, rad.
fn turned_until(facts: &Facts, time: f64) -> Option<f64> {
    let nutations = facts.pieces.pieces.iter();
    let turned: Vec<f64> = nutations
        .filter(|piece| piece.nutations > 0 && piece.to <= time)
        .map(|piece| piece.rates.phi * piece.duration())
        .collect();
    (!turned.is_empty()).then(|| turned.iter().sum::<f64>().abs())
}

/// Tells what rolling does to the axis.
fn rolling(facts: &Facts, peg: &PegCourse) -> Option<String> {
    let rolled = peg.rolled.last()?;
    let [first, last] = rolled.energies;
    let [routh, drift] = rolled.routh;
    let span = span(rolled.span[0], rolled.span[1]);
    if facts.scenario.model.friction.has_losses() {
        let [begun, ended] = pair(rolled.energies);
        return Some(format!(
            "A contact point at rest does no work. {span} what other torques took lowered the energy from {begun} to {ended} J."
        ));
    }
    let is_constant = (last - first).abs() <= facts.floor(first) && drift <= facts.floor(routh);
    if !is_constant || rolled.span[0] == rolled.span[1] {
        return None;
    }
    let to = match routh {
        0.0 => String::new(),
        routh => format!(", to {} of itself", significant(drift / routh.abs(), 1)),
    };
    let mut told = format!(
        "A contact point at rest does no work. {span} the energy stayed at {}, and Routh's integral too{to}.",
        quantity(last, 6, "J"),
    );
    if let Some(swing) = rolled.swing {
        let [least, greatest] = pair(swing);
        told.push_str(&format!(
            " With them and Jellett's the inclination can only swing between {least} and {greatest} rad as long as the peg rolls."
        ));
    }
    if rolled.grip.is_finite() {
        told.push_str(&format!(
            " In samples it took a friction force of up to {} of the normal force to hold the contact point; there can be {}.",
            significant(rolled.grip, 3),
            significant(facts.scenario.model.friction.law.static_bound(1.0), 3),
        ));
    }
    Some(told)
}

/// Tells of a tippe top whether sliding friction can turn it over (S. Rauch-Wojciechowski and N. Rutstam, SIGMA 10 (2014)
/// 017).
fn inversion(facts: &Facts, peg: &PegCourse) -> Option<String> {
    let top = &facts.scenario.model.top;
    let [jellett, _] = peg.jellett?;
    if top.center_distance >= 0.0 || facts.scenario.model.friction.has_losses() {
        return None;
    }
    let radius = top.peg_radius;
    let (alpha, gamma) = (
        -top.center_distance / radius,
        top.central_moment() / top.axial_moment,
    );
    let shape = format!(
        "the moments of inertia about the centre of mass have the ratio γ = {}, and |l|/R is α = {}",
        significant(gamma, 4),
        significant(alpha, 3)
    );
    if !(1.0 - alpha < gamma && gamma < 1.0 + alpha) {
        return Some(format!(
            "Sliding friction turns a tippe top over only if 1 − α < γ < 1 + α: here {shape}, which is not so."
        ));
    }
    let size = top.weight() * radius * radius * radius * top.axial_moment * alpha;
    let threshold = size.sqrt() * (1.0 + alpha) * (1.0 + alpha) / (1.0 + alpha - gamma).sqrt();
    let exceeds = if jellett.abs() > threshold {
        "exceeds"
    } else {
        "does not exceed"
    };
    Some(format!(
        "Sliding friction turns a tippe top over if 1 − α < γ < 1 + α and Jellett's integral is large enough. Here {shape}; \
         Jellett's integral, {} kg m³/s, {exceeds} the {} that it takes.",
        significant(jellett.abs(), 4),
        significant(threshold, 4),
    ))
}

/// What the integrator's errors can have made of Jellett's integral: its two terms have them, which may cancel, and where these
/// are small the rates have the absolute tolerance, as if they were 1 rad/s.
fn jellett_floor(facts: &Facts, peg: &PegCourse) -> f64 {
    let top = &facts.scenario.model.top;
    let reach = top.center_distance.abs() + top.peg_radius;
    let slow = reach * top.central_moment().max(top.axial_moment);
    facts.floor(1.0) * (peg.jellett_size() + slow)
}

/// The chapter on energies and integrals.
pub(super) fn energy(facts: &Facts, course: &CourseReport) -> Option<Chapter> {
    let (peg, report) = (facts.course.peg.as_ref()?, course.peg.as_ref()?);
    let (first, last) = (course.energy_first?, course.energy_last?);
    let mut sentences = Vec::new();
    let last_sample = course.last_sample?;
    if let Some(hit) = peg.impacts.iter().find(|hit| hit.time > last_sample) {
        sentences.push(format!(
            "What follows is told up to the last sample, at {}: an impact came after it, at {}.",
            moment(last_sample),
            moment(hit.time)
        ));
    }
    if let Some(stayed) = facts.energy_stayed(course) {
        sentences.push(stayed);
    } else {
        let [begun, ended] = pair([first, last]);
        sentences.push(format!(
            "The mechanical energy fell by {}, from {begun} to {ended} J; what friction and impacts did accounts for all of \
             it but {}.",
            quantity(first - last, 4, "J"),
            quantity(course.energy_imbalance?, 2, "J"),
        ));
        sentences.extend(losses(facts, report, first));
    }
    if let Some([begun, ended]) = peg.translational {
        let [begun, ended] = [begun, ended].map(|energy| facts.or_zero(energy, first));
        sentences.push(format!(
            "The kinetic energy of the centre of mass was {} at first and {} at last.",
            quantity(begun, 3, "J"),
            quantity(ended, 3, "J")
        ));
    }
    if let Some(path) = course.slip_path.filter(|path| *path > 0.0) {
        sentences.push(format!(
            "The point of contact slipped {} in all.",
            quantity(path, 3, "m")
        ));
    }
    sentences.extend(jellett(facts, peg));
    chapter("Where the energy goes", sentences)
}

/// Tells what took how much.
fn losses(facts: &Facts, report: &PegReport, size: f64) -> Option<String> {
    let told = [
        (report.lost_sliding?, "sliding"),
        (report.lost_losses?, "rolling resistance, drilling and air"),
        (
            report.lost_restitution?,
            "compression and restitution in impacts",
        ),
        (report.lost_impact_friction?, "friction in impacts"),
    ]
    .into_iter()
    .filter(|(lost, _)| lost.abs() > facts.floor(size))
    .map(|(lost, what)| format!("{what} took {}", quantity(lost, 3, "J")));
    let told: Vec<String> = told.collect();
    (!told.is_empty()).then(|| format!("Of that {}.", list(&told)))
}

/// Tells what became of Jellett's integral.
fn jellett(facts: &Facts, peg: &PegCourse) -> Option<String> {
    let [first, drift] = peg.jellett?;
    let size = peg.jellett_size();
    if size <= jellett_floor(facts, peg) {
        return None;
    }
    // Terms that cancel leave rounding.
    let is_rounding = first.abs() <= 4.0 * f64::EPSILON * size;
    let value = quantity(if is_rounding { 0.0 } else { first }, 5, "kg m³/s");
    let part = significant(drift / size, 2);
    Some(if drift <= jellett_floor(facts, peg) {
        format!(
            "Jellett's integral l L_n + R L_z′ stayed at {value}, to {part} of its terms: no force at the point of contact \
             changes it, in sliding, rolling or impacts."
        )
    } else if facts.scenario.model.friction.has_losses()
        || facts.scenario.model.friction.turns_about_vertical()
    {
        format!(
            "Jellett's integral l L_n + R L_z′, {value} at first, changed by up to {}: torques that come from no force at the \
             point of contact did that.",
            quantity(drift, 3, "kg m³/s")
        )
    } else {
        format!(
            "Jellett's integral l L_n + R L_z′, {value} at first, changed by up to {part} of its terms, by no torque that is \
             known here."
        )
    })
}

/// What the chapter about the top says of a free peg.
pub(super) fn beginning(scenario: &Scenario) -> Vec<String> {
    let top = &scenario.model.top;
    let start = scenario.start();
    let mut told = Vec::new();
    let height = start.peg_position.z - top.peg_radius;
    let upward = start.peg_velocity.z;
    told.push(if height <= 0.0 && upward > 0.0 {
        format!(
            "The peg is free to move, and is thrown up from the table at {}.",
            quantity(upward, 3, "m/s")
        )
    } else if height > 0.0 {
        format!(
            "The peg is free to move, and begins {} above the table.",
            length(height)
        )
    } else {
        let velocity = start.peg_velocity.norm();
        // What is left of two velocities that cancel is rounding.
        let tilt = Tilt::from_rates(scenario.angles.theta, scenario.rates);
        let turning = top.center_distance.abs() * tilt.omega_lean.norm();
        let moves = if velocity > 4.0 * f64::EPSILON * turning {
            format!("moves at {} at first", quantity(velocity, 3, "m/s"))
        } else {
            "is at rest at first".to_owned()
        };
        format!("The peg is free to move over the table; its centre {moves}.")
    });
    if top.center_distance < 0.0 {
        told.push(format!(
            "The centre of mass is {} below the ball's centre when the axis is upright: a tippe top.",
            length(-top.center_distance)
        ));
    }
    if scenario.is_frictionless() {
        told.push("Nothing resists the slip.".to_owned());
    }
    told
}

/// The words for what the axis of a tippe top does, whose centre of mass is below its sphere's centre.
pub(super) fn tippe_verb(verb: &str, thetas: [f64; 2]) -> &str {
    let [first, last] = thetas;
    match verb {
        "rises" if first > FRAC_PI_2 && last < FRAC_PI_2 => "turns back",
        "rises" => "straightens up",
        "sinks" if first < FRAC_PI_2 && last > FRAC_PI_2 => "turns over",
        "sinks" => "leans farther",
        "falls" => "tips over",
        "neither rises nor sinks" => "neither turns over nor straightens up",
        other => other,
    }
}
