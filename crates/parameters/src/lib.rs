//! Parameters: numbers that a user may set, declared one line each in the struct that owns them.
//!
//! [`parameters!`] turns declaration lines into a plain struct of `f32` fields with defaults and
//! a table of names, units, ranges and sentences. [`parameter_groups!`] puts several such structs
//! under one index, the table that files, ground stations and logs speak of. A write is checked
//! against the range that its line declares; nothing else changes a parameter.
//!
//! ```
//! use windhover_parameters::{Refusal, parameter_groups, parameters};
//!
//! parameters! {
//!     /// What the kettle does.
//!     pub struct Kettle {
//!         hot: "KETTLE_HOT", "K", 273.0..=373.0, 360.0, "Temperature at which it stops";
//!     }
//! }
//! parameter_groups! {
//!     /// Everything.
//!     pub struct Kitchen { kettle: Kettle }
//! }
//!
//! let mut kitchen = Kitchen::default();
//! let hot = Kitchen::find("KETTLE_HOT").unwrap();
//! assert_eq!(kitchen.set(hot, 350.0), Ok(()));
//! assert_eq!(kitchen.kettle.hot, 350.0);
//! assert_eq!(kitchen.set(hot, 500.0), Err(Refusal::OutOfRange { min: 273.0, max: 373.0 }));
//! ```
#![no_std]

mod decimal;

pub use decimal::{Decimal, Whole};

/// One parameter as its owner declares it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Declaration {
    /// Unique name of at most 16 characters, as MAVLink carries it.
    pub name: &'static str,
    /// Unit, in SI symbols; empty for a pure number.
    pub unit: &'static str,
    /// Smallest value that is accepted.
    pub min: f32,
    /// Largest value that is accepted.
    pub max: f32,
    /// Value when nobody has set one.
    pub default: f32,
    /// One sentence for a human; empty on a microcontroller.
    pub text: &'static str,
}

impl Declaration {
    /// Whether `value` may be set.
    pub fn check(&self, value: f32) -> Result<(), Refusal> {
        if value >= self.min && value <= self.max {
            Ok(())
        } else {
            Err(Refusal::OutOfRange {
                min: self.min,
                max: self.max,
            })
        }
    }
}

/// Why a parameter was not set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refusal {
    /// There is no parameter of that name or index.
    Unknown,
    /// The value is not a number, or lies outside the range given here.
    OutOfRange {
        /// Smallest value that is accepted.
        min: f32,
        /// Largest value that is accepted.
        max: f32,
    },
    /// With it, the parameters together describe nothing that works.
    Inconsistent,
}

impl core::fmt::Display for Refusal {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Unknown => f.write_str("there is no such parameter"),
            Self::OutOfRange { min, max } => write!(f, "the range is {min} to {max}"),
            Self::Inconsistent => f.write_str("it does not go with the other parameters"),
        }
    }
}

/// A struct of parameters with its declarations, in the order of its fields.
pub trait Group {
    /// What the struct is for, a line each, as its documentation says it.
    const DOCUMENTATION: &'static [&'static str];
    /// The declarations.
    const DECLARATIONS: &'static [Declaration];
    /// The value of the field with that index.
    fn get(&self, index: usize) -> Option<f32>;
    /// The place of the field with that index; the caller has checked the range.
    fn get_mut(&mut self, index: usize) -> Option<&mut f32>;
}

/// A group as a table names it: a section of the reference page.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Section {
    /// The table's field.
    pub name: &'static str,
    /// See [`Group::DOCUMENTATION`].
    pub documentation: &'static [&'static str],
    /// See [`Group::DECLARATIONS`].
    pub declarations: &'static [Declaration],
}

/// A sentence for people: the microcontroller has none to tell it to, and keeps the flash.
#[cfg(not(target_os = "none"))]
#[doc(hidden)]
#[macro_export]
macro_rules! for_people {
    ($text:literal) => {
        $text
    };
}

/// A sentence for people: the microcontroller has none to tell it to, and keeps the flash.
#[cfg(target_os = "none")]
#[doc(hidden)]
#[macro_export]
macro_rules! for_people {
    ($text:literal) => {
        ""
    };
}

/// Declares a struct of parameters: `field: "NAME", "unit", min..=max, default, "sentence";`
#[macro_export]
macro_rules! parameters {
    (
        $(#[doc = $line:literal])*
        $vis:vis struct $Group:ident {
            $($field:ident: $name:literal, $unit:literal, $min:literal..=$max:literal, $default:literal, $text:literal;)*
        }
    ) => {
        $(#[doc = $line])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        $vis struct $Group {
            $(
                #[doc = concat!($text, " (`", $name, "`, unit: ", $unit, ").")]
                pub $field: f32,
            )*
        }

        impl Default for $Group {
            fn default() -> Self {
                Self { $($field: $default,)* }
            }
        }

        impl $crate::Group for $Group {
            const DOCUMENTATION: &'static [&'static str] = &[$($line),*];
            const DECLARATIONS: &'static [$crate::Declaration] = &[
                $($crate::Declaration {
                    name: $name,
                    unit: $unit,
                    min: $min,
                    max: $max,
                    default: $default,
                    text: $crate::for_people!($text),
                },)*
            ];

            fn get(&self, index: usize) -> Option<f32> {
                [$(self.$field),*].get(index).copied()
            }

            fn get_mut(&mut self, index: usize) -> Option<&mut f32> {
                [$(&mut self.$field),*].into_iter().nth(index)
            }
        }
    };
}

