//! Campaigns, their trials, and random numbers that follow from a seed.

use crate::{bombs, damage, environments, interruptions, overlaps, scenarios};
use clap::Parser;
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use std::time::Instant;
use toprise::physics::math::{exp, ln};

/// How the bench is started.
#[derive(Debug, Parser)]
pub struct Arguments {
    /// Try a sample of two minutes.
    #[arg(long)]
    sample: bool,
    /// Try everything.
    #[arg(long, conflicts_with = "sample")]
    full: bool,
    /// Where the random numbers start.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Try this one case of each campaign.
    #[arg(long)]
    case: Option<u64>,
    /// Campaigns, with the number of trials if it is not to be the usual one: flips, kills=50.
    campaigns: Vec<String>,
}

/// Something that is tried many times.
pub struct Campaign {
    name: &'static str,
    sample: u64,
    full: u64,
    /// Makes what the trials need; says why it can't be tried here.
    prepare: fn() -> Result<Trial, String>,
}

/// Tries one case; the error says what went wrong.
pub type Trial = Box<dyn Fn(&mut Random) -> Result<(), String> + Sync>;

/// All campaigns.
pub const CAMPAIGNS: &[Campaign] = &[
    Campaign {
        name: "flips",
        sample: 4_000,
        full: 200_000,
        prepare: damage::flips,
    },
    Campaign {
        name: "splices",
        sample: 300,
        full: 10_000,
        prepare: damage::splices,
    },
    Campaign {
        name: "bombs",
        sample: 12,
        full: 300,
        prepare: bombs::bombs,
    },
    Campaign {
        name: "overlaps",
        sample: 1,
        full: 1,
        prepare: overlaps::overlaps,
    },
    Campaign {
        name: "kills",
        sample: 30,
        full: 1_000,
        prepare: interruptions::kills,
    },
    Campaign {
        name: "races",
        sample: 15,
        full: 500,
        prepare: interruptions::races,
    },
    Campaign {
        name: "signals",
        sample: 14,
        full: 300,
        prepare: interruptions::signals,
    },
    Campaign {
        name: "scenarios",
        sample: 30,
        full: 10_000,
        prepare: scenarios::scenarios,
    },
    Campaign {
        name: "environments",
        sample: environments::COUNT,
        full: environments::COUNT,
        prepare: environments::environments,
    },
    Campaign {
        name: "cpus",
        sample: 1,
        full: environments::CPUS,
        prepare: environments::cpus,
    },
];

/// Maximum number of reported failures of a campaign; the others are only counted.
const TOLD: usize = 10;

/// Runs the requested campaigns. Returns whether all cases passed.
pub fn run(arguments: &Arguments, campaigns: &[Campaign]) -> bool {
    let mut held = true;
    for wanted in &arguments.campaigns {
        let name = wanted.split('=').next();
        if !campaigns.iter().any(|campaign| Some(campaign.name) == name) {
            println!("there is no campaign {wanted}");
            held = false;
        }
    }
    println!("seed {}", arguments.seed);
    // A panic is reported with its case.
    set_hook(Box::new(|_| {}));
    for campaign in campaigns {
        if let Some(count) = arguments.count_of(campaign) {
            held &= try_all(campaign, count, arguments);
        }
    }
    held
}

impl Arguments {
    /// How often a campaign is tried, if it is.
    fn count_of(&self, campaign: &Campaign) -> Option<u64> {
        let usual = if self.full {
            campaign.full
        } else {
            campaign.sample
        };
        if self.campaigns.is_empty() {
            return Some(usual);
        }
        self.campaigns.iter().find_map(|wanted| {
            let (name, count) = wanted.split_once('=').unwrap_or((wanted, ""));
            (name == campaign.name).then(|| count.parse().unwrap_or(usual))
        })
    }
}

/// Tries the cases of a campaign on all processors.
fn try_all(campaign: &Campaign, count: u64, arguments: &Arguments) -> bool {
    let started = Instant::now();
    let trial = match (campaign.prepare)() {
        Ok(trial) => trial,
        Err(reason) => {
            println!("{:<14}skipped: {reason}", campaign.name);
            return true;
        }
    };
    let (first, last) = arguments.case.map_or((0, count), |case| (case, case + 1));
    let next = AtomicU64::new(first);
    let failures = Mutex::new(Vec::new());
    let work = || {
        loop {
            let case = next.fetch_add(1, Ordering::Relaxed);
            if case >= last {
                return;
            }
            let mut random = Random::of(arguments.seed, campaign.name, case);
            let tried = catch_unwind(AssertUnwindSafe(|| trial(&mut random)));
            let failure = match tried {
                Ok(Ok(())) => continue,
                Ok(Err(failure)) => failure,
                Err(panic) => format!("panicked: {}", message_of(&*panic)),
            };
            failures
                .lock()
                .expect("no panic holds it")
                .push((case, failure));
        }
    };
    thread::scope(|scope| {
        for _ in 0..thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(work);
        }
    });
    let mut failures = failures.into_inner().expect("no panic holds it");
    failures.sort();
    let tried = last - first;
    let held = tried - failures.len() as u64;
    println!(
        "{:<14}{tried:>7} tried {held:>7} held   {:.0} s",
        campaign.name,
        started.elapsed().as_secs_f64()
    );
    for (case, failure) in failures.iter().take(TOLD) {
        println!("    case {case}: {failure}");
    }
    if failures.len() > TOLD {
        println!("    and {} more", failures.len() - TOLD);
    }
    failures.is_empty()
}

fn message_of(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied())
        .unwrap_or("without a message")
}

/// Random numbers: SplitMix64.
pub struct Random {
    state: u64,
    /// The number of the case.
    pub case: u64,
}

impl Random {
    fn of(seed: u64, campaign: &str, case: u64) -> Self {
        let state = campaign.bytes().fold(seed, |state, byte| {
            state.wrapping_mul(0x100_0000_01b3) ^ u64::from(byte)
        });
        let mut random = Self {
            state: state.wrapping_add(case.wrapping_mul(0xd134_2543_de82_ef95)),
            case,
        };
        random.next();
        random
    }

    pub fn next(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number below `bound`.
    pub fn below(&mut self, bound: usize) -> usize {
        (self.next() % bound.max(1) as u64) as usize
    }

    /// One of some things.
    pub fn one_of<'a, T>(&mut self, things: &'a [T]) -> &'a T {
        &things[self.below(things.len())]
    }

    /// A number from 0 to 1.
    pub fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A number between two, evenly distributed.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// A number between two positive ones, whose logarithm is evenly distributed.
    pub fn about(&mut self, low: f64, high: f64) -> f64 {
        exp(self.between(ln(low), ln(high)))
    }
}
