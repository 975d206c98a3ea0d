//! Files that nobody would write: mutated, spliced, cut, repeated, nested. No panic, and bounded work.
//!
//! The same entry points as the targets in `fuzz/`, with a seed of their own: the run is the same every time.

use ipc::wiring::{Directory, Source, check};

use crate::golden::{files, folder, host};
use crate::kinds::Kinds;

/// Longest text that is tried.
const TEXT_MAX: usize = 1 << 20;

/// How many texts the mutator makes.
const ROUNDS: usize = 3_000;

/// A small generator (xorshift64*): which texts are tried is part of the test.
pub(crate) struct Dice(pub(crate) u64);

impl Dice {
    pub(crate) fn roll(&mut self, sides: usize) -> usize {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 33) as usize % sides.max(1)
    }
}

fn seeds() -> Vec<Vec<u8>> {
    let folders = ["good", "bad", "bad/manifests"];
    let paths = folders.iter().flat_map(|f| files(&folder(f)));
    paths
        .map(|p| std::fs::read(p).expect("the file can be read"))
        .collect()
}

fn mutate(dice: &mut Dice, seeds: &[Vec<u8>]) -> Vec<u8> {
    let mut text = seeds[dice.roll(seeds.len())].clone();
    for _ in 0..=dice.roll(4) {
        let at = dice.roll(text.len() + 1);
        let to = at + dice.roll(40.min(text.len() - at + 1));
        match dice.roll(7) {
            0 => text
                .iter_mut()
                .skip(at)
                .take(1)
                .for_each(|b| *b ^= 1 << dice.roll(8)),
            1 => text.truncate(at),
            2 => drop(text.drain(at..to)),
            3 => {
                let other = &seeds[dice.roll(seeds.len())];
                let from = dice.roll(other.len() + 1);
                let end = from + dice.roll(other.len() - from + 1);
                text.splice(at..to, other[from..end].iter().copied());
            }
            4 => {
                let piece = text[at..to].to_vec();
                let again = dice.roll(200);
                text.splice(at..at, piece.repeat(again));
            }
            5 => {
                let signs: [&[u8]; 8] = [b"\"", b"[", b"{", b".", b"=", b"\n", b"->", b"'''"];
                let sign = signs[dice.roll(signs.len())];
                text.splice(at..at, sign.iter().copied());
            }
            _ => {
                let line = text[..at].iter().rposition(|b| *b == b'\n').map_or(0, |n| n + 1);
                let other = dice.roll(text.len() + 1);
                let piece = text[line..at].to_vec();
                text.splice(other..other, piece);
            }
        }
        text.truncate(TEXT_MAX);
    }
    text
}

/// Reads, checks and shows a text, as a creature file and as a manifest.
fn attempt(bytes: Vec<u8>, host: &Directory) {
    let source = match Source::from_bytes("fuzz.toml", bytes) {
        Ok(source) => source,
        Err(refused) => return assert!(!refused.to_string().is_empty()),
    };
    for refused in [
        check::creature(&source, &Kinds).err(),
        check::manifest(&source, &Kinds, host).err(),
    ]
    .into_iter()
    .flatten()
    {
        assert!(refused.count() > 0);
        assert_eq!(refused.located().len(), refused.diagnostics.len());
        assert!(refused.to_string().starts_with("error"));
    }
}

#[test]
fn no_mutation_of_a_file_makes_the_checker_panic() {
    let (seeds, host) = (seeds(), host());
    let mut dice = Dice(0x5eed);
    for _ in 0..ROUNDS {
        attempt(mutate(&mut dice, &seeds), &host);
    }
}

/// Texts of a megabyte that are cheap to write and could be dear to read.
fn large() -> Vec<(&'static str, String)> {
    let fill = |piece: &dyn Fn(usize) -> String| {
        let mut text = String::from("creature = \"large\"\n");
        let mut i = 0;
        while text.len() < TEXT_MAX {
            text.push_str(&piece(i));
            i += 1;
        }
        text
    };
    const LAYER: &str = "[[layer]]\nname = \"l\"\nlevel = 0\nperiod = \"1s\"\n";
    vec![
        ("lists", "[".repeat(TEXT_MAX)),
        ("a key of lists", format!("a = {}", "[".repeat(TEXT_MAX))),
        ("a key of tables", format!("a = {}", "{a=".repeat(TEXT_MAX / 3))),
        ("dots", format!("{}a = 1", "a.".repeat(TEXT_MAX / 2))),
        ("dots in a header", format!("[{}a]", "a.".repeat(TEXT_MAX / 2))),
        ("quotes", "\"".repeat(TEXT_MAX)),
        (
            "one long line",
            format!("creature = \"{}\"", "x".repeat(TEXT_MAX)),
        ),
        (
            "layers",
            fill(&|i| format!("[[layer]]\nname = \"l{i}\"\nlevel = 1\nperiod = \"1s\"\npriority = 5\n")),
        ),
        ("equal layers", fill(&|_| LAYER.into())),
        ("empty layers", fill(&|_| "[[layer]]\n".into())),
        ("equal tables", fill(&|_| "[body]\n".into())),
        ("equal keys", fill(&|_| "seed = 1\n".into())),
        ("unknown keys", fill(&|i| format!("k{i} = 1\n"))),
        ("unknown tables", fill(&|i| format!("[t{i}]\n"))),
        ("slips", fill(&|_| "seed = 1x\n".into())),
        (
            "modules",
            fill(&|i| {
                if i == 0 {
                    format!("{LAYER}[layer.modules]\n")
                } else {
                    format!("m{i}={{kind=\"and\"}}\n")
                }
            }),
        ),
        (
            "unknown kinds",
            fill(&|i| {
                if i == 0 {
                    format!("{LAYER}[layer.modules]\n")
                } else {
                    format!("m{i}={{kind=\"adn\"}}\n")
                }
            }),
        ),
        (
            "wires",
            format!(
                "creature = \"w\"\n{LAYER}wires = [{}]",
                "\"a.b->c.d\",".repeat(TEXT_MAX / 12)
            ),
        ),
        (
            "readers",
            format!(
                "creature = \"w\"\n{LAYER}wires = [\"a.b -> {}c.d\"]",
                "c.d,".repeat(TEXT_MAX / 4)
            ),
        ),
        ("a chain", chain()),
        (
            "taps",
            format!(
                "creature = \"w\"\n{LAYER}suppress = [{}]",
                "{from=\"a.b\"},".repeat(TEXT_MAX / 13)
            ),
        ),
        (
            "reflexes",
            format!("[halt]\nreflex = [{}]", "\"a.b\",".repeat(TEXT_MAX / 6)),
        ),
    ]
}

/// Eight thousand modules, each fed by the one before, the last one's wire going nowhere.
fn chain() -> String {
    let count = 8_000;
    let wires: String = (1..count)
        .map(|i| format!("\"m{}.value->m{i}.a\",\"m{}.value->m{i}.b\",", i - 1, i - 1))
        .collect();
    let modules: String = (0..count).map(|i| format!("m{i}={{kind=\"and\"}}\n")).collect();
    format!(
        "creature = \"c\"\n[[layer]]\nname = \"l\"\nlevel = 0\nperiod = \"1s\"\n\
         wires = [{wires}\"m7999.valu->m0.a\"]\n[layer.modules]\n{modules}"
    )
}

#[test]
fn large_files_are_read_in_time_that_grows_with_their_size() {
    let host = host();
    for (name, text) in large() {
        let began = std::time::Instant::now();
        attempt(text.into_bytes(), &host);
        println!("{name}: {:.2} s", began.elapsed().as_secs_f64());
    }
}