/// Puts several groups under one index.
#[macro_export]
macro_rules! parameter_groups {
    (
        $(#[$meta:meta])*
        $vis:vis struct $Table:ident { $($field:ident: $Group:ty),* $(,)? }
    ) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        $vis struct $Table {
            $(
                #[doc = concat!("The parameters of [`", stringify!($Group), "`].")]
                pub $field: $Group,
            )*
        }

        impl $Table {
            /// How many parameters there are.
            pub const COUNT: usize = 0 $(+ <$Group as $crate::Group>::DECLARATIONS.len())*;

            /// All declarations, in the order of their indices.
            pub fn declarations() -> impl Iterator<Item = &'static $crate::Declaration> {
                core::iter::empty()$(.chain(<$Group as $crate::Group>::DECLARATIONS.iter()))*
            }

            /// The groups, in the order of their parameters' indices.
            pub const GROUPS: &'static [$crate::Section] = &[$($crate::Section {
                name: stringify!($field),
                documentation: <$Group as $crate::Group>::DOCUMENTATION,
                declarations: <$Group as $crate::Group>::DECLARATIONS,
            },)*];

            /// The declaration of one parameter.
            pub fn declaration(index: usize) -> Option<&'static $crate::Declaration> {
                Self::declarations().nth(index)
            }

            /// The index of a parameter by its name.
            pub fn find(name: &str) -> Option<usize> {
                Self::declarations().position(|declaration| declaration.name == name)
            }

            /// The value of one parameter.
            pub fn get(&self, index: usize) -> Option<f32> {
                let mut rest = index;
                $(
                    let count = <$Group as $crate::Group>::DECLARATIONS.len();
                    if rest < count {
                        return $crate::Group::get(&self.$field, rest);
                    }
                    rest -= count;
                )*
                let _ = rest;
                None
            }

            /// Sets one parameter, or says why not.
            pub fn set(&mut self, index: usize, value: f32) -> Result<(), $crate::Refusal> {
                Self::declaration(index).ok_or($crate::Refusal::Unknown)?.check(value)?;
                let mut rest = index;
                $(
                    let count = <$Group as $crate::Group>::DECLARATIONS.len();
                    if rest < count {
                        if let Some(place) = $crate::Group::get_mut(&mut self.$field, rest) {
                            *place = value;
                        }
                        return Ok(());
                    }
                    rest -= count;
                )*
                let _ = rest;
                Err($crate::Refusal::Unknown)
            }
        }
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    parameters! {
        /// A pair.
        ///
        /// Of two sides.
        struct Pair {
            left: "LEFT", "m", -1.0..=1.0, 0.5, "One side";
            right: "RIGHT", "", 0.0..=10.0, 3.0, "The other side";
        }
    }
    parameters! {
        /// A single one.
        struct Single {
            only: "ONLY", "s", 0.0..=1.0, 1.0, "Alone";
        }
    }
    parameter_groups! {
        /// Both.
        struct Table { pair: Pair, single: Single }
    }

    #[test]
    fn index_runs_through_all_groups_in_order() {
        assert_eq!(Table::COUNT, 3);
        for (index, declaration) in Table::declarations().enumerate() {
            assert_eq!(Table::find(declaration.name), Some(index));
            assert_eq!(Table::default().get(index), Some(declaration.default));
        }
        assert_eq!(Table::default().get(3), None);
        assert_eq!(Table::find("NONE"), None);
    }

    #[test]
    fn sections_tell_what_their_groups_are_for() {
        let [pair, single] = Table::GROUPS else {
            panic!("two groups");
        };
        assert_eq!((pair.name, single.name), ("pair", "single"));
        assert_eq!(pair.documentation, [" A pair.", "", " Of two sides."]);
        assert!(Table::declarations().eq(pair.declarations.iter().chain(single.declarations)));
    }

    #[test]
    fn a_write_reaches_only_its_own_field() {
        for index in 0..Table::COUNT {
            let mut table = Table::default();
            assert_eq!(table.set(index, 0.25), Ok(()));
            for other in 0..Table::COUNT {
                let expected = if other == index {
                    Some(0.25)
                } else {
                    Table::default().get(other)
                };
                assert_eq!(table.get(other), expected);
            }
        }
    }

    #[test]
    fn out_of_range_not_a_number_and_unknown_change_nothing() {
        let mut table = Table::default();
        for value in [-1.1, 1.1, f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let refusal = table.set(0, value);
            assert_eq!(refusal, Err(Refusal::OutOfRange { min: -1.0, max: 1.0 }));
        }
        assert_eq!(table.set(3, 0.0), Err(Refusal::Unknown));
        assert_eq!(table, Table::default());
    }
}
