//! The fields that have been found in messages, and the tree by which they are found again.

use super::value::Value;
use std::borrow::Cow;
use std::collections::HashMap;
use std::fmt::{self, Write as _};

/// A channel has no more fields than this; others are left out.
pub const MAX_FIELDS: usize = 4096;
/// So many values of a channel's messages, one by one, are left out; then its messages are not decoded any more if they have
/// such.
const MOST_LEFT_OUT: u64 = 1 << 22;
/// The paths of all fields may cost so much together: a byte costs one, and a part of a path what follows.
const LARGEST_PATHS: usize = 1 << 19;
/// Each part of a path can be a node of its own.
const COST_OF_NODE: usize = 16;

/// A part of a path.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) enum Segment<'a> {
    /// The name of a member, or a text that is the key of a map.
    Name(Cow<'a, str>),
    /// The position of an element, or a number that is the key of a map.
    Index(i128),
}

impl Segment<'_> {
    fn to_owned(&self) -> Segment<'static> {
        match self {
            Self::Name(name) => Segment::Name(Cow::Owned(name.clone().into_owned())),
            Self::Index(index) => Segment::Index(*index),
        }
    }
}

/// Where something stands in a message; nothing stands for the message itself.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place<'a> {
    pub(super) parent: Option<&'a Place<'a>>,
    pub(super) segment: &'a Segment<'a>,
}

impl Place<'_> {
    /// How many parts its path has.
    fn depth(&self) -> usize {
        1 + self.parent.map_or(0, Self::depth)
    }
}

impl fmt::Display for Place<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(parent) = self.parent {
            write!(f, "{parent}.")?;
        }
        match self.segment {
            Segment::Name(name) => write_name(name, f),
            Segment::Index(index) => index.fmt(f),
        }
    }
}

/// Writes a name so that no other path reads the same: a backslash stands before dots, quotes and backslashes, and before
/// names that look like the position of an element; the empty name is `""`.
fn write_name(name: &str, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    if name.is_empty() {
        return f.write_str("\"\"");
    }
    if name.parse::<i128>().is_ok() {
        f.write_char('\\')?;
    }
    for character in name.chars() {
        if matches!(character, '.' | '"' | '\\') {
            f.write_char('\\')?;
        }
        f.write_char(character)?;
    }
    Ok(())
}

/// What is known of a place in the messages: which field it is, and what has been in it.
#[derive(Debug, Default)]
pub(super) struct Node {
    /// Which field it is.
    slot: Option<usize>,
    members: Vec<(Segment<'static>, Node)>,
    positions: HashMap<Segment<'static>, usize>,
    /// The last message that had it, counted from one.
    met_in: u64,
    /// How many elements that message has had in it, for lists that come in pieces.
    pub(super) elements: usize,
    /// Whether it stays known although it has led to no field yet.
    is_kept: bool,
    /// What it is where a message has what it stands in, but not it.
    pub(super) implicit: Option<Zero>,
    /// Whether its implicit members have been made.
    pub(super) is_unfolded: bool,
}

impl Node {
    /// Visits a member. It stays known if anything is found in it.
    ///
    /// Members mostly come in the same order: `next` is where this one is then, and is moved on.
    #[inline]
    pub(super) fn member<T>(
        &mut self,
        segment: &Segment<'_>,
        next: &mut usize,
        visit: impl FnOnce(&mut Self) -> T,
    ) -> T {
        if let Some(position) = self.position(segment, *next) {
            *next = position + 1;
            return visit(&mut self.members[position].1);
        }
        let mut member = Self::default();
        let result = visit(&mut member);
        if !member.is_empty() {
            self.positions
                .insert(segment.to_owned(), self.members.len());
            self.members.push((segment.to_owned(), member));
            *next = self.members.len();
        }
        result
    }

    #[inline]
    fn position(&self, segment: &Segment<'_>, next: usize) -> Option<usize> {
        match self.members.get(next) {
            Some((known, _)) if known == segment => Some(next),
            _ => self.positions.get(segment).copied(),
        }
    }

    fn is_empty(&self) -> bool {
        self.slot.is_none() && self.members.is_empty() && !self.is_kept
    }
}

/// What stands for the fields of proto3 that are not in a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Zero {
    Real,
    Integer,
    Bool,
    Text,
    Bytes,
}

impl Zero {
    fn value(self) -> Value {
        match self {
            Self::Real => Value::Real(0.0),
            Self::Integer => Value::Integer(0),
            Self::Bool => Value::Bool(false),
            Self::Text => Value::Text("".into()),
            Self::Bytes => Value::Bytes([].into()),
        }
    }
}

/// All fields that have been found.
#[derive(Debug, Default)]
pub(super) struct Tree {
    paths: Vec<String>,
    /// What the paths cost.
    cost: usize,
    is_full: bool,
    /// How many messages there have been.
    messages: u64,
    /// Values of this message that are left out.
    missed: u64,
    left_out: u64,
    /// How many values have been met that were left out.
    met_in_vain: u64,
    /// Whether this message says something twice.
    repeats: bool,
    /// Parts of this message that its schema doesn't know, or that its values don't hold.
    unknown: Vec<u8>,
}

impl Tree {
    pub(super) fn paths(&self) -> &[String] {
        &self.paths
    }

    pub(super) fn left_out(&self) -> u64 {
        self.left_out.max(self.missed)
    }

