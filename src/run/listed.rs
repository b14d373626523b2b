//! Enums that list their variants.

/// Declares an enum of variants that are written by their names, with a constant `ALL` of them.
macro_rules! listed {
    ($(#[$of_enum:meta])* pub enum $Name:ident { $($(#[$of_variant:meta])* $Variant:ident = $name:literal,)+ }) => {
        $(#[$of_enum])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
        pub enum $Name { $($(#[$of_variant])* #[serde(rename = $name)] $Variant,)+ }

        impl $Name {
            /// All variants.
            pub const ALL: [Self; [$($name),+].len()] = [$(Self::$Variant),+];

            /// The names of all variants.
            pub const NAMES: &[&str] = &[$($name),+];

            /// The name in recordings and scenarios.
            pub fn name(self) -> &'static str {
                match self { $(Self::$Variant => $name),+ }
            }

            /// The variant with this name.
            pub fn find(name: &str) -> Option<Self> {
                Self::ALL.into_iter().find(|variant| variant.name() == name)
            }
        }
    };
}

pub(crate) use listed;
