//! The kernel: how soon it lets go of a processor, what it keeps back from real-time threads, its clock.
//!
//! Must never take a typical bound for a proven one; what it says of a preemption model is what ordinary hardware
//! shows, to be measured where it matters.

use std::io::Read as _;

use ipc::clock::Span;

use super::{Bearing, Finding, text};

/// Looks at the kernel.
pub(super) fn look(period: Option<Span>) -> Vec<Finding> {
    let mut findings = vec![preemption(period)];
    findings.extend(throttling());
    findings.push(clock_source());
    findings
}

/// A preemption model, and the longest that a wake-up is typically held up under load on ordinary hardware.
const MODELS: [(&str, Span); 5] = [
    ("rt", Span::micros(150)),
    ("full", Span::millis(2)),
    ("lazy", Span::millis(5)),
    ("voluntary", Span::millis(10)),
    ("none", Span::millis(20)),
];

/// The shortest period that a model can keep is as long as its longest typical delay.
fn preemption(period: Option<Span>) -> Finding {
    let Some((model, from)) = model() else {
        return Finding::new(
            "preemption",
            "unknown",
            Bearing::Note,
            "neither /sys/kernel nor the kernel's configuration could be read",
        );
    };
    let held = MODELS
        .iter()
        .find(|(name, _)| *name == model)
        .map_or(Span::millis(20), |(_, held)| *held);
    let bearing = match period {
        Some(period) if period < held => Bearing::Bad,
        _ if model == "rt" => Bearing::Good,
        _ => Bearing::Note,
    };
    let means = format!(
        "under load a wake-up may typically be held up for {held}, so periods from {held} on can be kept; not a proven bound"
    );
    let finding = Finding::new("preemption", format!("{model} ({from})"), bearing, means);
    match model.as_str() {
        "rt" => finding,
        _ => finding.change(
            "a kernel with PREEMPT_RT (Debian: apt-get install linux-image-rt-amd64),\n\
             or preempt=full on the kernel's command line if it says PREEMPT_DYNAMIC",
        ),
    }
}

/// The preemption model in force, and where that was read.
fn model() -> Option<(String, &'static str)> {
    let uname = rustix::system::uname();
    let version = uname.version().to_string_lossy();
    if version.contains("PREEMPT_RT") || text("/sys/kernel/realtime").as_deref() == Some("1") {
        return Some(("rt".into(), "uname -v"));
    }
    if let Some(models) = text("/sys/kernel/debug/sched/preempt") {
        let chosen = models
            .split_whitespace()
            .find_map(|m| m.strip_prefix('(')?.strip_suffix(')'));
        return chosen.map(|m| (m.to_string(), "/sys/kernel/debug/sched/preempt"));
    }
    let line = text("/proc/cmdline").unwrap_or_default();
    if let Some(chosen) = line.split_whitespace().find_map(|w| w.strip_prefix("preempt=")) {
        return Some((chosen.to_string(), "the kernel's command line"));
    }
    let config = configuration()?;
    let set = |option: &str| config.lines().any(|l| l == format!("{option}=y"));
    let model = [
        ("CONFIG_PREEMPT_LAZY", "lazy"),
        ("CONFIG_PREEMPT_VOLUNTARY", "voluntary"),
        ("CONFIG_PREEMPT_NONE", "none"),
        ("CONFIG_PREEMPT", "full"),
    ];
    let found = model.iter().find(|(option, _)| set(option))?.1;
    Some((found.to_string(), "the kernel's configuration"))
}

/// The configuration that the kernel was built with, where it can be read.
pub(super) fn configuration() -> Option<String> {
    let release = rustix::system::uname().release().to_string_lossy().into_owned();
    if let Some(config) = text(&format!("/boot/config-{release}")) {
        return Some(config);
    }
    let packed = std::fs::File::open("/proc/config.gz").ok()?;
    let mut config = String::new();
    flate2::read::GzDecoder::new(packed)
        .read_to_string(&mut config)
        .ok()?;
    Some(config)
}

/// Throttling of real-time threads, for the whole host and for control groups.
fn throttling() -> Vec<Finding> {
    let number = |name: &str| text(&format!("/proc/sys/kernel/{name}")).and_then(|t| t.parse::<i64>().ok());
    let mut findings = Vec::new();
    findings.push(match (number("sched_rt_runtime_us"), number("sched_rt_period_us")) {
        (Some(-1), _) => Finding::new(
            "RT throttling",
            "off",
            Bearing::Note,
            "a runaway real-time thread owns its processor for good; the daemon bounds its own by RLIMIT_RTTIME",
        ),
        (Some(runtime), Some(period)) => Finding::new(
            "RT throttling",
            format!("{runtime} of {period} us"),
            Bearing::Good,
            "real-time threads together may take that much; a creature that needs more is overloaded",
        ),
        _ => Finding::new("RT throttling", "unknown", Bearing::Note, "/proc/sys/kernel/sched_rt_runtime_us cannot be read"),
    });
    let grouped = configuration().map(|c| c.lines().any(|l| l == "CONFIG_RT_GROUP_SCHED=y"));
    findings.push(match grouped {
        Some(false) => Finding::new("RT_GROUP_SCHED", "off", Bearing::Good, ""),
        Some(true) => Finding::new(
            "RT_GROUP_SCHED",
            "on",
            Bearing::Note,
            "a unit under the cpu controller cannot have SCHED_FIFO, whatever its capabilities (EPERM), as long as \
             its cpu.rt_runtime_us is 0",
        )
        .change("leave CPUWeight=, CPUQuota= and CPUAccounting= out of the unit and its slices, or boot with rt_group_sched=0"),
        None => Finding::new("RT_GROUP_SCHED", "unknown", Bearing::Note, "the kernel's configuration cannot be read"),
    });
    findings
}

fn clock_source() -> Finding {
    let base = "/sys/devices/system/clocksource/clocksource0";
    let current = text(&format!("{base}/current_clocksource")).unwrap_or_else(|| "unknown".into());
    let quick = [
        "tsc",
        "kvm-clock",
        "hyperv_clocksource_tsc_page",
        "arch_sys_counter",
    ];
    if quick.contains(&current.as_str()) {
        return Finding::new("clock source", current, Bearing::Good, "");
    }
    let others = text(&format!("{base}/available_clocksource")).unwrap_or_default();
    let means =
        "reading it takes a system call or a slow device: a microsecond and more, several times a beat";
    let finding = Finding::new("clock source", current, Bearing::Note, means);
    match quick.iter().find(|q| others.split_whitespace().any(|o| o == **q)) {
        Some(better) => finding.change(format!("clocksource={better} on the kernel's command line")),
        None => finding,
    }
}
