//! Enums whose variants have permanent numbers, on the wire and in documents.

/// Declares such an enum together with `numbered`, which therefore knows every variant.
#[macro_export]
macro_rules! numbered {
    (
        $(#[$meta:meta])*
        pub enum $name:ident { $($(#[$about:meta])* $variant:ident = $number:literal,)* }
    ) => {
        $(#[$meta])*
        #[repr(u8)]
        pub enum $name { $($(#[$about])* $variant = $number,)* }

        impl $name {
            /// The variant with this number; `None` for a number without one.
            pub const fn numbered(number: u8) -> ::core::option::Option<Self> {
                match number {
                    $($number => ::core::option::Option::Some(Self::$variant),)*
                    _ => ::core::option::Option::None,
                }
            }
        }
    };
}
