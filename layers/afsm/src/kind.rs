//! Kinds of module: a declaration together with the function that builds one.
//!
//! Must never build a module that was not checked: [`Settings`] come out of the checker complete and in
//! order.

use ipc::clock::Span;
use ipc::wiring::{Catalog, Declaration, Setting};

use crate::module::Module;

/// A kind of module that this program can build.
#[derive(Clone, Copy, Debug)]
pub struct ModuleKind {
    /// What it looks like from outside.
    pub declaration: &'static Declaration,
    /// Builds one in its initial state.
    pub build: fn(&Settings<'_>) -> Box<dyn Module>,
}

/// The parameters of one module, as checked.
#[derive(Clone, Copy, Debug)]
pub struct Settings<'s> {
    declaration: &'static Declaration,
    values: &'s [Setting],
    seed: u64,
}

impl<'s> Settings<'s> {
    /// The checked `values` of a module of kind `declaration`; `seed` is the module's own.
    ///
    /// # Panics
    /// When the values are not those of the declaration.
    pub fn new(declaration: &'static Declaration, values: &'s [Setting], seed: u64) -> Settings<'s> {
        assert_eq!(
            declaration.parameters.len(),
            values.len(),
            "settings of {}",
            declaration.name
        );
        Settings {
            declaration,
            values,
            seed,
        }
    }

    fn get(&self, name: &str) -> &'s Setting {
        let index = self.declaration.parameters.iter().position(|p| p.name == name);
        &self.values
            [index.unwrap_or_else(|| panic!("{} declares no parameter {name:?}", self.declaration.name))]
    }

    /// A number, in the unit the declaration states.
    pub fn number(&self, name: &str) -> f64 {
        match self.get(name) {
            Setting::Number(n) => *n,
            other => panic!("{name:?} of {} is {other:?}", self.declaration.name),
        }
    }

    /// A length of time.
    pub fn span(&self, name: &str) -> Span {
        match self.get(name) {
            Setting::Span(s) => *s,
            other => panic!("{name:?} of {} is {other:?}", self.declaration.name),
        }
    }

    /// Yes or no.
    pub fn bit(&self, name: &str) -> bool {
        match self.get(name) {
            Setting::Bit(b) => *b,
            other => panic!("{name:?} of {} is {other:?}", self.declaration.name),
        }
    }

    /// A word.
    pub fn word(&self, name: &str) -> &'s str {
        match self.get(name) {
            Setting::Text(t) => t,
            other => panic!("{name:?} of {} is {other:?}", self.declaration.name),
        }
    }

    /// Some numbers.
    pub fn numbers(&self, name: &str) -> &'s [f64] {
        match self.get(name) {
            Setting::Numbers(n) => n,
            other => panic!("{name:?} of {} is {other:?}", self.declaration.name),
        }
    }

    /// Some lengths of time.
    pub fn spans(&self, name: &str) -> &'s [Span] {
        match self.get(name) {
            Setting::Spans(s) => s,
            other => panic!("{name:?} of {} is {other:?}", self.declaration.name),
        }
    }

    /// The seed of everything random in this module; differs from module to module.
    pub fn seed(&self) -> u64 {
        self.seed
    }
}

/// The kinds of module and body that a program was built with.
#[derive(Clone, Debug, Default)]
pub struct Kinds {
    modules: Vec<&'static ModuleKind>,
    bodies: Vec<&'static Declaration>,
}

impl Kinds {
    /// Adds kinds of module.
    ///
    /// # Panics
    /// When two kinds have one name.
    #[must_use]
    pub fn with(mut self, kinds: impl IntoIterator<Item = &'static ModuleKind>) -> Kinds {
        for kind in kinds {
            assert!(
                self.find(kind.declaration.name).is_none(),
                "two kinds {:?}",
                kind.declaration.name
            );
            self.modules.push(kind);
        }
        self
    }

    /// Adds kinds of body.
    #[must_use]
    pub fn with_bodies(mut self, bodies: impl IntoIterator<Item = &'static Declaration>) -> Kinds {
        self.bodies.extend(bodies);
        self
    }

    /// The kind called `name`.
    pub fn find(&self, name: &str) -> Option<&'static ModuleKind> {
        self.modules.iter().find(|k| k.declaration.name == name).copied()
    }
}

impl Catalog for Kinds {
    fn modules(&self) -> Vec<&'static Declaration> {
        self.modules.iter().map(|k| k.declaration).collect()
    }

    fn bodies(&self) -> Vec<&'static Declaration> {
        self.bodies.clone()
    }
}
