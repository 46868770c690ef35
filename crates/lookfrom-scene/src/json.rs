//! JSON that front ends write. JSON has no NaN or infinities; they are written as the strings "NaN", "Infinity" and "-Infinity" (the JSON
//! mapping of Protocol Buffers, proto3), so that `null` always means an absent value.

use serde::ser::{
    Serialize, SerializeMap, SerializeSeq, SerializeStruct, SerializeStructVariant, SerializeTuple,
    SerializeTupleStruct, SerializeTupleVariant, Serializer,
};

/// A document written out in the source.
pub use serde_json::json;

/// A value on one line.
pub fn line(value: &impl Serialize) -> String {
    // None of the values has keys or types that serde_json refuses.
    serde_json::to_string(&Named(value)).unwrap_or_default()
}

/// A value on many lines, indented.
pub fn document(value: &impl Serialize) -> String {
    serde_json::to_string_pretty(&Named(value)).unwrap_or_default()
}

/// The string for a number that JSON cannot represent.
fn name(number: f64) -> Option<&'static str> {
    match number {
        _ if number.is_nan() => Some("NaN"),
        f64::INFINITY => Some("Infinity"),
        f64::NEG_INFINITY => Some("-Infinity"),
        _ => None,
    }
}

/// A value whose non-finite numbers are serialized as strings.
struct Named<'a, T: ?Sized>(&'a T);

impl<T: Serialize + ?Sized> Serialize for Named<'_, T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.0.serialize(Naming(serializer))
    }
}

/// A serializer, or a part of one, that forwards everything but writes non-finite numbers as strings.
struct Naming<S>(S);

macro_rules! hand_on {
    ($($method:ident: $type:ty),* $(,)?) => {$(
        fn $method(self, value: $type) -> Result<S::Ok, S::Error> {
            self.0.$method(value)
        }
    )*};
}

impl<S: Serializer> Serializer for Naming<S> {
    type Ok = S::Ok;
    type Error = S::Error;
    type SerializeSeq = Naming<S::SerializeSeq>;
    type SerializeTuple = Naming<S::SerializeTuple>;
    type SerializeTupleStruct = Naming<S::SerializeTupleStruct>;
    type SerializeTupleVariant = Naming<S::SerializeTupleVariant>;
    type SerializeMap = Naming<S::SerializeMap>;
    type SerializeStruct = Naming<S::SerializeStruct>;
    type SerializeStructVariant = Naming<S::SerializeStructVariant>;

    fn serialize_f32(self, value: f32) -> Result<S::Ok, S::Error> {
        match name(f64::from(value)) {
            Some(name) => self.0.serialize_str(name),
            None => self.0.serialize_f32(value),
        }
    }

    fn serialize_f64(self, value: f64) -> Result<S::Ok, S::Error> {
        match name(value) {
            Some(name) => self.0.serialize_str(name),
            None => self.0.serialize_f64(value),
        }
    }

    hand_on!(
        serialize_bool: bool,
        serialize_i8: i8,
        serialize_i16: i16,
        serialize_i32: i32,
        serialize_i64: i64,
        serialize_u8: u8,
        serialize_u16: u16,
        serialize_u32: u32,
        serialize_u64: u64,
        serialize_char: char,
        serialize_str: &str,
        serialize_bytes: &[u8],
        serialize_unit_struct: &'static str,
    );

    fn serialize_none(self) -> Result<S::Ok, S::Error> {
        self.0.serialize_none()
    }

    fn serialize_unit(self) -> Result<S::Ok, S::Error> {
        self.0.serialize_unit()
    }

    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> Result<S::Ok, S::Error> {
        self.0.serialize_some(&Named(value))
    }

    fn serialize_unit_variant(
        self,
        of: &'static str,
        index: u32,
        variant: &'static str,
    ) -> Result<S::Ok, S::Error> {
        self.0.serialize_unit_variant(of, index, variant)
    }

    fn serialize_newtype_struct<T: Serialize + ?Sized>(
        self,
        name: &'static str,
        value: &T,
    ) -> Result<S::Ok, S::Error> {
        self.0.serialize_newtype_struct(name, &Named(value))
    }

    fn serialize_newtype_variant<T: Serialize + ?Sized>(
        self,
        of: &'static str,
        index: u32,
        variant: &'static str,
        value: &T,
    ) -> Result<S::Ok, S::Error> {
        self.0.serialize_newtype_variant(of, index, variant, &Named(value))
    }

