//! A ring of bytes that takes messages whole and gives bytes back in any portion.

use crate::wire::copy;

/// A ring of `N` bytes.
#[derive(Clone, Debug)]
pub(crate) struct Ring<const N: usize> {
    bytes: [u8; N],
    start: usize,
    length: usize,
}

impl<const N: usize> Ring<N> {
    pub const fn new() -> Self {
        Self {
            bytes: [0; N],
            start: 0,
            length: 0,
        }
    }

    #[inline]
    pub fn len(&self) -> usize {
        self.length
    }

    #[inline]
    pub fn free(&self) -> usize {
        N.saturating_sub(self.length)
    }

    /// Takes a message, whole or not at all.
    #[inline]
    pub fn push(&mut self, message: &[u8]) -> bool {
        if message.len() > self.free() {
            return false;
        }
        let end = wrap::<N>(self.start + self.length);
        let straight = message.len().min(N.saturating_sub(end));
        let (first, second) = message.split_at_checked(straight).unwrap_or((message, &[]));
        copy(self.bytes.get_mut(end..).unwrap_or_default(), first);
        copy(&mut self.bytes, second);
        self.length += message.len();
        true
    }

    /// Moves the oldest bytes out; how many.
    pub fn drain(&mut self, to: &mut [u8]) -> usize {
        let count = self.length.min(to.len());
        let head = self.bytes.get(self.start..).unwrap_or_default();
        let straight = count.min(head.len());
        let (first, second) = to.split_at_mut_checked(straight).unwrap_or_default();
        copy(first, head);
        copy(
            second.get_mut(..count - straight).unwrap_or_default(),
            &self.bytes,
        );
        self.start = wrap::<N>(self.start + count);
        self.length -= count;
        count
    }
}

#[inline]
fn wrap<const N: usize>(index: usize) -> usize {
    if index >= N { index - N } else { index }
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
            let mut ring = Ring::<37>::new();
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
