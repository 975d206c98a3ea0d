//! Seats: the modules of a layer as they stand beside their ports, and how a beat steps them.
//!
//! Must never let a module see what another one emits in the same beat: nothing is written here.

use std::ops::Range;

use ipc::clock::Time;
use ipc::wire::{Outlet, Register};
use rtrb::Producer;

use crate::layer::{Returned, give_back};
use crate::module::{Beat, Module};

/// A module as it stands in a layer.
pub(crate) struct Seat {
    pub(crate) machine: Box<dyn Module>,
    /// Its registers, the reset line last.
    pub(crate) inputs: Slots,
    pub(crate) outputs: Slots,
    /// Its number as it was seated.
    pub(crate) number: u32,
    /// Whether its reset line is connected.
    pub(crate) reset: bool,
}

/// Some of a layer's ports, one after the other. Half as long as a `Range<usize>`: a beat fetches it for every module.
#[derive(Clone, Copy)]
pub(crate) struct Slots {
    pub(crate) first: u32,
    pub(crate) end: u32,
}

impl Slots {
    /// `count` ports from the `first` on.
    ///
    /// # Panics
    /// When there are more than four milliards.
    pub(crate) fn new(first: usize, count: usize) -> Slots {
        let slot = |n: usize| u32::try_from(n).expect("a layer has fewer ports");
        Slots {
            first: slot(first),
            end: slot(first + count),
        }
    }

    #[inline]
    pub(crate) fn range(self) -> Range<usize> {
        self.first as usize..self.end as usize
    }
}

/// What a layer steps: the modules, their registers and outlets.
pub(crate) type Parts<'l> = (&'l mut [Seat], &'l mut [Register], &'l mut [Outlet]);

/// Gathers every register, which `gathered` then sees while the processor has it at hand, and steps every module.
#[inline(always)]
pub(crate) fn step_all(
    now: Time,
    (seats, registers, outlets): Parts<'_>,
    returned: &mut Producer<Returned>,
    mut gathered: impl FnMut(usize, &Register),
) {
    for seat in seats {
        let own = &mut registers[seat.inputs.range()];
        let (reset_line, own) = own.split_last_mut().expect("every module has a reset line");
        for (k, register) in own.iter_mut().enumerate() {
            register.gather(now, |end| give_back(returned, end));
            gathered(seat.inputs.first as usize + k, register);
        }
        if seat.reset {
            reset_line.gather(now, |end| give_back(returned, end));
            gathered(seat.inputs.end as usize - 1, reset_line);
            if reset_line.arrived() {
                seat.machine.reset();
                own.iter_mut().for_each(Register::clear);
                continue;
            }
        }
        seat.machine.step(&mut Beat {
            now,
            inputs: own,
            outputs: &mut outlets[seat.outputs.range()],
        });
    }
}
