//! Properties of a recording: the outcome of the run, for queries in a catalog.

use std::sync::Arc;

use rerun::external::arrow::array::{ArrayRef, Float64Array, Int64Array, StringArray};
use rerun::{ComponentDescriptor, EntityPath, SerializedComponentBatch};

use crate::run::outcome::{COLUMNS, Cell, Outcome};

/// The name of the property for outcomes. In a catalog, its members are `property:outcome:rise_time` and so on.
const OUTCOME: &str = "outcome";

/// The entity of the outcome.
pub(super) fn entity() -> EntityPath {
    EntityPath::properties().join(&EntityPath::from(OUTCOME))
}

/// An outcome as a component for each column of [`COLUMNS`] that has a value, in their order.
pub(super) fn from_outcome(outcome: &Outcome) -> Vec<SerializedComponentBatch> {
    let values = COLUMNS.iter().filter_map(|column| {
        let array = array(column.value_of(outcome)?);
        let descriptor = ComponentDescriptor::partial(column.name);
        Some(SerializedComponentBatch::new(array, descriptor))
    });
    values.collect()
}

fn array(cell: Cell) -> ArrayRef {
    match cell {
        Cell::Text(text) => Arc::new(StringArray::from(vec![text])),
        Cell::Integer(number) => Arc::new(Int64Array::from(vec![number])),
        Cell::Number(number) => Arc::new(Float64Array::from(vec![number])),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::outcome;
    use crate::run::scenario::Preset;
    use crate::run::simulation::EventKind;

    #[test]
    fn columns_with_values_become_components() {
        let scenario = Preset::find("paper").unwrap().scenario().unwrap();
        let outcome = outcome(&scenario, || true).unwrap();
        let batches = from_outcome(&outcome);
        let names: Vec<_> = batches
            .iter()
            .map(|batch| batch.descriptor.component.to_string())
            .collect();
        let expected: Vec<_> = COLUMNS
            .iter()
            .filter(|column| column.value_of(&outcome).is_some())
            .map(|column| column.name)
            .collect();
        assert_eq!(names, expected);
        assert!(names.contains(&"rise_time".to_owned()));
        assert!(!names.contains(&"hops".to_owned()), "the peg is fixed");
        let rise = batches[names.iter().position(|name| name == "rise_time").unwrap()].clone();
        let rise: Float64Array = rise.array.to_data().into();
        assert_eq!(Some(rise.value(0)), outcome.tally.first(EventKind::Risen));
    }
}