    /// What the last message says beyond its fields: parts of it, or all of it; nothing if they say it all.
    pub(super) fn unsaid<'a>(&'a self, message: &'a [u8]) -> Option<&'a [u8]> {
        if self.missed > 0 || self.repeats {
            return Some(message);
        }
        (!self.unknown.is_empty()).then_some(&self.unknown)
    }

    /// Keeps a part of the last message that its fields don't hold.
    pub(super) fn keep_unknown(&mut self, part: &[u8]) {
        self.unknown.extend_from_slice(part);
    }

    /// The field at a place, a new one if there is none; nothing if there is no room for it.
    fn slot(&mut self, place: Option<&Place<'_>>) -> Option<usize> {
        // The tree leads to the fields that are known, so there is no need to look.
        if self.is_full {
            return None;
        }
        let path = place.map_or_else(String::new, Place::to_string);
        let has_room = self.has_room(path.len(), place.map_or(0, Place::depth));
        if self.paths.len() == MAX_FIELDS || !has_room {
            self.is_full = true;
            return None;
        }
        let slot = self.paths.len();
        self.paths.push(path);
        Some(slot)
    }

    fn has_room(&mut self, bytes: usize, nodes: usize) -> bool {
        self.cost += bytes + COST_OF_NODE * nodes;
        self.cost <= LARGEST_PATHS
    }
}

/// A message that is being decoded.
#[derive(Debug)]
pub(super) struct Filling<'a> {
    tree: &'a mut Tree,
    values: &'a mut Vec<Value>,
}

impl<'a> Filling<'a> {
    /// Begins a message.
    pub(super) fn new(tree: &'a mut Tree, values: &'a mut Vec<Value>) -> Self {
        tree.left_out = tree.left_out();
        tree.missed = 0;
        tree.repeats = false;
        tree.unknown.clear();
        tree.messages += 1;
        values.clear();
        values.resize(tree.paths.len(), Value::Absent);
        Self { tree, values }
    }

    /// Notes that the message says something twice.
    pub(super) fn repeat(&mut self) {
        self.tree.repeats = true;
    }

    /// Whether no more fields can be found.
    pub(super) fn is_full(&self) -> bool {
        self.tree.is_full
    }

    /// Notes that the message has what is at a node; false if it has been there already.
    #[inline]
    pub(super) fn meet(&mut self, node: &mut Node) -> bool {
        let is_first = node.met_in != self.tree.messages;
        if is_first {
            node.met_in = self.tree.messages;
            node.elements = 0;
        }
        is_first
    }

    /// Takes back what the message has had at a node and within it.
    #[inline]
    pub(super) fn forget(&mut self, node: &mut Node) {
        if node.met_in == self.tree.messages {
            self.tree.repeats = true;
            self.clear(node);
        }
    }

    fn clear(&mut self, node: &mut Node) {
        node.met_in = 0;
        if let Some(slot) = node.slot {
            self.values[slot] = Value::Absent;
        }
        for (_, member) in &mut node.members {
            self.forget(member);
        }
    }

    /// Makes the node a field if there is room for it.
    #[inline]
    pub(super) fn reserve(&mut self, node: &mut Node, place: Option<&Place<'_>>) -> Option<usize> {
        if node.slot.is_none() {
            node.slot = self.tree.slot(place);
            self.values.resize(self.tree.paths.len(), Value::Absent);
        }
        node.slot
    }

    /// Gives the field at a node its value, or says that too many have been left out.
    #[inline]
    pub(super) fn put(
        &mut self,
        node: &mut Node,
        place: Option<&Place<'_>>,
        value: Value,
    ) -> Result<(), String> {
        match self.reserve(node, place) {
            Some(slot) => {
                node.met_in = self.tree.messages;
                self.values[slot] = value;
            }
            // The value was counted with the message in which it stands.
            None if node.implicit.is_some() => {}
            None => {
                self.miss(1);
                self.tree.met_in_vain += 1;
                if self.tree.met_in_vain > MOST_LEFT_OUT {
                    return Err(format!("its channel has more than {MAX_FIELDS} fields"));
                }
            }
        }
        Ok(())
    }

    /// Sets the implicit members to zero, and says how many there are.
    pub(super) fn zero_members(&mut self, node: &Node) -> usize {
        let members = node.members.iter();
        let implicit = members.filter_map(|(_, member)| member.slot.zip(member.implicit));
        implicit
            .map(|(slot, zero)| self.values[slot] = zero.value())
            .count()
    }

    /// Counts values that are left out.
    pub(super) fn miss(&mut self, values: usize) {
        self.tree.missed += values as u64;
    }

    /// Keeps a part of the message that its schema doesn't know.
    pub(super) fn keep_unknown(&mut self, part: &[u8]) {
        self.tree.keep_unknown(part);
    }

    /// Keeps a list known, if there is room, before it is known whether there is anything in it: its
    /// elements are counted there.
    pub(super) fn keep(&mut self, list: &mut Node, place: &Place<'_>) {
        if list.is_kept || self.tree.is_full {
            return;
        }
        let length = match place.segment {
            Segment::Name(name) => name.len(),
            Segment::Index(_) => 0,
        };
        list.is_kept = self.tree.has_room(length, 1);
        self.tree.is_full = !list.is_kept;
    }
}
