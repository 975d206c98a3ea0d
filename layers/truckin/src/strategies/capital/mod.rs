//! Capital maintenance: making a profit from the trade with the dealer here.

use super::registry::micro_strategies;

micro_strategies! {
    take_everything::TakeEverything,
    keep_gas_money::KeepGasMoney,
    only_at_a_profit::OnlyAtAProfit,
    what_buyers_take::WhatBuyersTake,
    out_by_the_end::OutByTheEnd,
}

use super::notebook::Notebook;
use crate::ootland::{Commodity, Kind};

/// The kind of dealer that buys a commodity from trucks.
fn buyers_of(commodity: Commodity) -> Kind {
    match commodity {
        Commodity::Crates => Kind::Retailer,
        Commodity::Items | Commodity::Gas => Kind::Consumer,
    }
}

/// The best price a known buyer of this commodity was last seen to pay, in cents; 0 when none is known.
fn best_known_buying_cents(notebook: &Notebook, commodity: Commodity) -> i32 {
    let buyers = notebook.ready(buyers_of(commodity), 0);
    buyers.map(|(_, note)| note.card.buying_cents).max().unwrap_or(0)
}
