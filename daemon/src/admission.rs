//! Admission: which users may speak to the daemon, by what the kernel says of them.
//!
//! The same user always may, and root, who could do everything to this process anyway. A creature file may
//! name further users and groups; what they can do is in `deploy/SECURITY.md`.
//!
//! Must never believe what a caller says of itself.

use ipc::control::Peer;
use ipc::wiring::creature::{Account, Outsiders};

/// Who may call.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Admission {
    /// Numbers of further users.
    pub users: Vec<u32>,
    /// Numbers of groups whose members may.
    pub groups: Vec<u32>,
}

impl Admission {
    /// Whom a creature file names.
    ///
    /// # Errors
    /// Every user or group that this host does not know.
    pub fn of(outsiders: &Outsiders) -> Result<Admission, String> {
        let mut unknown = Vec::new();
        let mut numbers = |accounts: &[Account], what: &str, file: &str| -> Vec<u32> {
            let known = std::fs::read_to_string(file).unwrap_or_default();
            let number = |account: &Account| match account {
                Account::Id(id) => Some(*id),
                Account::Name(name) => listed(&known, name),
            };
            let found = accounts.iter().filter_map(|account| {
                let found = number(account);
                if found.is_none() {
                    unknown.push(format!(
                        "this host has no {what} {:?} (see {file})",
                        account.to_string()
                    ));
                }
                found
            });
            found.collect()
        };
        let admission = Admission {
            users: numbers(&outsiders.users, "user", "/etc/passwd"),
            groups: numbers(&outsiders.groups, "group", "/etc/group"),
        };
        if unknown.is_empty() {
            Ok(admission)
        } else {
            Err(format!("[outsiders]: {}", unknown.join("; ")))
        }
    }

    /// Whether `peer` may call.
    pub fn admits(&self, peer: Peer) -> bool {
        peer.is_us() || self.users.contains(&peer.user) || self.is_member(peer)
    }

    /// By the group the kernel names, or the supplementary ones of the process as it stands now.
    fn is_member(&self, peer: Peer) -> bool {
        if self.groups.is_empty() {
            return false;
        }
        self.groups.contains(&peer.group)
            || supplementary(peer.pid)
                .iter()
                .any(|group| self.groups.contains(group))
    }

    /// The mode of the control socket: nobody else can even connect who need not.
    pub fn socket_mode(&self) -> u32 {
        if self.users.is_empty() && self.groups.is_empty() {
            0o600
        } else {
            0o666
        }
    }
}

/// The number of `name` in a file of the form of `/etc/passwd` and `/etc/group`.
fn listed(file: &str, name: &str) -> Option<u32> {
    let fields = file.lines().map(|line| line.split(':').collect::<Vec<_>>());
    let mut named = fields.filter(|fields| fields.first() == Some(&name));
    named.find_map(|fields| fields.get(2)?.parse().ok())
}

/// Supplementary groups of a process; none if it is gone.
fn supplementary(pid: i32) -> Vec<u32> {
    let status = std::fs::read_to_string(format!("/proc/{pid}/status")).unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("Groups:"));
    let groups = line.into_iter().flat_map(str::split_whitespace);
    groups.filter_map(|group| group.parse().ok()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn peer(user: u32, group: u32) -> Peer {
        Peer {
            pid: std::process::id() as i32,
            user,
            group,
        }
    }

    #[test]
    fn by_default_the_same_user_and_root_only() {
        let admission = Admission::default();
        let us = rustix::process::geteuid().as_raw();
        assert!(admission.admits(peer(us, 12_345)) && admission.admits(peer(0, 0)));
        assert!(!admission.admits(peer(us + 54_321, 0)));
        assert_eq!(admission.socket_mode(), 0o600);
    }

    #[test]
    fn names_are_looked_up_and_unknown_ones_refused_together() {
        let mut outsiders = Outsiders {
            read: ipc::wiring::creature::Reads::All,
            tap: Vec::new(),
            users: vec![Account::Name("root".into()), Account::Id(1234)],
            groups: vec![Account::Name("root".into())],
            layers_max: 1,
            level_max: 1,
            time_constant_min: ipc::clock::Span::ZERO,
            time_constant_max: ipc::clock::Span::ZERO,
            messages_max: 1,
        };
        let admission = Admission::of(&outsiders).expect("every host knows root");
        assert_eq!((admission.users, admission.groups), (vec![0, 1234], vec![0]));
        outsiders.users.push(Account::Name("nobody-of-that-name".into()));
        outsiders.groups.push(Account::Name("no-such-group".into()));
        let refusal = Admission::of(&outsiders).expect_err("they are unknown");
        assert!(
            refusal.contains("nobody-of-that-name") && refusal.contains("no-such-group"),
            "{refusal}"
        );
    }

    #[test]
    fn named_users_and_members_of_named_groups_too() {
        let us = rustix::process::geteuid().as_raw();
        let admission = Admission {
            users: vec![us + 1],
            groups: vec![77_777],
        };
        assert!(admission.admits(peer(us + 1, 5)) && admission.admits(peer(us + 2, 77_777)));
        assert!(!admission.admits(peer(us + 2, 5)));
    }
}
