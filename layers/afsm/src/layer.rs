//! A running layer: its modules, their registers and outlets, stepped together once a beat.
//!
//! Must never allocate, lock or wait in [`RunningLayer::step`] and [`RunningLayer::commit`], nor let the
//! order of modules within a beat matter: every module sees what was on the wires before the beat, and all
//! messages of the beat are written at its end.
//!
//! ```text
//!   beat:  commands ─► gather registers, step modules (any order) ─► commit outlets, stamped together
//! ```

use ipc::clock::Time;
use ipc::message::Words;
use ipc::wire::{Outlet, Reader, Register, TapEnd};
use ipc::wiring::creature::How;
use rtrb::{Consumer, Producer};

use crate::kind::ModuleKind;
use crate::module::Module;
use crate::seat::{Seat, Slots, step_all};
use crate::trace::Tracer;

/// A change to what reaches a running layer, made by a thread that is not real-time.
#[derive(Debug)]
pub enum Command {
    /// Joins a suppressor to the layer's n-th input.
    Suppress(usize, TapEnd),
    /// Joins an inhibitor to the layer's n-th output.
    Inhibit(usize, TapEnd),
    /// Tells all taps of a plugged layer to go.
    Release(ipc::wire::Plug),
    /// Connects the layer's n-th input to another wire.
    Connect(usize, Reader),
}

impl Command {
    /// Joins `end` to the layer's `port`-th input or output.
    pub fn join(how: How, port: usize, end: TapEnd) -> Command {
        match how {
            How::Suppress => Command::Suppress(port, end),
            How::Inhibit => Command::Inhibit(port, end),
        }
    }
}

/// What a layer has no use for any more: it may hold the last end of a mapping, so the layer's own thread must not
/// drop it.
#[derive(Debug)]
pub enum Returned {
    /// A tap.
    Tap(TapEnd),
    /// The wire that an input was connected to.
    Wire(Reader),
}

/// Most commands waiting for a layer, and things waiting to be taken back: those of a newcomer that taps
/// every port it may.
pub const COMMANDS_MAX: usize = 256;

/// The two ends of a layer's command channel, for the thread that is not real-time.
#[derive(Debug)]
pub struct Hand {
    /// Commands to the layer, taken up at its next beat.
    pub commands: Producer<Command>,
    /// What the layer has let go, to be dropped here.
    pub returned: Consumer<Returned>,
}

/// A layer that can be stepped.
pub struct RunningLayer {
    /// The modules, in the order in which they step.
    seats: Vec<Seat>,
    /// What the modules are called, as they were seated: no beat asks for it.
    names: Vec<String>,
    registers: Vec<Register>,
    outlets: Vec<Outlet>,
    commands: Consumer<Command>,
    returned: Producer<Returned>,
    tracer: Option<Tracer>,
}

impl std::fmt::Debug for RunningLayer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "RunningLayer({} modules)", self.seats.len())
    }
}

impl RunningLayer {
    /// A layer without modules, and the hand that reaches into it.
    pub fn new() -> (RunningLayer, Hand) {
        let (command_in, command_out) = rtrb::RingBuffer::new(COMMANDS_MAX);
        let (return_in, return_out) = rtrb::RingBuffer::new(COMMANDS_MAX);
        let layer = RunningLayer {
            seats: Vec::new(),
            names: Vec::new(),
            registers: Vec::new(),
            outlets: Vec::new(),
            commands: command_out,
            returned: return_in,
            tracer: None,
        };
        (
            layer,
            Hand {
                commands: command_in,
                returned: return_out,
            },
        )
    }

    /// Makes room for so many more modules, registers (a reset line for each module among them) and outlets, so that they
    /// lie close together.
    pub fn reserve(&mut self, modules: usize, registers: usize, outlets: usize) {
        self.seats.reserve_exact(modules);
        self.names.reserve_exact(modules);
        self.registers.reserve_exact(registers);
        self.outlets.reserve_exact(outlets);
    }

