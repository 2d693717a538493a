//! Memory whose amount an input decides: running out of it is an error, not the end of the process.

use crate::error::Error;

/// Returns an empty vector with room for `count` elements; `what` names them in the error.
///
/// # Errors
/// [`Error::Memory`]: there is not enough memory.
pub fn with_room<T>(what: &'static str, count: usize) -> Result<Vec<T>, Error> {
    let mut elements = Vec::new();
    elements.try_reserve_exact(count).map_err(|_| missing::<T>(what, count))?;
    Ok(elements)
}

/// Returns `count` copies of a value.
///
/// # Errors
/// Those of [`with_room`].
pub fn filled<T: Clone>(what: &'static str, value: T, count: usize) -> Result<Vec<T>, Error> {
    let mut elements = with_room(what, count)?;
    elements.resize(count, value);
    Ok(elements)
}

/// Returns all elements of an iterator that knows their number.
///
/// # Errors
/// Those of [`with_room`].
pub fn collected<T>(what: &'static str, source: impl ExactSizeIterator<Item = T>) -> Result<Vec<T>, Error> {
    let mut elements = with_room(what, source.len())?;
    elements.extend(source);
    Ok(elements)
}

/// Adds an element.
///
/// # Errors
/// Those of [`with_room`].
#[inline]
pub fn push<T>(what: &'static str, elements: &mut Vec<T>, element: T) -> Result<(), Error> {
    if elements.len() == elements.capacity() {
        elements.try_reserve(1).map_err(|_| missing::<T>(what, 2 * elements.len()))?;
    }
    elements.push(element);
    Ok(())
}

/// Lengthens a vector with copies of a value to at least `count` elements.
///
/// # Errors
/// Those of [`with_room`].
pub fn lengthen<T: Clone>(what: &'static str, elements: &mut Vec<T>, count: usize, value: T) -> Result<(), Error> {
    if count > elements.len() {
        elements.try_reserve_exact(count - elements.len()).map_err(|_| missing::<T>(what, count))?;
        elements.resize(count, value);
    }
    Ok(())
}

/// Returns the error for `count` elements for which there is no memory.
pub fn missing<T>(what: &'static str, count: usize) -> Error {
    Error::Memory { what, bytes: count.saturating_mul(size_of::<T>()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_says_what_was_needed() {
        let error = filled("cells", 0_u16, usize::MAX / 8).unwrap_err();
        assert_eq!(error.to_string(), format!("not enough memory for cells, which need {} bytes", usize::MAX / 8 * 2));
        assert_eq!(with_room::<u64>("rows", usize::MAX).unwrap_err(), Error::Memory { what: "rows", bytes: usize::MAX });
    }

    #[test]
    fn elements_arrive_in_order() {
        assert_eq!(filled("", 7, 3), Ok(vec![7; 3]));
        assert_eq!(collected("", 0..4), Ok(vec![0, 1, 2, 3]));
        let mut elements = Vec::new();
        (0..100).for_each(|element| push("", &mut elements, element).expect("enough memory"));
        assert!(elements.into_iter().eq(0..100));
    }
}
