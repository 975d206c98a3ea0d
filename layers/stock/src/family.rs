//! Families: one implementation for messages of several types, each a kind of its own.
//!
//! Must never let two kinds of a family differ in anything but the type of their messages: the plain name takes
//! numbers, `name.bit`, `name.vector`, … the other types.

/// Declares `KINDS`: the module `$form<T>` as one kind for each name and type of message. The file brings
/// `ABOUT` and `DIAGRAM`; `$form` brings `INPUTS`, `OUTPUTS`, `PARAMETERS` and `new`.
macro_rules! family {
    ($form:ident: $($name:literal $payload:ty),+ $(,)?) => {
        /// The kinds of this file.
        pub const KINDS: &[&afsm::ModuleKind] = &[$(&afsm::ModuleKind {
            declaration: &ipc::wiring::Declaration {
                name: $name,
                about: ABOUT,
                diagram: DIAGRAM,
                inputs: $form::<$payload>::INPUTS,
                outputs: $form::<$payload>::OUTPUTS,
                parameters: $form::<$payload>::PARAMETERS,
            },
            build: |settings| Box::new($form::<$payload>::new(settings)),
        }),+];
    };
}
pub(crate) use family;
