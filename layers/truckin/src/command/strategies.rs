//! `truckin strategies`: the slots and what fits them.

use clap::Args;

use super::inputs::{Trouble, say};
use crate::strategies::SLOTS;

/// Lists the slots and their micro-strategies.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  truckin strategies\n  truckin strategies --json")]
pub struct StrategiesArgs {
    /// As JSON.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &StrategiesArgs) -> Result<(), Trouble> {
    for (place, slot) in SLOTS.iter().enumerate() {
        if !args.json {
            say(&format!("digit {} · {}", place + 1, slot.name))?;
        }
        for (digit, allele) in slot.alleles.iter().enumerate() {
            if args.json {
                let line = serde_json::json!({
                    "slot": slot.name, "layer": place, "digit": digit,
                    "name": allele.name, "idea": allele.idea(),
                });
                say(&line.to_string())?;
            } else {
                say(&format!("  {digit}  {:<22} {}", allele.name, allele.idea()))?;
            }
        }
    }
    Ok(())
}
