//! Arrays of Python as numbers in a row.

use numpy::{PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::prelude::*;
use scanseg_formats::Geometry;

use crate::value_error;

/// The numbers of an array, the last axis first.
pub struct Numbers {
    /// The length of each axis.
    pub shape: Vec<usize>,
    /// The numbers; NaN where the array is masked.
    pub values: Vec<f64>,
    /// The type of the array's elements, if they are whole numbers.
    pub whole: Option<String>,
}

impl Numbers {
    /// Returns the numbers of an array of any order, masked or not, or of a list. `what` is its name in
    /// messages.
    pub fn of(what: &str, any: &Bound<'_, PyAny>) -> PyResult<Numbers> {
        let py = any.py();
        let masked = py.import("numpy.ma")?.call_method1("asanyarray", (any,))?;
        let dtype = masked.getattr("dtype")?;
        let (kind, name): (String, String) = (dtype.getattr("kind")?.extract()?, dtype.str()?.extract()?);
        if !["f", "i", "u"].contains(&kind.as_str()) {
            return Err(value_error(format!("{what}: elements of type {name}, must be real or whole numbers")));
        }
        let filled = masked.call_method1("astype", ("float64",))?.call_method1("filled", (f64::NAN,))?;
        let filled = py.import("numpy")?.call_method1("ascontiguousarray", (filled,))?;
        let array: PyReadonlyArrayDyn<'_, f64> = filled.extract()?;
        let (shape, values) = (array.shape().to_vec(), array.as_slice().map_err(value_error)?.to_vec());
        Ok(Numbers { shape, values, whole: (kind != "f").then_some(name) })
    }

    /// Returns the numbers as distances, 0 for the counts that mean no return in a geometry.
    pub fn distances(&self, geometry: &Geometry) -> impl Iterator<Item = f64> {
        let no_return = |x: f64| self.whole.is_some() && geometry.no_return.iter().any(|&n| f64::from(n) == x);
        self.values.iter().map(move |&x| if no_return(x) { 0.0 } else { x })
    }

    /// Returns the lengths of the axes, of which there must be `D`. `axes` says what they are.
    pub fn shape<const D: usize>(&self, what: &str, axes: &str) -> PyResult<[usize; D]> {
        let shape = self.shape.as_slice().try_into();
        shape.map_err(|_| value_error(format!("{what}: shape {:?}, must be {axes}", self.shape)))
    }
}

/// Returns the numbers of a list.
pub fn list(what: &str, any: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    let numbers = Numbers::of(what, any)?;
    let [_] = numbers.shape(what, "one axis")?;
    Ok(numbers.values)
}

/// Returns vectors, row by row, with the rows and columns of the image that they are of.
pub fn vectors(what: &str, any: &Bound<'_, PyAny>) -> PyResult<(usize, usize, Vec<[f32; 3]>)> {
    let numbers = Numbers::of(what, any)?;
    let axes = "rows x columns x 3";
    let [rows, columns, 3] = numbers.shape(what, axes)? else {
        return Err(value_error(format!("{what}: shape {:?}, must be {axes}", numbers.shape)));
    };
    let (vectors, _) = numbers.values.as_chunks();
    Ok((rows, columns, vectors.iter().map(|v: &[f64; 3]| v.map(|x| x as f32)).collect()))
}

/// Returns the ids of an image of labels, row by row, with its rows and columns.
pub fn ids(what: &str, any: &Bound<'_, PyAny>) -> PyResult<(usize, usize, Vec<u16>)> {
    let numbers = Numbers::of(what, any)?;
    let [rows, columns] = numbers.shape(what, "rows x columns")?;
    // masked: in no region
    let id = |&x: &f64| {
        if x.is_nan() { Some(0) } else { (x.fract() == 0.0 && (0.0..=65535.0).contains(&x)).then_some(x as u16) }
    };
    let ids: Option<Vec<u16>> = numbers.values.iter().map(id).collect();
    let wrong = || numbers.values.iter().find(|x| id(x).is_none()).copied().unwrap_or_default();
    let ids = ids.ok_or_else(|| value_error(format!("{what}: {}, must be a whole number from 0 to 65535", wrong())))?;
    Ok((rows, columns, ids))
}
