//! Types of numbers, and numbers from bytes and words.

/// Which byte of a number comes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ByteOrder {
    Big,
    Little,
}

/// A type of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Scalar {
    /// The type of this name in a legacy file, in any case.
    pub(super) fn legacy(name: &str) -> Option<Self> {
        Some(match name.to_ascii_lowercase().as_str() {
            "char" | "signed_char" => Self::I8,
            "unsigned_char" => Self::U8,
            "short" => Self::I16,
            "unsigned_short" => Self::U16,
            "int" | "vtkidtype" => Self::I32,
            "unsigned_int" => Self::U32,
            "long" | "vtktypeint64" => Self::I64,
            "unsigned_long" | "vtktypeuint64" => Self::U64,
            "float" => Self::F32,
            "double" => Self::F64,
            _ => return None,
        })
    }

    /// The type of this name in an XML file.
    pub(super) fn xml(name: &str) -> Option<Self> {
        Some(match name {
            "Int8" => Self::I8,
            "UInt8" => Self::U8,
            "Int16" => Self::I16,
            "UInt16" => Self::U16,
            "Int32" => Self::I32,
            "UInt32" => Self::U32,
            "Int64" => Self::I64,
            "UInt64" => Self::U64,
            "Float32" => Self::F32,
            "Float64" => Self::F64,
            _ => return None,
        })
    }

    /// Bytes a number.
    pub(super) const fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }
}

/// What arrays are read into.
pub(super) trait Number: Sized + std::str::FromStr {
    /// What a message calls it.
    const NAME: &'static str;

    /// The number in the first bytes, as many as `scalar` has. `None` if it is of another kind or
    /// out of range.
    fn from_bytes(bytes: &[u8], scalar: Scalar, order: ByteOrder) -> Option<Self>;
}

impl Number for f32 {
    const NAME: &'static str = "a number";

    fn from_bytes(bytes: &[u8], scalar: Scalar, order: ByteOrder) -> Option<Self> {
        Some(match scalar {
            Scalar::F32 => Self::from_bits(unsigned(bytes, order) as u32),
            Scalar::F64 => f64::from_bits(unsigned(bytes, order)) as Self,
            Scalar::U8 | Scalar::U16 | Scalar::U32 | Scalar::U64 => unsigned(bytes, order) as Self,
            _ => signed(bytes, order) as Self,
        })
    }
}

impl Number for i64 {
    const NAME: &'static str = "a whole number";

    fn from_bytes(bytes: &[u8], scalar: Scalar, order: ByteOrder) -> Option<Self> {
        match scalar {
            Scalar::F32 | Scalar::F64 => None,
            Scalar::U8 | Scalar::U16 | Scalar::U32 | Scalar::U64 => {
                Self::try_from(unsigned(bytes, order)).ok()
            }
            _ => Some(signed(bytes, order)),
        }
    }
}

/// The bits of a number of up to eight bytes.
pub(super) fn unsigned(bytes: &[u8], order: ByteOrder) -> u64 {
    let push = |bits: u64, byte: &u8| bits << 8 | u64::from(*byte);
    match order {
        ByteOrder::Big => bytes.iter().fold(0, push),
        ByteOrder::Little => bytes.iter().rev().fold(0, push),
    }
}

/// A whole number of up to eight bytes whose first bit is its sign.
fn signed(bytes: &[u8], order: ByteOrder) -> i64 {
    let unused_bits = 64 - 8 * bytes.len().clamp(1, 8) as u32;
    (unsigned(bytes, order) << unused_bits).cast_signed() >> unused_bits
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_sign_and_byte_order() {
        let int = |bytes: &[u8], scalar, order| i64::from_bytes(bytes, scalar, order);
        assert_eq!(int(&[0xFF, 0xFE], Scalar::I16, ByteOrder::Big), Some(-2));
        assert_eq!(int(&[0xFE, 0xFF], Scalar::I16, ByteOrder::Little), Some(-2));
        assert_eq!(int(&[0xFE, 0xFF], Scalar::U16, ByteOrder::Little), Some(0xFFFE));
        assert_eq!(int(&[0x80, 0, 0, 0, 0, 0, 0, 0], Scalar::I64, ByteOrder::Big), Some(i64::MIN));
        assert_eq!(int(&[0xFF; 8], Scalar::U64, ByteOrder::Big), None);
        assert_eq!(int(&[0; 4], Scalar::F32, ByteOrder::Big), None);
        let float = |bytes: &[u8], scalar, order| f32::from_bytes(bytes, scalar, order);
        assert_eq!(float(&1.5_f32.to_be_bytes(), Scalar::F32, ByteOrder::Big), Some(1.5));
        assert_eq!(float(&(-2.5_f64).to_le_bytes(), Scalar::F64, ByteOrder::Little), Some(-2.5));
        assert_eq!(float(&[0xFE], Scalar::I8, ByteOrder::Big), Some(-2.0));
    }
}