    fn serialize_seq(self, length: Option<usize>) -> Result<Self::SerializeSeq, S::Error> {
        self.0.serialize_seq(length).map(Naming)
    }

    fn serialize_tuple(self, length: usize) -> Result<Self::SerializeTuple, S::Error> {
        self.0.serialize_tuple(length).map(Naming)
    }

    fn serialize_tuple_struct(
        self,
        name: &'static str,
        length: usize,
    ) -> Result<Self::SerializeTupleStruct, S::Error> {
        self.0.serialize_tuple_struct(name, length).map(Naming)
    }

    fn serialize_tuple_variant(
        self,
        of: &'static str,
        index: u32,
        variant: &'static str,
        length: usize,
    ) -> Result<Self::SerializeTupleVariant, S::Error> {
        self.0.serialize_tuple_variant(of, index, variant, length).map(Naming)
    }

    fn serialize_map(self, length: Option<usize>) -> Result<Self::SerializeMap, S::Error> {
        self.0.serialize_map(length).map(Naming)
    }

    fn serialize_struct(self, name: &'static str, length: usize) -> Result<Self::SerializeStruct, S::Error> {
        self.0.serialize_struct(name, length).map(Naming)
    }

    fn serialize_struct_variant(
        self,
        of: &'static str,
        index: u32,
        variant: &'static str,
        length: usize,
    ) -> Result<Self::SerializeStructVariant, S::Error> {
        self.0.serialize_struct_variant(of, index, variant, length).map(Naming)
    }
}

macro_rules! compound {
    ($($trait:ident: $($method:ident($($key:ident)?)),*;)*) => {$(
        impl<S: $trait> $trait for Naming<S> {
            type Ok = S::Ok;
            type Error = S::Error;

            $(fn $method<T: Serialize + ?Sized>(&mut self, $($key: &'static str,)? value: &T) -> Result<(), S::Error> {
                self.0.$method($($key,)? &Named(value))
            })*

            fn end(self) -> Result<S::Ok, S::Error> {
                self.0.end()
            }
        }
    )*};
}

compound! {
    SerializeSeq: serialize_element();
    SerializeTuple: serialize_element();
    SerializeTupleStruct: serialize_field();
    SerializeTupleVariant: serialize_field();
    SerializeMap: serialize_key(), serialize_value();
    SerializeStruct: serialize_field(key);
    SerializeStructVariant: serialize_field(key);
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    #[derive(serde::Serialize)]
    struct Numbers {
        one: f32,
        three: [f64; 3],
        some: Option<f64>,
        none: Option<f64>,
        pair: (u8, f32),
        map: BTreeMap<&'static str, Vec<f32>>,
        kinds: [Kind; 4],
        #[serde(flatten)]
        flat: BTreeMap<String, f64>,
    }

    #[derive(Clone, Copy, serde::Serialize)]
    enum Kind {
        Unit,
        New(f32),
        Tuple(f32, i8),
        Struct { inner: f64 },
    }

    #[test]
    fn numbers_that_json_lacks_have_names_wherever_they_are() {
        let numbers = Numbers {
            one: f32::NAN,
            three: [f64::INFINITY, -1.5, f64::NEG_INFINITY],
            some: Some(f64::NAN),
            none: None,
            pair: (1, f32::NEG_INFINITY),
            map: [("key", vec![0.1, f32::INFINITY])].into(),
            kinds: [
                Kind::Unit,
                Kind::New(f32::NAN),
                Kind::Tuple(-0.0, -1),
                Kind::Struct { inner: f64::INFINITY },
            ],
            flat: [("flat".to_owned(), f64::NAN)].into(),
        };
        let expected = r#"{"one":"NaN","three":["Infinity",-1.5,"-Infinity"],"some":"NaN","none":null,"pair":[1,"-Infinity"],"map":{"key":[0.1,"Infinity"]},"kinds":["Unit",{"New":"NaN"},{"Tuple":[-0.0,-1]},{"Struct":{"inner":"Infinity"}}],"flat":"NaN"}"#;
        assert_eq!(line(&numbers), expected);
        let [short, long] = [expected, &document(&numbers)].map(serde_json::from_str::<serde_json::Value>);
        assert_eq!(short.expect("it is JSON"), long.expect("it is JSON"));
    }
}
