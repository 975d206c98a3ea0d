//! Random creature files of up to twenty modules in up to five layers.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use proptest::prelude::*;

/// Modules of each layer; wires and taps as pairs of numbers that choose their ends.
pub(crate) fn creature() -> impl Strategy<Value = String> {
    let layers = prop::collection::vec(1..5_usize, 1..6);
    let links = |most| prop::collection::vec((any::<u16>(), any::<u16>(), any::<u8>()), 0..most);
    (layers, links(40), links(10), 0..30_u8)
        .prop_map(|(layers, wires, taps, body)| write(&layers, &wires, &taps, body as usize))
}

fn write(layers: &[usize], wires: &[(u16, u16, u8)], taps: &[(u16, u16, u8)], body: usize) -> String {
    let levels: Vec<usize> = layers
        .iter()
        .enumerate()
        .flat_map(|(level, &count)| std::iter::repeat_n(level, count))
        .collect();
    let mut wired = vec![Vec::new(); layers.len()];
    let mut used = BTreeSet::new();
    for (k, &(from, to, port)) in wires.iter().enumerate() {
        let (from, to) = (from as usize % levels.len(), to as usize % levels.len());
        let sensed = (k * 7) % 30 < body && k % 4 == 0;
        let driven = (k * 5) % 30 < body && k % 5 == 1;
        let source = if sensed {
            format!("body.sensor{}", port % 4)
        } else {
            format!("m{from}.out{}", port % 3)
        };
        let input = match port / 16 {
            0 => "reset".to_string(),
            n => format!("in{}", n % 4),
        };
        let sink = if driven {
            format!("body.motor{k}")
        } else {
            format!("m{to}.{input}")
        };
        if used.insert(sink.clone()) {
            wired[levels[to]].push(format!("\"{source} -> {sink}\""));
        }
    }
    let mut suppress = vec![Vec::new(); layers.len()];
    let mut inhibit = vec![Vec::new(); layers.len()];
    for &(from, to, port) in taps {
        let (a, b) = (from as usize % levels.len(), to as usize % levels.len());
        let (high, low) = if levels[a] > levels[b] { (a, b) } else { (b, a) };
        if levels[high] == levels[low] {
            continue;
        }
        let from = format!("m{high}.out{}", port % 3);
        if port < 128 {
            let to = format!("m{low}.in{}", port % 4);
            suppress[levels[high]].push(tap(&from, "input", &to, port));
        } else {
            let to = format!("m{low}.out{}", port % 3);
            inhibit[levels[high]].push(tap(&from, "output", &to, port));
        }
    }
    let mut file = String::from("creature = \"random\"\n");
    for (level, _) in layers.iter().enumerate() {
        let _ = writeln!(
            file,
            "[[layer]]\nname = \"layer{level}\"\nlevel = {level}\nperiod = \"10ms\"\nwires = [{}]\nsuppress = [{}]\ninhibit = [{}]\n[layer.modules]",
            wired[level].join(", "),
            suppress[level].join(", "),
            inhibit[level].join(", ")
        );
        for m in (0..levels.len()).filter(|&m| levels[m] == level) {
            let _ = writeln!(file, "m{m} = {{ kind = \"any\" }}");
        }
    }
    file
}

fn tap(from: &str, key: &str, to: &str, port: u8) -> String {
    format!(
        "{{ from = \"{from}\", {key} = \"{to}\", time_constant = \"{}ms\" }}",
        10 * port as u32 + 10
    )
}
