//! Cells of Arrow columns of any numeric or text type.

use super::error::CellError;
use crate::run::scenario::Value;
use arrow_array::cast::AsArray as _;
use arrow_array::types::Float64Type;
use arrow_array::{Array, ArrayRef};
use arrow_cast::{CastOptions, cast_with_options};
use arrow_schema::{ArrowError, DataType};

/// A number or text per row; `None` for empty cells.
pub type Cells = Vec<Option<Value>>;

/// The cells of a column of numbers or words, which may be a dictionary's.
///
/// # Errors
/// The type of the column's values, if they are neither.
pub fn cells(column: &dyn Array) -> Result<Cells, CellError> {
    match values_of(column.data_type()) {
        DataType::Null => Ok(vec![None; column.len()]),
        kind if kind.is_string() => Ok(words(column)?),
        // Decimals are converted through their text to get the nearest double.
        kind if kind.is_decimal() => Ok(numbers(&cast(column, &DataType::Utf8)?)?),
        // A dictionary is cast to its values, like any other column.
        kind if kind.is_numeric() => Ok(numbers(column)?),
        kind => Err(CellError::Type(kind.clone())),
    }
}

/// The type of a column's values, which may be a dictionary's.
pub(super) fn values_of(kind: &DataType) -> &DataType {
    match kind {
        DataType::Dictionary(_, values) => values,
        kind => kind,
    }
}

/// The column as another type. A value that can't be converted is an error, not an empty cell.
fn cast(column: &dyn Array, kind: &DataType) -> Result<ArrayRef, ArrowError> {
    let options = CastOptions {
        safe: false,
        ..CastOptions::default()
    };
    cast_with_options(column, kind, &options)
}

fn words(column: &dyn Array) -> Result<Cells, ArrowError> {
    let words = cast(column, &DataType::Utf8)?;
    Ok(words
        .as_string::<i32>()
        .iter()
        .map(|word| Some(Value::Text(word?.to_owned())))
        .collect())
}

fn numbers(column: &dyn Array) -> Result<Cells, ArrowError> {
    Ok(cast(column, &DataType::Float64)?
        .as_primitive::<Float64Type>()
        .iter()
        .map(|number| number.map(Value::Number))
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use arrow_array::types::Int8Type;
    use arrow_array::*;
    use std::sync::Arc;

    #[allow(clippy::unnecessary_wraps)]
    fn number(number: f64) -> Option<Value> {
        Some(Value::Number(number))
    }

    #[allow(clippy::unnecessary_wraps)]
    fn word(word: &str) -> Option<Value> {
        Some(Value::Text(word.to_owned()))
    }

    #[test]
    fn reads_numbers_of_every_type() {
        let two = [number(2.0), None];
        let columns: [ArrayRef; 10] = [
            Arc::new(Float64Array::from(vec![Some(2.0), None])),
            Arc::new(Float32Array::from(vec![Some(2.0), None])),
            Arc::new(Int64Array::from(vec![Some(2), None])),
            Arc::new(Int32Array::from(vec![Some(2), None])),
            Arc::new(Int16Array::from(vec![Some(2), None])),
            Arc::new(Int8Array::from(vec![Some(2), None])),
            Arc::new(UInt64Array::from(vec![Some(2), None])),
            Arc::new(UInt32Array::from(vec![Some(2), None])),
            Arc::new(UInt16Array::from(vec![Some(2), None])),
            Arc::new(UInt8Array::from(vec![Some(2), None])),
        ];
        for column in columns {
            assert_eq!(cells(&column).unwrap(), two, "{}", column.data_type());
        }
        assert_eq!(cells(&NullArray::new(2)).unwrap(), [None, None]);
        let message = cells(&BooleanArray::from(vec![true]))
            .unwrap_err()
            .to_string();
        assert_eq!(
            message,
            "values of type Boolean are neither numbers nor words"
        );
        let list = vec![Some(vec![Some(1.0)])];
        let list = ListArray::from_iter_primitive::<Float64Type, _, _>(list);
        let message = cells(&list).unwrap_err().to_string();
        assert!(
            message.ends_with("are neither numbers nor words"),
            "{message}"
        );
    }

    #[test]
    fn decimals_become_nearest_doubles() {
        // For some of these, a quotient of rounded numbers would be e.g. 0.30000000000000004.
        let digits = vec![Some(3), None, Some(-1), Some(12345678901234567890123)];
        let column = Decimal128Array::from(digits);
        let column = column.with_precision_and_scale(38, 1).unwrap();
        let expected = [
            number(0.3),
            None,
            number(-0.1),
            number(1234567890123456789012.3),
        ];
        assert_eq!(cells(&column).unwrap(), expected);
        let column = Decimal64Array::from(vec![123456789]);
        let column = column.with_precision_and_scale(18, 15).unwrap();
        assert_eq!(cells(&column).unwrap(), [number(1.23456789e-7)]);
        let column = Decimal32Array::from(vec![12]);
        let column = column.with_precision_and_scale(9, -2).unwrap();
        assert_eq!(cells(&column).unwrap(), [number(1200.0)]);
        let column = Decimal128Array::from(vec![3, 12]);
        let column = column.with_precision_and_scale(9, 1).unwrap();
        let places = Int8Array::from(vec![Some(1), None, Some(0)]);
        let column = DictionaryArray::new(places, Arc::new(column));
        let expected = [number(1.2), None, number(0.3)];
        assert_eq!(cells(&column).unwrap(), expected);
    }

    #[test]
    fn reads_words_of_every_type() {
        let words = [Some("a"), None, Some("b"), Some("a")];
        let columns: [ArrayRef; 4] = [
            Arc::new(StringArray::from(words.to_vec())),
            Arc::new(LargeStringArray::from(words.to_vec())),
            Arc::new(StringViewArray::from(words.to_vec())),
            Arc::new(words.into_iter().collect::<DictionaryArray<Int8Type>>()),
        ];
        let expected = [word("a"), None, word("b"), word("a")];
        for column in columns {
            assert_eq!(cells(&column).unwrap(), expected, "{}", column.data_type());
        }
        let nothing: DictionaryArray<Int8Type> = [None, None].into_iter().collect();
        assert_eq!(cells(&nothing).unwrap(), [None, None]);
    }
}
