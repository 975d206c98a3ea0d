//! The example alert rules, held against what is really served: a rule about a name that is not there never fires.
//!
//! Must never be more than a test.

use std::collections::BTreeSet;

use serde_json::json;

use crate::gate::Causes;

const RULES: &str = include_str!("../../../deploy/prometheus/subsumed-alerts.yml");
const TABLE: &str = include_str!("../../../deploy/prometheus/metrics.md");

/// Words of `text` that begin with `subsumed_` and are followed by nothing that belongs to a name.
fn names(text: &str) -> BTreeSet<String> {
    let part = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let words = text.split(|c| !part(c));
    words
        .filter(|word| word.starts_with("subsumed_"))
        .map(Into::into)
        .collect()
}

/// Families of a scrape.
fn families() -> BTreeSet<String> {
    let text = super::text(&json!({"creature": "allen"}));
    let types = text.lines().filter_map(|line| line.strip_prefix("# TYPE "));
    types
        .filter_map(|line| line.split(' ').next().map(Into::into))
        .collect()
}

#[test]
fn every_rule_is_about_something_that_is_served() {
    let (families, rules) = (families(), RULES.lines().filter(|l| l.contains("expr:")));
    let mut seen = 0;
    for name in rules.flat_map(names) {
        let family = ["_total", "_bucket", "_count", "_sum"]
            .iter()
            .find_map(|suffix| name.strip_suffix(suffix))
            .unwrap_or(&name);
        assert!(families.contains(family), "{name} is not served");
        seen += 1;
    }
    assert!(seen >= 5, "rules were read: {seen}");
}

#[test]
fn every_cause_in_a_rule_is_one_and_every_fault_is_in_it() {
    let rule = RULES
        .split("cause=~\"")
        .nth(1)
        .and_then(|rest| rest.split('"').next());
    let named: BTreeSet<&str> = rule.expect("a rule tells causes apart").split('|').collect();
    let ordinary = ["start", "reflex", "emergency stop", "shutdown"];
    let faults: BTreeSet<&str> = Causes::named()
        .map(|(_, name)| name)
        .filter(|name| !ordinary.contains(name))
        .collect();
    assert_eq!(named, faults);
}

#[test]
fn what_never_was_is_a_plain_nought() {
    let text = super::text(&json!({"creature": "allen", "layers": [{"name": "avoid"}]}));
    assert!(text.contains("cause=\"emergency stop\"} 0\n"), "{text}");
    assert!(!text.contains("} -0\n"), "{text}");
}

#[test]
fn every_family_stands_in_the_table() {
    let told = TABLE.replace("`, `_", "` `subsumed_tap_");
    for family in families() {
        assert!(
            told.contains(&format!("`{family}`")),
            "{family} is not in metrics.md"
        );
    }
}
