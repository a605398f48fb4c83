//! A ring of bytes that takes messages whole and gives bytes back in any portion.

use crate::wire::copy;

/// Bytes for a ring: an array, or a borrowed one where the ring itself must stay small.
pub trait Storage: AsRef<[u8]> + AsMut<[u8]> {}

impl<S: AsRef<[u8]> + AsMut<[u8]>> Storage for S {}

/// A ring of as many bytes as its storage has.
#[derive(Clone, Debug)]
pub(crate) struct Ring<S> {
    bytes: S,
    start: usize,
    length: usize,
}

impl<S: Storage> Ring<S> {
    pub fn new(bytes: S) -> Self {
        Self {
            bytes,
            start: 0,
            length: 0,
        }
    }

    #[inline]
    pub fn capacity(&self) -> usize {
        self.bytes.as_ref().len()
    }

    #[inline]
    pub fn len(&self) -> usize {
        self.length
    }

    #[inline]
    pub fn free(&self) -> usize {
        self.capacity().saturating_sub(self.length)
    }

    /// Takes a message, whole or not at all.
    #[inline]
    pub fn push(&mut self, message: &[u8]) -> bool {
        if message.len() > self.free() {
            return false;
        }
        let end = self.wrap(self.start + self.length);
        let straight = message.len().min(self.capacity().saturating_sub(end));
        let (first, second) = message.split_at_checked(straight).unwrap_or((message, &[]));
        let bytes = self.bytes.as_mut();
        copy(bytes.get_mut(end..).unwrap_or_default(), first);
        copy(bytes, second);
        self.length += message.len();
        true
    }

    /// Moves the oldest bytes out; how many.
    pub fn drain(&mut self, to: &mut [u8]) -> usize {
        let count = self.length.min(to.len());
        let bytes = self.bytes.as_ref();
        let head = bytes.get(self.start..).unwrap_or_default();
        let straight = count.min(head.len());
        let (first, second) = to.split_at_mut_checked(straight).unwrap_or_default();
        copy(first, head);
        copy(second.get_mut(..count - straight).unwrap_or_default(), bytes);
        self.start = self.wrap(self.start + count);
        self.length -= count;
        count
    }

    #[inline]
    fn wrap(&self, index: usize) -> usize {
        let capacity = self.capacity();
        if index >= capacity {
            index - capacity
        } else {
            index
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::VecDeque;
    use std::vec::Vec;

    proptest! {
        /// Against a queue that grows: the same bytes, and refused only what does not fit.
        #[test]
        fn gives_back_what_it_took(steps in prop::collection::vec((0usize..20, 0usize..20), 1..200)) {
            let mut ring = Ring::new([0; 37]);
            let mut model = VecDeque::new();
            let mut next = 0u8;
            for (push, drain) in steps {
                let message: Vec<u8> = (0..push).map(|_| { next = next.wrapping_add(1); next }).collect();
                let fits = model.len() + push <= 37;
                prop_assert_eq!(ring.push(&message), fits);
                if fits {
                    model.extend(message);
                }
                let mut out = [0; 20];
                let count = ring.drain(&mut out[..drain]);
                let expected: Vec<u8> = model.drain(..drain.min(model.len())).collect();
                prop_assert_eq!(&out[..count], &expected[..]);
                prop_assert_eq!(ring.len(), model.len());
            }
        }
    }
}
