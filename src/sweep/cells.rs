//! Cells of Arrow's columns: numbers and words, whichever of the many types a library writes them in.

use crate::run::scenario::Value;
use arrow_array::cast::AsArray as _;
use arrow_array::types::{
    Decimal32Type, Decimal64Type, Decimal128Type, Decimal256Type, DecimalType, Float16Type,
    Float32Type, Float64Type, Int8Type, Int16Type, Int32Type, Int64Type, UInt8Type, UInt16Type,
    UInt32Type, UInt64Type,
};
use arrow_array::{Array, ArrowPrimitiveType};
use arrow_schema::DataType;

/// A number or a word for each row; none where a cell is empty.
pub type Cells = Vec<Option<Value>>;

/// The cells of a column of numbers or words, which may be a dictionary's.
///
/// # Errors
/// The type of the column's values, if they are neither.
pub fn cells(column: &dyn Array) -> Result<Cells, String> {
    if let Some(dictionary) = column.as_any_dictionary_opt() {
        let values = cells(dictionary.values().as_ref())?;
        if values.is_empty() {
            return Ok(vec![None; column.len()]);
        }
        let places = dictionary.normalized_keys().into_iter().enumerate();
        let cell = |(row, place): (usize, usize)| {
            let is_there = dictionary.is_valid(row);
            is_there.then(|| values[place].clone()).flatten()
        };
        return Ok(places.map(cell).collect());
    }
    Ok(match column.data_type() {
        DataType::Null => vec![None; column.len()],
        DataType::Utf8 => words(column.as_string::<i32>().iter()),
        DataType::LargeUtf8 => words(column.as_string::<i64>().iter()),
        DataType::Utf8View => words(column.as_string_view().iter()),
        DataType::Float64 => numbers::<Float64Type>(column, |number| number),
        DataType::Float32 => numbers::<Float32Type>(column, f64::from),
        DataType::Float16 => numbers::<Float16Type>(column, f64::from),
        DataType::Int64 => numbers::<Int64Type>(column, |number| number as f64),
        DataType::Int32 => numbers::<Int32Type>(column, f64::from),
        DataType::Int16 => numbers::<Int16Type>(column, f64::from),
        DataType::Int8 => numbers::<Int8Type>(column, f64::from),
        DataType::UInt64 => numbers::<UInt64Type>(column, |number| number as f64),
        DataType::UInt32 => numbers::<UInt32Type>(column, f64::from),
        DataType::UInt16 => numbers::<UInt16Type>(column, f64::from),
        DataType::UInt8 => numbers::<UInt8Type>(column, f64::from),
        DataType::Decimal32(..) => decimals::<Decimal32Type>(column)?,
        DataType::Decimal64(..) => decimals::<Decimal64Type>(column)?,
        DataType::Decimal128(..) => decimals::<Decimal128Type>(column)?,
        DataType::Decimal256(..) => decimals::<Decimal256Type>(column)?,
        other => {
            return Err(format!(
                "values of type {other} are neither numbers nor words"
            ));
        }
    })
}

fn words<'a>(words: impl Iterator<Item = Option<&'a str>>) -> Cells {
    let cell = |word: Option<&str>| word.map(|word| Value::Text(word.to_owned()));
    words.map(cell).collect()
}

fn numbers<T: ArrowPrimitiveType>(column: &dyn Array, number: impl Fn(T::Native) -> f64) -> Cells {
    let cell = |native: Option<T::Native>| native.map(|native| Value::Number(number(native)));
    column.as_primitive::<T>().iter().map(cell).collect()
}

/// Decimals as the doubles next to them, which is what their texts are read as.
fn decimals<T: DecimalType>(column: &dyn Array) -> Result<Cells, String> {
    let column = column.as_primitive::<T>();
    let cell = |row| {
        let text = column.is_valid(row).then(|| column.value_as_string(row));
        let number = |text: String| {
            let number = text.parse().map(Value::Number);
            number.map_err(|_| format!("{text} is no number"))
        };
        text.map(number).transpose()
    };
    (0..column.len()).map(cell).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
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
    fn numbers_are_read_from_every_type_of_them() {
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
        let message = cells(&BooleanArray::from(vec![true])).unwrap_err();
        assert_eq!(
            message,
            "values of type Boolean are neither numbers nor words"
        );
        let list = vec![Some(vec![Some(1.0)])];
        let list = ListArray::from_iter_primitive::<Float64Type, _, _>(list);
        let message = cells(&list).unwrap_err();
        assert!(
            message.ends_with("are neither numbers nor words"),
            "{message}"
        );
    }

    #[test]
    fn decimals_are_the_doubles_next_to_them() {
        // A quotient of rounded numbers would be 0.30000000000000004 or the like for some of these.
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
    }

    #[test]
    fn words_are_read_from_every_type_of_them() {
        let given = [Some("a"), None, Some("b"), Some("a")];
        let columns: [ArrayRef; 4] = [
            Arc::new(StringArray::from(given.to_vec())),
            Arc::new(LargeStringArray::from(given.to_vec())),
            Arc::new(StringViewArray::from(given.to_vec())),
            Arc::new(given.into_iter().collect::<DictionaryArray<Int8Type>>()),
        ];
        let expected = [word("a"), None, word("b"), word("a")];
        for column in columns {
            assert_eq!(cells(&column).unwrap(), expected, "{}", column.data_type());
        }
        let nothing: DictionaryArray<Int8Type> = [None, None].into_iter().collect();
        assert_eq!(cells(&nothing).unwrap(), [None, None]);
    }
}
