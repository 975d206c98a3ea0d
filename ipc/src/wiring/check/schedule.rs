//! Schedules: phases, groups, spinning and priorities that can be kept.
//!
//! Must never accept a creature in which a higher level can keep a lower one from its beats.

use std::collections::{BTreeMap, HashMap};
use std::ops::Range;

use super::{Checker, Draft, FILE_LAYERS_MAX};
use crate::clock::Span;
use crate::wiring::creature::{Executor, Policy, Wake, rate_monotonic};
use crate::wiring::read::RawExecutor;
use crate::wiring::rule::Rule;

/// Largest share of one processor that may be spent spinning, if the file does not say.
const SPIN_SHARE: f64 = 0.2;

impl Checker<'_> {
    pub(super) fn executor(&mut self, raw: &RawExecutor, drafts: &[Draft<'_, '_>]) -> Executor {
        let deadline = raw.policy.as_ref().is_some_and(|p| p.value == 1);
        if deadline {
            for draft in drafts {
                self.under_deadline(draft);
            }
        }
        let share = raw.spin_share_max.as_ref().map_or(SPIN_SHARE, |s| s.value);
        self.spin_share(share, drafts);
        Executor {
            policy: if deadline { Policy::Deadline } else { Policy::Fifo },
            best_effort: raw.best_effort.as_ref().is_none_or(|b| b.value == 0),
            spin_share_max: share,
        }
    }

    fn under_deadline(&mut self, draft: &Draft<'_, '_>) {
        let priority = draft.raw.priority.as_ref().map(|p| ("priority", p.at.clone()));
        let cpu = draft.raw.cpu.as_ref().map(|c| ("cpu", c.at.clone()));
        for (key, at) in priority.into_iter().chain(cpu) {
            let message = format!("a layer under policy \"deadline\" has no {key:?}");
            let help = match key {
                "cpu" => "the host refuses SCHED_DEADLINE to threads bound to a processor: remove this",
                _ => "SCHED_DEADLINE goes by periods: remove this, or use policy = \"fifo\"",
            };
            self.findings.refuse(Rule::DeadlinePolicy, at, message, help);
        }
    }

    pub(super) fn schedule(&mut self, drafts: &[Draft<'_, '_>]) {
        for draft in drafts {
            self.phase(draft);
            self.spin(draft);
        }
        self.groups(drafts);
        self.priorities(&drafts[..drafts.len().min(FILE_LAYERS_MAX)]);
    }

    fn phase(&mut self, draft: &Draft<'_, '_>) {
        let (Some(phase), Some(period)) = (&draft.raw.phase, draft.raw.period) else {
            return;
        };
        if phase.value >= period {
            let message = format!(
                "the phase {} is not shorter than the period {period}",
                phase.value
            );
            let help = format!("expected a time shorter than {period}");
            self.findings
                .refuse(Rule::PhaseTooLong, phase.at.clone(), message, help);
        }
    }

    fn spin(&mut self, draft: &Draft<'_, '_>) {
        let at = draft.raw.spin.as_ref().map(|s| s.at.clone());
        let Wake::Spin(spin) = draft.layer.wake else {
            if let Some(at) = at {
                let help = "add wake = \"spin\", or remove this";
                let message = "spin is given, but the layer sleeps until its beat";
                self.findings.refuse(Rule::BadSpin, at, message, help);
            }
            return;
        };
        if let Some(period) = draft.raw.period.filter(|p| spin >= *p) {
            let message = format!("spinning {spin} before each beat takes the whole period of {period}");
            let help = "expected a time much shorter than the period";
            self.findings
                .refuse(Rule::BadSpin, at.unwrap_or(draft.raw.at.clone()), message, help);
        }
    }

    fn groups(&mut self, drafts: &[Draft<'_, '_>]) {
        let mut first: HashMap<&str, &Draft<'_, '_>> = HashMap::new();
        for draft in drafts {
            let Some(group) = &draft.raw.group else { continue };
            let other = *first.entry(&group.value).or_insert(draft);
            let (a, b) = (&other.layer, &draft.layer);
            let differs = [
                ("period", a.period != b.period),
                ("phase", a.phase != b.phase),
                ("priority", a.priority != b.priority),
                ("cpu", a.cpu != b.cpu),
                ("wake", a.wake != b.wake),
            ];
            let whole = draft.raw.period.is_some() && other.raw.period.is_some();
            for (key, _) in differs.iter().filter(|(_, differs)| *differs && whole) {
                let message = format!("layer {:?} differs from its group in {key:?}", b.name);
                let help = format!(
                    "layers of one group share a thread: expected the same {key} as in layer {:?}",
                    a.name
                );
                let place = other
                    .raw
                    .group
                    .as_ref()
                    .map_or(other.raw.at.clone(), |g| g.at.clone());
                let also = (place, "the group begins here".into());
                self.findings
                    .refuse_both(Rule::GroupDiffers, group.at.clone(), message, help, also);
            }
        }
    }

    /// A lower level must not wait for a higher one that beats no faster. Where the higher one beats faster,
    /// rate-monotonic scheduling gives it the higher priority and both keep their beats.
    fn priorities(&mut self, drafts: &[Draft<'_, '_>]) {
        let mut periods: Vec<Span> = drafts.iter().map(|d| d.layer.period).collect();
        periods.sort_unstable();
        periods.dedup();
        let of = |d: &Draft<'_, '_>| {
            let monotonic = rate_monotonic(&periods, d.layer.period);
            d.layer.priority.unwrap_or(monotonic)
        };
        let apart = |a: Option<usize>, b: Option<usize>| matches!((a, b), (Some(a), Some(b)) if a != b);
        for low in drafts {
            let over = drafts.iter().find(|high| {
                high.layer.level > low.layer.level
                    && low.layer.period <= high.layer.period
                    && of(low) < of(high)
                    && (low.layer.priority.is_some() || high.layer.priority.is_some())
                    && !apart(low.layer.cpu, high.layer.cpu)
            });
            let whole = |d: &Draft<'_, '_>| d.raw.period.is_some() && d.raw.level.is_some();
            let Some(high) = over.filter(|high| whole(low) && whole(high)) else {
                continue;
            };
            let place = |d: &Draft<'_, '_>| d.raw.priority.as_ref().map(|p| p.at.clone());
            let stands = |d: &Draft<'_, '_>| match d.layer.priority {
                Some(given) => format!("priority {given}"),
                None => format!("priority {} (rate-monotonic)", of(d)),
            };
            let (l, h) = (&low.layer, &high.layer);
            let message = format!(
                "layer {:?} of level {} has {}, below {:?} of level {} with {}",
                l.name,
                l.level,
                stands(low),
                h.name,
                h.level,
                stands(high)
            );
            let help = "a lower level never waits for a higher one that beats no faster: \
                        raise the one or lower the other, or leave both priorities out";
            let at: Range<usize> = place(low).or(place(high)).unwrap_or(low.raw.at.clone());
            self.findings.refuse(Rule::PriorityInversion, at, message, help);
        }
    }

    /// Threads that may run anywhere count for every processor.
    fn spin_share(&mut self, most: f64, drafts: &[Draft<'_, '_>]) {
        let mut groups: HashMap<&str, ()> = HashMap::new();
        let mut of_cpu: BTreeMap<Option<usize>, f64> = BTreeMap::new();
        let mut unbound = 0.0;
        let mut last = None;
        for draft in drafts.iter().filter(|d| d.raw.period.is_some()) {
            let layer = &draft.layer;
            let Wake::Spin(spin) = layer.wake else { continue };
            let shared = layer
                .group
                .as_deref()
                .is_some_and(|g| groups.insert(g, ()).is_some());
            if shared || spin >= layer.period {
                continue;
            }
            let share = spin.seconds() / layer.period.seconds();
            match layer.cpu {
                Some(_) => *of_cpu.entry(layer.cpu).or_default() += share,
                None => unbound += share,
            }
            last = Some(draft);
        }
        of_cpu.entry(None).or_default();
        let worst = of_cpu
            .iter()
            .map(|(cpu, share)| (share + unbound, *cpu))
            .max_by(|a, b| a.0.total_cmp(&b.0));
        let (Some((share, cpu)), Some(draft)) = (worst, last) else {
            return;
        };
        if share <= most {
            return;
        }
        let where_ = cpu.map_or("one processor".into(), |cpu| format!("processor {cpu}"));
        let message = format!("layers spin for {:.0} % of {where_}", share * 100.0);
        let help = format!(
            "expected at most {:.0} %: spin shorter, let slow layers sleep, or raise spin_share_max in [executor]",
            most * 100.0
        );
        let at = draft
            .raw
            .spin
            .as_ref()
            .map_or(draft.raw.at.clone(), |s| s.at.clone());
        self.findings.refuse(Rule::SpinShare, at, message, help);
    }
}
