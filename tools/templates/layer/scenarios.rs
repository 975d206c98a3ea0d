//! Runs the scenario files of this layer: what must come of it, on the virtual clock.

#[test]
fn scenarios_pass() {
    let kinds = scenario::kinds::kinds().with([&crate::@MODULE@::KIND]);
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios");
    let files = scenario::suite::find(&[folder.into()]).expect("the folder can be read");
    assert!(!files.is_empty(), "no scenario in {folder}");
    let scenarios = scenario::suite::read_all(&files, &kinds).unwrap_or_else(|wrong| {
        let wrong: Vec<String> = wrong.iter().map(ToString::to_string).collect();
        panic!("\n{}", wrong.join("\n\n"))
    });
    let how = scenario::run::How { shuffle: None };
    let verdicts: Vec<_> = scenarios
        .iter()
        .map(|one| scenario::suite::try_one(one, &kinds, how))
        .collect();
    let passed = verdicts.iter().all(scenario::suite::Verdict::passed);
    assert!(passed, "\n{}", scenario::report::text(&verdicts));
}
