//! Columns of numbers as files hold them.

/// How numbers are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Storage {
    F32,
    F64,
    I32,
    I64,
}

/// Numbers of one of the stored types, row by row.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Array {
    F32(Vec<f32>),
    F64(Vec<f64>),
    I32(Vec<i32>),
    I64(Vec<i64>),
}

/// The same expression for whatever type an array has.
macro_rules! each {
    ($array:expr, $values:ident => $body:expr) => {
        match $array {
            Array::F32($values) => $body,
            Array::F64($values) => $body,
            Array::I32($values) => $body,
            Array::I64($values) => $body,
        }
    };
}
pub(crate) use each;

impl Array {
    pub(crate) fn len(&self) -> usize {
        each!(self, values => values.len())
    }
    pub(crate) fn storage(&self) -> Storage {
        match self {
            Array::F32(_) => Storage::F32,
            Array::F64(_) => Storage::F64,
            Array::I32(_) => Storage::I32,
            Array::I64(_) => Storage::I64,
        }
    }
    /// A number as text: the fewest digits that give it back.
    pub(crate) fn text(&self, place: usize) -> String {
        each!(self, values => format!("{:?}", values[place]))
    }
}