    /// Seats a module of `kind`: `registers` in the order of its declaration with the reset line last,
    /// `outlets` in the order of its declaration.
    ///
    /// # Panics
    /// When the numbers of ports are not those of the declaration.
    pub fn seat(
        &mut self,
        name: &str,
        kind: &ModuleKind,
        machine: Box<dyn Module>,
        registers: Vec<Register>,
        outlets: Vec<Outlet>,
        reset: bool,
    ) {
        assert_eq!(
            registers.len(),
            kind.declaration.inputs.len() + 1,
            "inputs of {name}"
        );
        assert_eq!(outlets.len(), kind.declaration.outputs.len(), "outputs of {name}");
        let inputs = Slots::new(self.registers.len(), registers.len());
        let outputs = Slots::new(self.outlets.len(), outlets.len());
        self.registers.extend(registers);
        self.outlets.extend(outlets);
        let number = u32::try_from(self.seats.len()).expect("a layer has fewer modules");
        self.names.push(name.into());
        self.seats.push(Seat {
            machine,
            inputs,
            outputs,
            number,
            reset,
        });
    }

    /// Steps the modules in another order from now on: `order` holds the number of every module once.
    ///
    /// # Panics
    /// When it doesn't.
    pub fn set_order(&mut self, order: &[usize]) {
        let mut places = vec![None; self.seats.len()];
        for (place, &number) in order.iter().enumerate() {
            places[number] = Some(place);
        }
        assert!(
            places.iter().all(Option::is_some) && order.len() == places.len(),
            "an order names every module once"
        );
        self.seats
            .sort_unstable_by_key(|seat| places[seat.number as usize]);
    }

    /// Traces every beat from now on.
    pub fn trace(&mut self, tracer: Tracer) {
        self.tracer = Some(tracer);
    }

    /// How many registers and outlets there are.
    pub fn ports(&self) -> (usize, usize) {
        (self.registers.len(), self.outlets.len())
    }

    /// Puts every module back in its initial state and empties its registers: the layer begins anew.
    pub fn restart(&mut self) {
        self.seats.iter_mut().for_each(|seat| seat.machine.reset());
        self.registers.iter_mut().for_each(Register::clear);
    }

    /// How many modules there are.
    pub fn len(&self) -> usize {
        self.seats.len()
    }

    /// Whether there is no module.
    pub fn is_empty(&self) -> bool {
        self.seats.is_empty()
    }

