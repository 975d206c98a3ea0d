//! Typed ports: how a module names its inputs and outputs in code.
//!
//! Must never reach another module: a port is a number that only this module's own beat understands.

use std::marker::PhantomData;

use ipc::message::Payload;

/// An input port that takes messages of type `T`.
#[derive(Debug)]
pub struct In<T> {
    pub(crate) index: usize,
    kind: PhantomData<T>,
}

/// An output port that emits messages of type `T`.
#[derive(Debug)]
pub struct Out<T> {
    pub(crate) index: usize,
    kind: PhantomData<T>,
}

impl<T> Clone for In<T> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<T> Copy for In<T> {}

impl<T> Clone for Out<T> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<T> Copy for Out<T> {}

impl<T: Payload> In<T> {
    /// The `index`-th input of the module's declaration.
    pub const fn at(index: usize) -> In<T> {
        In {
            index,
            kind: PhantomData,
        }
    }
}

impl<T: Payload> Out<T> {
    /// The `index`-th output of the module's declaration.
    pub const fn at(index: usize) -> Out<T> {
        Out {
            index,
            kind: PhantomData,
        }
    }
}
