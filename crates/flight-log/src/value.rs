//! Values as ULog knows them: scalars and arrays of scalars.

use windhover_math::geodesy::GlobalPosition;
use windhover_math::{Quaternion, Vector3};

use crate::wire::{Decoder, Encoder};

/// A scalar type of ULog.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scalar {
    /// `int8_t`
    I8,
    /// `uint8_t`
    U8,
    /// `int16_t`
    I16,
    /// `uint16_t`
    U16,
    /// `int32_t`
    I32,
    /// `uint32_t`
    U32,
    /// `uint64_t`
    U64,
    /// `float`
    F32,
    /// `double`
    F64,
    /// `bool`
    Bool,
}

impl Scalar {
    /// Its name in a format.
    pub const fn name(self) -> &'static str {
        match self {
            Self::I8 => "int8_t",
            Self::U8 => "uint8_t",
            Self::I16 => "int16_t",
            Self::U16 => "uint16_t",
            Self::I32 => "int32_t",
            Self::U32 => "uint32_t",
            Self::U64 => "uint64_t",
            Self::F32 => "float",
            Self::F64 => "double",
            Self::Bool => "bool",
        }
    }

    /// Its bytes.
    pub const fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 | Self::Bool => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::U64 | Self::F64 => 8,
        }
    }
}

/// A value that a field can hold. Bits come back as they were written, those of NaN included.
pub trait Value: Copy {
    /// The scalar that it is made of.
    const SCALAR: Scalar;
    /// How many of them in an array; 0 for one that is no array.
    const COUNT: u8 = 0;
    /// Writes it.
    fn put(&self, out: &mut Encoder<'_>);
    /// Reads it.
    fn get(from: &mut Decoder<'_>) -> Option<Self>;
}

macro_rules! scalars {
    ($($type:ty: $scalar:ident),* $(,)?) => {
        $(impl Value for $type {
            const SCALAR: Scalar = Scalar::$scalar;
            #[inline]
            fn put(&self, out: &mut Encoder<'_>) {
                out.bytes(self.to_le_bytes());
            }
            #[inline]
            fn get(from: &mut Decoder<'_>) -> Option<Self> {
                from.bytes().map(Self::from_le_bytes)
            }
        })*
    };
}

scalars!(i8: I8, u8: U8, i16: I16, u16: U16, i32: I32, u32: U32, u64: U64, f32: F32, f64: F64);

impl Value for bool {
    const SCALAR: Scalar = Scalar::Bool;
    #[inline]
    fn put(&self, out: &mut Encoder<'_>) {
        out.bytes([u8::from(*self)]);
    }
    #[inline]
    fn get(from: &mut Decoder<'_>) -> Option<Self> {
        match from.bytes()? {
            [0] => Some(false),
            [1] => Some(true),
            _ => None,
        }
    }
}

impl<T: Value + Default, const N: usize> Value for [T; N] {
    const SCALAR: Scalar = T::SCALAR;
    const COUNT: u8 = N as u8;
    #[inline]
    fn put(&self, out: &mut Encoder<'_>) {
        for value in self {
            value.put(out);
        }
    }
    #[inline]
    fn get(from: &mut Decoder<'_>) -> Option<Self> {
        let mut values = [T::default(); N];
        for value in &mut values {
            *value = T::get(from)?;
        }
        Some(values)
    }
}

impl Value for Vector3 {
    const SCALAR: Scalar = Scalar::F32;
    const COUNT: u8 = 3;
    #[inline]
    fn put(&self, out: &mut Encoder<'_>) {
        [self.x, self.y, self.z].put(out);
    }
    #[inline]
    fn get(from: &mut Decoder<'_>) -> Option<Self> {
        let [x, y, z] = Value::get(from)?;
        Some(Self::new(x, y, z))
    }
}

/// Latitude and longitude in 1e-7 degree, altitude in mm.
impl Value for GlobalPosition {
    const SCALAR: Scalar = Scalar::I32;
    const COUNT: u8 = 3;
    #[inline]
    fn put(&self, out: &mut Encoder<'_>) {
        [self.latitude, self.longitude, self.altitude].put(out);
    }
    #[inline]
    fn get(from: &mut Decoder<'_>) -> Option<Self> {
        let [latitude, longitude, altitude] = Value::get(from)?;
        Some(Self {
            latitude,
            longitude,
            altitude,
        })
    }
}

/// In the order w, x, y, z, as PX4 has it.
impl Value for Quaternion {
    const SCALAR: Scalar = Scalar::F32;
    const COUNT: u8 = 4;
    #[inline]
    fn put(&self, out: &mut Encoder<'_>) {
        [self.w, self.x, self.y, self.z].put(out);
    }
    #[inline]
    fn get(from: &mut Decoder<'_>) -> Option<Self> {
        let [w, x, y, z] = Value::get(from)?;
        Some(Self::new(w, x, y, z))
    }
}
