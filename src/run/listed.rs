//! Enums that list their variants.

/// Declares an enum with a constant `ALL` of its variants.
macro_rules! listed {
    ($(#[$of_enum:meta])* pub enum $Name:ident { $($(#[$of_variant:meta])* $Variant:ident,)+ }) => {
        $(#[$of_enum])*
        pub enum $Name { $($(#[$of_variant])* $Variant,)+ }

        impl $Name {
            /// All variants.
            pub const ALL: [Self; [$(stringify!($Variant)),+].len()] = [$(Self::$Variant),+];
        }
    };
}

pub(crate) use listed;
