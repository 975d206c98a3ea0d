//! The processors: how many, how fast, how deep they sleep, which are kept free for us.
//!
//! Must never set a governor or an idle state: that is the host's owner's to do.

use ipc::clock::Span;

use super::{Bearing, Finding, text};

/// Looks at the processors.
pub(super) fn look(period: Option<Span>) -> Vec<Finding> {
    vec![number(), isolated(), frequency(), idle(period)]
}

fn number() -> Finding {
    let cpus = daemon::executor::host::processors();
    let found = format!("{} for this process: {cpus:?}", cpus.len());
    match cpus.len() {
        1 => Finding::new(
            "processors",
            found,
            Bearing::Note,
            "layers, watchers and whatever else runs share one: a creature that takes more than part of it starves the rest",
        ),
        _ => Finding::new("processors", found, Bearing::Good, ""),
    }
}

fn isolated() -> Finding {
    match text("/sys/devices/system/cpu/isolated").filter(|t| !t.is_empty()) {
        Some(cpus) => Finding::new("isolated processors", cpus, Bearing::Good, "bind layers there with cpu = N"),
        None => Finding::new(
            "isolated processors",
            "none",
            Bearing::Note,
            "other programs run, and interrupts arrive, on the layers' processors",
        )
        .change("isolcpus=managed_irq,domain,N nohz_full=N rcu_nocbs=N on the kernel's command line, and cpu = N in the layers"),
    }
}

fn frequency() -> Finding {
    let mut governors: Vec<String> = numbered("/sys/devices/system/cpu/cpufreq", "policy")
        .iter()
        .filter_map(|policy| text(&format!("{policy}/scaling_governor")))
        .collect();
    governors.sort();
    governors.dedup();
    match &governors[..] {
        [] => Finding::new(
            "frequency",
            "not ours to set",
            Bearing::Good,
            "no cpufreq: fixed, or the hypervisor's",
        ),
        [only] if only == "performance" => Finding::new("frequency", "performance", Bearing::Good, ""),
        others => Finding::new(
            "frequency",
            others.join(", "),
            Bearing::Note,
            "a processor that slowed down takes longer for the first steps after a pause",
        )
        .change("cpupower frequency-set -g performance"),
    }
}

/// Idle states that take longer to leave than a tenth of the period, or than 100 µs.
fn idle(period: Option<Span>) -> Finding {
    let slow_from = period.map_or(100, |p| p.0 / 10_000).max(1);
    let states: Vec<(String, u64)> = numbered("/sys/devices/system/cpu/cpu0/cpuidle", "state")
        .iter()
        .filter(|state| text(&format!("{state}/disable")).as_deref() != Some("1"))
        .filter_map(|state| {
            let latency = text(&format!("{state}/latency"))?.parse().ok()?;
            Some((text(&format!("{state}/name"))?, latency))
        })
        .collect();
    let found = match states.is_empty() {
        true => "none the kernel knows of".to_string(),
        false => states
            .iter()
            .map(|(name, us)| format!("{name} {us} us"))
            .collect::<Vec<_>>()
            .join(", "),
    };
    match states.iter().any(|(_, us)| *us > slow_from) {
        false => Finding::new("idle states", found, Bearing::Good, ""),
        true => Finding::new(
            "idle states",
            found,
            Bearing::Note,
            format!("some take longer than {slow_from} us to leave, and every beat after a pause is that much late"),
        )
        .change("cpupower idle-set -D 10, or wake = \"spin\" for the layers that need it"),
    }
}

/// The folders `prefix0`, `prefix1`, … in `folder`.
fn numbered(folder: &str, prefix: &str) -> Vec<String> {
    let mut found: Vec<String> = std::fs::read_dir(folder)
        .into_iter()
        .flatten()
        .flatten()
        .filter(|e| {
            e.file_name()
                .to_string_lossy()
                .strip_prefix(prefix)
                .is_some_and(|n| n.parse::<u32>().is_ok())
        })
        .map(|e| e.path().display().to_string())
        .collect();
    found.sort();
    found
}
