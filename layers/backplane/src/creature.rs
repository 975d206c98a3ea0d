//! What a creature brings: its body, its primitive actions, and what they come to.

/// A creature that acts in turns (Gantchev 2001, 3.1).
///
/// Implemented by a marker type; everything else in this crate is generic over it.
pub trait Creature: Sized + 'static {
    /// What layers sense and actions work on, for the length of one turn. In Truckin' it is the
    /// truck's controller, which borrows the world while the truck plays.
    type Body<'turn>;
    /// One primitive step.
    type Action: Action<Self>;
    /// What one action came to.
    type Outcome: Copy;

    /// Whether the time slot is used up. No further plan is asked for once it is.
    fn slot_is_used_up(body: &Self::Body<'_>) -> bool;
}

/// One primitive step available to the agent (Gantchev 2001, 3.2, *Action*).
///
/// Its cost in time, money and gas is the body's to charge: an action that cannot be paid for
/// comes back as an outcome that says so.
pub trait Action<C: Creature>: Copy {
    /// Gives effect to the action (the source's `doAction`).
    fn do_action(self, body: &mut C::Body<'_>) -> C::Outcome;
}