    /// The state of the module called `name`.
    pub fn state_of(&self, name: &str) -> Option<&'static str> {
        let number = self.names.iter().position(|n| n == name)?;
        let seat = self.seats.iter().find(|seat| seat.number as usize == number)?;
        Some(seat.machine.state())
    }

    /// The n-th input's register: inputs count module by module as they were seated, reset lines included.
    pub fn register(&self, input: usize) -> &Register {
        &self.registers[input]
    }

    /// The n-th output's outlet: outputs count module by module as they were seated.
    pub fn outlet(&self, output: usize) -> &Outlet {
        &self.outlets[output]
    }

    /// How many outputs there are.
    pub fn outputs(&self) -> usize {
        self.outlets.len()
    }

    /// Takes up commands between two beats.
    pub fn take_up(&mut self) {
        while let Ok(command) = self.commands.pop() {
            self.obey(command);
        }
    }

    /// Looks at every register and tap between two beats; see [`Register::look`].
    pub fn look(&mut self, now: Time) {
        if let Some(tracer) = &mut self.tracer {
            tracer.forget();
        }
        for register in &mut self.registers {
            register.look(now, |end| give_back(&mut self.returned, end));
        }
        self.look_at_inhibitors(now);
    }

    /// Takes in what the inhibitors of every output say; see [`Outlet::look`].
    pub fn look_at_inhibitors(&mut self, now: Time) {
        for outlet in &mut self.outlets {
            outlet.look(now, |end| give_back(&mut self.returned, end));
        }
    }

    /// Writes a message on the n-th output at once, as though its module emitted it; see [`Outlet::put`].
    pub fn put(&mut self, output: usize, now: Time, words: &Words) -> bool {
        let outlet = &mut self.outlets[output];
        let wrote = outlet.put(now, words, |end| give_back(&mut self.returned, end));
        if let Some(tracer) = &mut self.tracer {
            tracer.alone(output, outlet, Some((wrote, &words[..])));
        }
        wrote
    }

    /// First half of a beat: takes up commands, looks at every register, steps every module.
    pub fn step(&mut self, now: Time) {
        if let Some(tracer) = &mut self.tracer {
            tracer.begin(now);
        }
        self.take_up();
        let RunningLayer {
            seats,
            registers,
            outlets,
            returned,
            tracer,
            ..
        } = self;
        let parts = (&mut seats[..], &mut registers[..], &mut outlets[..]);
        match tracer {
            Some(tracer) => step_all(now, parts, returned, |slot, register| {
                tracer.register(slot, register)
            }),
            None => step_all(now, parts, returned, |_, _| {}),
        }
    }

    /// Second half of a beat: writes what was emitted, stamped `now`, unless inhibited.
    pub fn commit(&mut self, now: Time) {
        let (outlets, returned) = (&mut self.outlets, &mut self.returned);
        let Some(tracer) = &mut self.tracer else {
            for outlet in outlets {
                outlet.commit(now, |end| give_back(returned, end));
            }
            return;
        };
        for (slot, outlet) in outlets.iter_mut().enumerate() {
            let staged = outlet.is_staged();
            let wrote = outlet.commit(now, |end| give_back(returned, end));
            tracer.outlet(slot, outlet, staged, wrote);
        }
        if tracer.begins_anew() {
            let outlets = self.outlets.iter().map(|o| (o.counts().emitted, o.kind()));
            tracer.tell_numbers(self.registers.iter().map(Register::seen), outlets);
        }
        tracer.end(now);
    }

    /// Writes what was emitted on the n-th output, as [`RunningLayer::commit`] does on all of them. Says whether
    /// it wrote.
    pub fn commit_one(&mut self, output: usize, now: Time) -> bool {
        let outlet = &mut self.outlets[output];
        let staged = outlet.is_staged();
        let wrote = outlet.commit(now, |end| give_back(&mut self.returned, end));
        if let Some(tracer) = &mut self.tracer {
            tracer.alone(output, outlet, staged.then_some((wrote, outlet.words())));
        }
        wrote
    }

    fn obey(&mut self, command: Command) {
        if let Some(tracer) = &mut self.tracer {
            tracer.command(&command);
        }
        let refused = match command {
            Command::Suppress(input, end) if input < self.registers.len() => {
                self.connect_reset(input);
                self.registers[input].suppress(end)
            }
            Command::Suppress(_, end) => Err(end),
            Command::Inhibit(output, end) => match self.outlets.get_mut(output) {
                Some(outlet) => outlet.inhibit(end),
                None => Err(end),
            },
            Command::Release(plug) => {
                self.registers.iter_mut().for_each(|r| r.release(plug));
                self.outlets.iter_mut().for_each(|o| o.release(plug));
                Ok(())
            }
            Command::Connect(input, wire) => return self.connect(input, wire),
        };
        if let Err(end) = refused {
            give_back(&mut self.returned, end);
        }
    }

    fn connect(&mut self, input: usize, wire: Reader) {
        let before = match self.registers.get_mut(input) {
            Some(register) => register.connect(wire),
            None => wire,
        };
        hand_over(&mut self.returned, Returned::Wire(before));
    }

    /// A tap on a reset line connects it.
    fn connect_reset(&mut self, input: usize) {
        if let Some(seat) = self.seats.iter_mut().find(|s| s.inputs.end as usize == input + 1) {
            seat.reset = true;
        }
    }
}

/// Hands a tap to the thread that may drop it.
pub(crate) fn give_back(returned: &mut Producer<Returned>, end: TapEnd) {
    hand_over(returned, Returned::Tap(end));
}

/// Hands what is let go to the thread that may drop it. The ring has room for everything there can be, so it is
/// forgotten here only if the other side is gone for good.
fn hand_over(returned: &mut Producer<Returned>, what: Returned) {
    if let Err(rtrb::PushError::Full(what)) = returned.push(what) {
        std::mem::forget(what);
    }
}
