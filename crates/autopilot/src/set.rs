//! Sets of the values of a small enumeration, a bit each.

/// Declares a set: its name, its bits, and the enumeration, whose values count from 0 in the order of
/// its `ALL`.
macro_rules! bit_set {
    ($(#[$meta:meta])* $Set:ident($Bits:ident) of $Item:ident) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub struct $Set(pub $Bits);

        impl $Set {
            /// Only this one.
            pub const fn of(item: $Item) -> Self {
                Self(1 << item as $Bits)
            }

            /// Whether it is in it.
            pub const fn contains(self, item: $Item) -> bool {
                self.0 >> (item as $Bits) & 1 == 1
            }

            /// With it, if `is` says so.
            #[must_use]
            pub const fn with(self, item: $Item, is: bool) -> Self {
                Self(self.0 | (is as $Bits) << item as $Bits)
            }

            /// What is in both.
            #[must_use]
            pub const fn and(self, other: Self) -> Self {
                Self(self.0 & other.0)
            }

            /// What is in either.
            #[must_use]
            pub const fn or(self, other: Self) -> Self {
                Self(self.0 | other.0)
            }

            /// What is in this and not in the other.
            #[must_use]
            pub const fn without(self, other: Self) -> Self {
                Self(self.0 & !other.0)
            }

            /// What is in one of them and not in the other.
            #[must_use]
            pub const fn xor(self, other: Self) -> Self {
                Self(self.0 ^ other.0)
            }

            /// Whether nothing is in it.
            pub const fn is_empty(self) -> bool {
                self.0 == 0
            }

            /// What is in it, in the order of the enumeration.
            pub fn iter(self) -> impl Iterator<Item = $Item> {
                let mut left = self.0;
                core::iter::from_fn(move || {
                    let item = $Item::ALL.get(left.trailing_zeros() as usize).copied()?;
                    left &= left - 1;
                    Some(item)
                })
            }
        }
    };
}

pub(crate) use bit_set;
