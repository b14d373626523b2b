//! Enums that list their variants.

/// Declares an enum and lists its variants, so that none is forgotten.
macro_rules! listed {
    ($(#[$of_enum:meta])* pub enum $Name:ident { $($(#[$of_variant:meta])* $Variant:ident,)+ }) => {
        $(#[$of_enum])*
        pub enum $Name { $($(#[$of_variant])* $Variant,)+ }

        impl $Name {
            /// All of them.
            pub const ALL: [Self; [$(stringify!($Variant)),+].len()] = [$(Self::$Variant),+];
        }
    };
}

pub(crate) use listed;
