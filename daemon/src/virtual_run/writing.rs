//! The second half of a moment: messages are written, the highest level first.
//!
//! Must never write a wire twice without the first message being taken in, nor leave one out of the log.

use ipc::clock::Time;
use ipc::message::Words;

use super::{Stimulus, VirtualRun, Which};
use crate::body;
use crate::machine::{Machine, Station};

impl VirtualRun {
    /// Messages of this moment are written, those put and those emitted, the highest level first.
    pub(super) fn commit(&mut self, stimuli: &[Stimulus]) {
        let t = self.now;
        let mut puts = Vec::new();
        for stimulus in stimuli {
            if let Stimulus::Put(name, words) = stimulus
                && let Some((which, output)) = self.output(name)
            {
                puts.push((which, output, words));
            }
        }
        for place in 0..self.order.len() {
            let which = self.order[place];
            let own = puts.iter().filter(|(w, ..)| *w == Some(which));
            let own: Vec<(usize, &Words)> = own.map(|(_, output, words)| (*output, *words)).collect();
            self.write(which, &own);
        }
        let sensors = puts.iter().filter(|(which, ..)| which.is_none());
        let mut written = Vec::new();
        for (_, index, words) in sensors {
            if written.contains(index) {
                self.look(|_| true);
            }
            if let Some(body) = &mut self.machine.body {
                body.motor.put(*index, t, words);
                written.push(*index);
            }
            if let Some(log) = &mut self.log {
                log.scan(*index);
            }
        }
        self.act(&written);
        let guests = self.guests.here.iter_mut().map(|g| &mut g.hand);
        for hand in self.machine.hands.iter_mut().chain(guests) {
            while hand.returned.pop().is_ok() {}
        }
    }

    /// The layer `which` writes what is put on its wires and, if it is due, what it staged. Where a wire carries
    /// several messages at this one moment, every other wire of the layer is written before the first of them
    /// is taken in, and that before the next is written.
    fn write(&mut self, which: Which, puts: &[(usize, &Words)]) {
        let t = self.now;
        let due = self.due_of(which) == Some(t);
        if puts.is_empty() {
            if due {
                self.station(which).running.commit(t);
                self.scan_all(which);
            }
        } else {
            self.write_in_rounds(which, puts, due);
        }
        if due {
            let station = self.station(which);
            station.gauge.beat(t);
            let next = Some(t + station.spec.period);
            match which {
                Which::Own(index) => self.due[index] = next,
                Which::Guest(index) => self.guests.here[index].due = next,
            }
        }
    }

    fn write_in_rounds(&mut self, which: Which, puts: &[(usize, &Words)], due: bool) {
        let t = self.now;
        let outputs = self.station(which).running.outputs();
        let on = |output: usize| puts.iter().filter(move |(o, _)| *o == output);
        let rounds = (0..outputs).map(|o| on(o).count()).max().unwrap_or(0);
        for round in 0..=rounds {
            let running = &self.station(which).running;
            let staged = |o: usize| due && on(o).count() == round && running.outlet(o).is_staged();
            let speaks = |o: &usize| on(*o).count() > round || staged(*o);
            let speaking: Vec<usize> = (0..outputs).filter(speaks).collect();
            if round > 0 && !speaking.is_empty() {
                self.look(|_| true);
            }
            for output in speaking {
                let running = &mut self.station(which).running;
                let wrote = match on(output).nth(round) {
                    Some((_, words)) => running.put(output, t, words),
                    None => running.commit_one(output, t),
                };
                if wrote {
                    self.scan(which, output);
                }
            }
        }
    }

    fn scan_all(&mut self, which: Which) {
        if self.log.is_some() {
            for output in 0..self.station(which).running.outputs() {
                self.scan(which, output);
            }
        }
    }

    /// The motor unit acts and the world ticks, if they are due. Sensors of which a message was put at this
    /// moment are taken in before.
    fn act(&mut self, put: &[usize]) {
        let t = self.now;
        if self.machine.body.is_none() || self.body_due != t {
            return;
        }
        if !put.is_empty() {
            self.look(|_| true);
        }
        let Machine { body, watchdog, .. } = &mut self.machine;
        let Some(body) = body else {
            return;
        };
        watchdog.look(t);
        watchdog.channel.watchdog.beat(t);
        body.motor.act(t);
        body.gauge.beat(t);
        body::turn(body.world.as_mut(), &mut body.link, || t);
        self.body_due = t + body.motor.period();
        if let Some(log) = &mut self.log {
            (0..body.motor.declaration().outputs.len()).for_each(|index| log.scan(index));
        }
    }

    fn station(&mut self, which: Which) -> &mut Station {
        match which {
            Which::Own(index) => &mut self.machine.stations[index],
            Which::Guest(index) => &mut self.guests.here[index].station,
        }
    }

    fn due_of(&self, which: Which) -> Option<Time> {
        match which {
            Which::Own(index) => self.due[index],
            Which::Guest(index) => self.guests.here[index].due,
        }
    }

    /// Takes a wire's newest message into the log.
    fn scan(&mut self, which: Which, output: usize) {
        let Some(log) = &mut self.log else { return };
        log.scan(match which {
            Which::Own(index) => self.first[index] + output,
            Which::Guest(index) => self.guests.here[index].logged[output],
        });
    }

    /// Where the output port called `name` is found, if its layer is here: `None` stands for the body.
    fn output(&self, name: &str) -> Option<(Option<Which>, usize)> {
        if let Some((station, output)) = self.guests.policy.output(name) {
            return Some((Some(Which::Own(station)), output));
        }
        let (module, port) = name.split_once('.')?;
        if module == ipc::wiring::BODY {
            let body = self.machine.body.as_ref()?;
            return Some((None, body.motor.declaration().output(port)?.0));
        }
        self.guests.here.iter().enumerate().find_map(|(index, guest)| {
            let output = guest.plug.outputs.iter().position(|o| o.name == name)?;
            Some((Some(Which::Guest(index)), output))
        })
    }
}
