//! Why SCHED_FIFO was refused here: what of this process's standing explains it.
//!
//! Must never guess: each reason is read from /proc, and where none is found none is given.

/// Number of CAP_SYS_NICE, as in capabilities(7).
const SYS_NICE: u32 = 23;

/// The user and group map of whoever is in no user namespace.
const EVERYBODY: [&str; 3] = ["0", "0", "4294967295"];

/// What was found, for the end of a sentence; empty if nothing was.
pub(super) fn found() -> String {
    let text = |path| std::fs::read_to_string(path).unwrap_or_default();
    let standing = Standing {
        status: text("/proc/self/status"),
        uid_map: text("/proc/self/uid_map"),
        cgroup: text("/proc/self/cgroup"),
    };
    match standing.reasons() {
        none if none.is_empty() => String::new(),
        reasons => format!("; found here: {}", reasons.join(", and ")),
    }
}

/// Files of /proc/self that bear on real-time scheduling.
#[derive(Debug, Default)]
struct Standing {
    status: String,
    uid_map: String,
    cgroup: String,
}

impl Standing {
    fn reasons(&self) -> Vec<String> {
        let mut reasons = Vec::new();
        if !self.uid_map.is_empty() && !self.uid_map.split_whitespace().eq(EVERYBODY) {
            let why =
                "a user namespace (PrivateUsers=, a container), in which no capability counts for scheduling";
            reasons.push(why.into());
        }
        if self.effective().is_some_and(|set| set & (1 << SYS_NICE) == 0) {
            reasons.push("no CAP_SYS_NICE (AmbientCapabilities= of the unit)".into());
        }
        if let Some(group) = self.cpu_group() {
            reasons.push(format!(
                "the cpu control group {group}, which has no share of real time under RT_GROUP_SCHED (CPUWeight=, \
                 CPUQuota= and the like, of this unit or of another one in its slice)"
            ));
        }
        // Every hardened unit has a filter: it explains only what nothing else does.
        if reasons.is_empty() && self.field("Seccomp:") == Some("2") {
            reasons.push("a system call filter (RestrictRealtime=, SystemCallFilter=~@resources)".into());
        }
        reasons
    }

    fn field(&self, name: &str) -> Option<&str> {
        self.status
            .lines()
            .find_map(|line| line.strip_prefix(name))
            .map(str::trim)
    }

    fn effective(&self) -> Option<u64> {
        u64::from_str_radix(self.field("CapEff:")?, 16).ok()
    }

    /// The group below the root that the cpu controller of the first layout keeps this process in. Under the unified
    /// layout a group's path does not tell which controllers it has.
    fn cpu_group(&self) -> Option<&str> {
        let groups = self
            .cgroup
            .lines()
            .filter_map(|line| line.split_once(':')?.1.split_once(':'));
        let cpu = groups.filter(|(controllers, _)| controllers.split(',').any(|c| c == "cpu"));
        cpu.map(|(_, path)| path).find(|path| *path != "/")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reasons(status: &str, uid_map: &str, cgroup: &str) -> String {
        let (status, uid_map, cgroup) = (status.into(), uid_map.into(), cgroup.into());
        let standing = Standing {
            status,
            uid_map,
            cgroup,
        };
        standing.reasons().join(", and ")
    }

    const GRANTED: &str = "Name:\tsubsumed\nCapEff:\t0000000000804000\nSeccomp:\t2\n";
    const WHOLE: &str = "         0          0 4294967295\n";
    const OUTSIDE: &str = "7:cpuset:/x\n1:name=systemd:/system.slice/a.service\n2:cpu,cpuacct:/\n0::/\n";

    #[test]
    fn each_reason_is_read_from_its_file() {
        let part = "         0          0          1\n       994        994          1\n";
        assert!(reasons(GRANTED, part, OUTSIDE).starts_with("a user namespace"));
        let less = GRANTED.replace("804000", "004000");
        assert!(reasons(&less, WHOLE, OUTSIDE).starts_with("no CAP_SYS_NICE"));
        let inside = OUTSIDE.replace("cpuacct:/", "cpuacct:/system.slice/a.service");
        assert!(
            reasons(GRANTED, WHOLE, &inside).starts_with("the cpu control group /system.slice/a.service")
        );
        assert!(reasons(&less, part, &inside).matches(", and ").count() == 2);
    }

    #[test]
    fn a_filter_explains_only_what_nothing_else_does_and_an_empty_proc_nothing() {
        assert!(reasons(GRANTED, WHOLE, OUTSIDE).starts_with("a system call filter"));
        assert_eq!(
            reasons(&GRANTED.replace("Seccomp:\t2", "Seccomp:\t0"), WHOLE, OUTSIDE),
            ""
        );
        assert_eq!(reasons("", "", ""), "");
    }
}
